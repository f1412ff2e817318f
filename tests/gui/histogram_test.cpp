#include <cmath>
#include <fstream>
#include <random>

#include <QAction>
#include <QLabel>
#include <QMenu>
#include <QTest>
#include <QToolButton>
#include <QWheelEvent>

#include "tests/gui/window_fixture.h"
#include "ui/model/isovalue/deviation_text.h"
#include "ui/model/session/saved_session.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_edit.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {
namespace {

template <class Sample>
std::filesystem::path writeVolume(const TemporaryFolder& folder, const char* name, const char* type, int n,
                                  const std::function<Sample(double radius, std::size_t index)>& sampleOf) {
    const auto path = folder / name;
    std::ofstream file(path, std::ios::binary);
    file << "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nDimSize = " << n << ' '
         << n << ' ' << n << "\nElementType = " << type << "\nElementDataFile = LOCAL\n";
    const double middle = (n - 1) / 2.0;
    std::size_t index = 0;
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                const Sample sample = sampleOf(std::hypot(x - middle, y - middle, z - middle), index++);
                file.write(reinterpret_cast<const char*>(&sample), sizeof sample);
            }
    return path;
}

class HistogramTest : public WindowTest {
protected:
    widgets::HistogramPlot& plot() { return window_->isovaluePanel().plot(); }
    widgets::IsovalueEdit& edit() { return window_->isovaluePanel().edit(); }
    model::IsovalueModel& isovalue() { return session_->isovalue(); }
    QLabel* note() { return child<QLabel>("isovalueNote"); }
    QLabel* readout() { return child<QLabel>("histogramReadout"); }
    QToolButton* button(const char* name) { return child<QToolButton>(name); }

    void open(const std::filesystem::path& path) {
        const auto generation = session_->datasetGeneration();
        drop(path);
        ASSERT_TRUE(waitUntil([&] {
            return session_->datasetGeneration() != generation && session_->isSettled() && session_->frame() &&
                   session_->frame()->isFromIndex;
        }));
    }
    /// 1000 - 20 r with one sample of 3e38 in a corner.
    void openOutlier() {
        open(writeVolume<float>(folder_, "outlier.mha", "MET_FLOAT", 32, [](double r, std::size_t i) {
            return i == 5 ? 3e38f : static_cast<float>(1000.0 - 20.0 * r);
        }));
    }
    /// Whole numbers, 250 - 8 r.
    void openBytes() {
        open(writeVolume<std::uint8_t>(folder_, "bytes.mha", "MET_UCHAR", 32, [](double r, std::size_t) {
            return static_cast<std::uint8_t>(std::max(0.0, 250.0 - 8.0 * r));
        }));
    }
    /// exp(10 - r): four decades and more.
    void openDecades() {
        open(writeVolume<float>(folder_, "decades.mha", "MET_FLOAT", 32,
                                [](double r, std::size_t) { return static_cast<float>(std::exp(10.0 - r / 2.0)); }));
    }
    QPoint onPlot(double value) {
        return {static_cast<int>(std::lround(plot().pixelOf(value))), plot().axisRect()->center().y()};
    }
    void move(QPoint point, Qt::MouseButtons buttons, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        QMouseEvent event(QEvent::MouseMove, point, plot().mapToGlobal(QPointF(point)), Qt::NoButton, buttons,
                          modifiers);
        QApplication::sendEvent(&plot(), &event);
    }
    void drag(QPoint from, QPoint to, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        QTest::mousePress(&plot(), Qt::LeftButton, modifiers, from);
        for (int step = 1; step <= 5; ++step)
            move(from + (to - from) * step / 5, Qt::LeftButton, modifiers);
        QTest::mouseRelease(&plot(), Qt::LeftButton, modifiers, to);
    }
    void type(const char* text) {
        trigger("isovalue.edit");
        edit().selectAll();
        QTest::keyClicks(&edit(), QString::fromUtf8(text));
        QTest::keyClick(&edit(), Qt::Key_Return);
    }
    void keep(const char* name) { keepPicture(*window_, name); }
};

TEST_F(HistogramTest, IsTallEnoughToRead) {
    openBytes();
    EXPECT_GE(plot().axisRect()->height(), 130);
}

TEST_F(HistogramTest, OneOutlierIsOutOfViewAndStated) {
    openOutlier();
    EXPECT_LT(plot().visibleRange().upper, 1100.0);
    EXPECT_GT(plot().visibleRange().lower, -200.0);
    EXPECT_LT(isovalue().requested(), 1000.0) << "the first surface is of the others";
    auto* above = button("samplesAbove");
    ASSERT_TRUE(above->isVisible());
    EXPECT_EQ(above->text(), QStringLiteral("1 sample up to 3e+38 ▸"));
    EXPECT_FALSE(button("samplesBelow")->isVisible());
    EXPECT_GT(plot().graph(0)->dataCount(), 100) << "the others are spread over the plot";
    keep("histogram_outlier");
    const QMargins margins = plot().axisRect()->minimumMargins();
    plot().axisRect()->setMinimumMargins({0, 0, 150, 0}); // as wide tick labels do
    plot().replot();
    EXPECT_LE(above->geometry().right(), plot().axisRect()->right()) << "not on the labels";
    plot().axisRect()->setMinimumMargins(margins);
    plot().replot();
    QTest::mouseClick(above, Qt::LeftButton);
    EXPECT_GE(plot().visibleRange().upper, 2.9e38);
    EXPECT_FALSE(above->isVisible());
    keep("histogram_outlier_whole");
    trigger("isovalue.resetZoom");
    EXPECT_LT(plot().visibleRange().upper, 1100.0);
    trigger("isovalue.wholeRange");
    EXPECT_GE(plot().visibleRange().upper, 2.9e38);
}

TEST_F(HistogramTest, AHandleOutOfViewHasAnArrowThatShowsIt) {
    openBytes();
    isovalue().request(100.0);
    for (int i = 0; i < 3; ++i)
        trigger("isovalue.zoomIn");
    isovalue().request(200.0);
    auto* handle = button("handleOutOfView");
    ASSERT_TRUE(handle->isVisible());
    EXPECT_EQ(handle->text(), QStringLiteral("200 ▸"));
    keep("histogram_handle_out_of_view");
    const double shown = plot().visibleRange().size();
    QTest::mouseClick(handle, Qt::LeftButton);
    EXPECT_FALSE(handle->isVisible());
    EXPECT_TRUE(plot().visibleRange().contains(200.0));
    EXPECT_NEAR(plot().visibleRange().size(), shown, 1e-6) << "no further out than before";
    isovalue().request(40.0);
    EXPECT_EQ(handle->text(), QStringLiteral("◂ 40"));
}

TEST_F(HistogramTest, ThePointerReadsValueCountAndShare) {
    openBytes();
    const auto& values = plot().view().values();
    std::uint64_t below = 0, at = 0;
    for (const auto& cell : values.cells) {
        below += cell.lower < 150.2 ? cell.count : 0;
        at += cell.lower == 150.0 ? cell.count : 0;
    }
    move(onPlot(150.2), Qt::NoButton);
    ASSERT_TRUE(readout()->isVisible());
    EXPECT_TRUE(readout()->text().contains(QStringLiteral("%1 samples at 150").arg(at)))
        << readout()->text().toStdString();
    const double share = 100.0 * static_cast<double>(below) / (32.0 * 32.0 * 32.0);
    EXPECT_TRUE(readout()->text().endsWith(QStringLiteral("%1 % below").arg(share, 0, 'f', 1)))
        << readout()->text().toStdString() << " and not " << share;
    keep("histogram_readout");
    QEvent leave(QEvent::Leave);
    QApplication::sendEvent(&plot(), &leave);
    EXPECT_FALSE(readout()->isVisible());
}

TEST_F(HistogramTest, ThePointerReadsStandardDeviationsWhereThereIsRoom) {
    openBytes();
    const auto& spread = plot().view().values().spread;
    ASSERT_GT(spread.deviation, 0.0);
    move(onPlot(150.2), Qt::NoButton);
    const double value = plot().valueAtPixel(onPlot(150.2).x());
    const QString deviations = QString::fromStdString(model::deviationsText(value, spread));
    EXPECT_TRUE(readout()->text().contains(QStringLiteral("  ·  %1  ·  ").arg(deviations)))
        << readout()->text().toStdString() << " and not " << deviations.toStdString();
    EXPECT_FALSE(readout()->wordWrap());
    window_->resize(420, 900);
    QTest::qWait(50);
    move(onPlot(150.2), Qt::NoButton);
    EXPECT_FALSE(readout()->text().contains(QStringLiteral("σ"))) << readout()->text().toStdString();
    EXPECT_TRUE(readout()->text().contains(QStringLiteral("% below"))) << readout()->text().toStdString();
}

// A step of the outline holds several bins where they are narrower than its columns.
TEST_F(HistogramTest, ThePointerReadsTheCountOfTheStepThatIsDrawn) {
    openOutlier();
    trigger("isovalue.wholeRange");
    trigger("isovalue.resetZoom");
    window_->resize(700, 900); // few columns
    QTest::qWait(50);
    for (const double value : {600.0, 700.0, 823.0}) {
        move(onPlot(value), Qt::NoButton);
        const double place = plot().xAxis->pixelToCoord(onPlot(value).x());
        const auto begin = plot().graph(0)->data()->findBegin(place); // the point before it
        const QString count = QLocale(QLocale::English).toString(static_cast<qlonglong>(std::llround(begin->value)));
        EXPECT_TRUE(readout()->text().contains(QStringLiteral("  ·  %1 sample").arg(count)))
            << readout()->text().toStdString() << " where " << count.toStdString() << " are drawn";
    }
    keep("histogram_readout_narrow");
}

TEST_F(HistogramTest, TheReadoutLeavesTheLabelsOfTheAxesLegible) {
    openOutlier();
    for (const int width : {1400, 420}) {
        window_->resize(width, 900);
        QTest::qWait(50);
        const QRect axes = plot().axisRect()->rect();
        for (const int x : {axes.left() + 12, axes.center().x() - 3, axes.center().x() + 3, axes.right() - 12}) {
            move({x, axes.center().y()}, Qt::NoButton);
            ASSERT_TRUE(readout()->isVisible());
            EXPECT_TRUE(axes.adjusted(0, 0, 1, 0).contains(readout()->geometry())) << width << " at " << x;
        }
        keep(width < 500 ? "histogram_readout_wrapped" : "histogram_readout_wide");
    }
}

TEST_F(HistogramTest, WholeNumbersStepByOneAndShowFewDigits) {
    openBytes();
    ASSERT_TRUE(plot().hasFocus()) << "the keys slide at once";
    type("192.5");
    EXPECT_EQ(isovalue().requested(), 192.5) << "typed is typed";
    plot().setFocus();
    QTest::keyClick(&plot(), Qt::Key_Right);
    EXPECT_EQ(isovalue().requested(), 193.0);
    QTest::keyClick(&plot(), Qt::Key_PageUp);
    EXPECT_EQ(isovalue().requested(), 203.0);
    QTest::keyClick(&plot(), Qt::Key_PageDown, Qt::ControlModifier);
    EXPECT_EQ(isovalue().requested(), 103.0);
    drag(onPlot(isovalue().requested()), onPlot(131.387));
    EXPECT_NEAR(isovalue().requested(), 131.4, 1.0);
    EXPECT_LE(edit().text().size(), 5) << edit().text().toStdString();
}

TEST_F(HistogramTest, DragsSnapToSampleValuesUnlessShiftIsHeld) {
    openBytes();
    trigger("isovalue.snapToSamples");
    drag(onPlot(isovalue().requested()), onPlot(140.4));
    EXPECT_EQ(isovalue().requested(), std::round(isovalue().requested()));
    EXPECT_EQ(plot().view().nearestSample(isovalue().requested()), isovalue().requested());
    const double snapped = isovalue().requested();
    drag(onPlot(snapped), onPlot(snapped) + QPoint(9, 0), Qt::ShiftModifier);
    EXPECT_NE(isovalue().requested(), std::round(isovalue().requested()));
    EXPECT_TRUE(settings_->boolean("isovalue/snapsToSamples"));
}

TEST_F(HistogramTest, ALogarithmicAxisMovesEverythingAlike) {
    openDecades();
    trigger("isovalue.logValues");
    ASSERT_EQ(plot().scale().kind(), model::ScaleKind::Log);
    const double ten = plot().pixelOf(10.0), hundred = plot().pixelOf(100.0), thousand = plot().pixelOf(1000.0);
    EXPECT_NEAR(thousand - hundred, hundred - ten, 0.01);
    QTest::mouseClick(&plot(), Qt::LeftButton, {}, onPlot(300.0));
    EXPECT_NEAR(isovalue().requested(), 300.0, 10.0);
    drag(onPlot(isovalue().requested()), onPlot(2000.0));
    EXPECT_NEAR(isovalue().requested(), 2000.0, 60.0);
    const auto& marks = plot().eventMarks();
    ASSERT_GT(marks.drawnCount(), 0u);
    const auto& events = session_->topology().events();
    std::size_t seen = 0;
    for (std::size_t event = 0; event < events.size(); ++event)
        if (const auto place = marks.placeOf(event)) {
            EXPECT_NEAR(place->x(), plot().pixelOf(events[event].isovalue), 0.01);
            ++seen;
        }
    EXPECT_GT(seen, 0u);
    keep("histogram_log");
    // A step is of what is near the handle, not of the whole range.
    isovalue().request(5.0);
    plot().setFocus();
    QTest::keyClick(&plot(), Qt::Key_Right);
    EXPECT_GT(isovalue().requested(), 5.0);
    EXPECT_LT(isovalue().requested(), 5.2);
    trigger("isovalue.symlogValues");
    EXPECT_EQ(plot().scale().kind(), model::ScaleKind::Symlog);
    EXPECT_EQ(settings_->text("histogram/valueScale"), QStringLiteral("symlog"));
}

TEST_F(HistogramTest, AnotherAxisShowsTheSameValues) {
    openDecades();
    drag(onPlot(4000.0), onPlot(9000.0), Qt::ControlModifier);
    const auto shown = plot().visibleRange();
    ASSERT_LT(shown.size(), 6000.0);
    for (const char* scale : {"isovalue.logValues", "isovalue.linearValues", "isovalue.symlogValues"}) {
        trigger(scale);
        EXPECT_NEAR(plot().visibleRange().lower, shown.lower, 1e-6) << scale;
        EXPECT_NEAR(plot().visibleRange().upper, shown.upper, 1e-6) << scale;
    }
}

TEST_F(HistogramTest, CurvesFollowTheAxis) {
    openDecades();
    window_->findChild<QAction*>(QStringLiteral("curve.area"))->trigger();
    const auto furthest = [&] {
        double most = -HUGE_VAL;
        for (int i = 2; i < plot().graphCount(); ++i)
            if (!plot().graph(i)->data()->isEmpty())
                most = std::max(most, (plot().graph(i)->data()->constEnd() - 1)->key);
        return most;
    };
    const double linear = furthest();
    ASSERT_GT(linear, 1000.0);
    trigger("isovalue.logValues");
    EXPECT_NEAR(furthest(), std::log10(linear), 1e-9);
}

TEST_F(HistogramTest, KeysGoFromSampleToSampleWhereTheHandleSnaps) {
    open(writeVolume<float>(folder_, "few.mha", "MET_FLOAT", 16, [](double r, std::size_t) {
        return r < 3.0 ? 10.5f : r < 5.0 ? 7.25f : r < 7.0 ? 1.125f : 0.0f;
    }));
    trigger("isovalue.snapToSamples");
    plot().setFocus();
    isovalue().request(2.0);
    std::vector<double> met;
    for (int i = 0; i < 3; ++i) {
        QTest::keyClick(&plot(), Qt::Key_Right);
        met.push_back(isovalue().requested());
    }
    EXPECT_EQ(met, (std::vector<double>{7.25, 10.5, 10.5}));
    QTest::keyClick(&plot(), Qt::Key_PageDown);
    EXPECT_EQ(isovalue().requested(), 0.0);
}

TEST_F(HistogramTest, ALargeIndexIsCountedInPartAtFirstAndThenWhole) {
    constexpr int kSide = 260; // more samples than are counted at first
    const auto path = writeVolume<std::uint8_t>(folder_, "large.mha", "MET_UCHAR", kSide, [](double r, std::size_t) {
        return static_cast<std::uint8_t>(std::max(0.0, 250.0 - r));
    });
    open(path);
    ASSERT_TRUE(waitUntilSettled());
    ASSERT_TRUE(plot().view().values().isExact());
    const auto exact = plot().view().values().body.counts;
    trigger("file.close");
    bool wasInexact = false;
    const auto subscription = session_->datasetChanged().observe([&] {
        wasInexact = wasInexact || (session_->dataset() != nullptr && !session_->dataset()->values->isExact());
    });
    open(path);
    EXPECT_TRUE(wasInexact) << "from the index that was kept";
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_TRUE(plot().view().values().isExact());
    EXPECT_EQ(plot().view().values().body.counts, exact);
}

TEST_F(HistogramTest, ALogarithmOfNegativeValuesIsSymmetricAndSaysSo) {
    openBall();
    trigger("isovalue.logValues");
    EXPECT_EQ(plot().scale().kind(), model::ScaleKind::Symlog);
    ASSERT_TRUE(note()->isVisible());
    EXPECT_TRUE(note()->text().contains(QStringLiteral("both sides of 0")));
    trigger("isovalue.linearValues");
    EXPECT_FALSE(note()->isVisible());
}

TEST_F(HistogramTest, ADecimalCommaIsOne) {
    openBytes();
    type("100,5");
    EXPECT_EQ(isovalue().requested(), 100.5);
}

TEST_F(HistogramTest, AClampedValueIsStatedUntilTheNext) {
    openBytes();
    type("300");
    EXPECT_EQ(isovalue().requested(), isovalue().max());
    ASSERT_TRUE(note()->isVisible());
    EXPECT_TRUE(note()->text().startsWith(QStringLiteral("300 is above all samples")));
    keep("histogram_clamped");
    type("120");
    ASSERT_TRUE(waitUntil([&] { return !isovalue().isLagging(); }));
    EXPECT_FALSE(note()->isVisible()) << note()->text().toStdString();
}

TEST_F(HistogramTest, AnIsovalueThatAVolumeIsOpenedWithIsStatedLikeATypedOne) {
    const auto path = writeVolume<std::uint8_t>(folder_, "opened.mha", "MET_UCHAR", 16, [](double r, std::size_t) {
        return static_cast<std::uint8_t>(200.0 - 8.0 * r);
    });
    window_->openFile(qpath(path), AskedIsovalue(900.0, true));
    ASSERT_TRUE(waitUntil([&] { return session_->dataset() && session_->isSettled() && session_->frame(); }));
    EXPECT_EQ(isovalue().requested(), isovalue().max());
    ASSERT_TRUE(note()->isVisible());
    EXPECT_TRUE(note()->text().contains(QStringLiteral("is above all samples; the greatest, 19")))
        << note()->text().toStdString();
    keep("histogram_clamped_first");
    QTest::qWait(600); // steps are noted once the handle rests
    EXPECT_FALSE(window_->actions().action("edit.undo")->isEnabled()) << "it is nobody's step";
    isovalue().request(150.0);
    ASSERT_TRUE(waitUntil([&] { return !isovalue().isLagging(); }));
    EXPECT_FALSE(note()->isVisible()) << note()->text().toStdString();
}

TEST_F(HistogramTest, AnEmptySurfaceIsStatedWithWhatToDo) {
    openBytes();
    QTest::keyClick(&plot(), Qt::Key_Home);
    ASSERT_TRUE(waitUntil([&] { return note()->isVisible(); }));
    EXPECT_TRUE(note()->text().contains(QStringLiteral("choose a higher isovalue"))) << note()->text().toStdString();
    keep("histogram_empty_surface");
    QTest::keyClick(&plot(), Qt::Key_PageUp);
    EXPECT_TRUE(waitUntil([&] { return !note()->isVisible(); }));
}

TEST_F(HistogramTest, ATowerOfCountsIsClippedAndMarked) {
    open(writeVolume<std::uint8_t>(folder_, "air.mha", "MET_UCHAR", 32, [](double r, std::size_t) {
        return static_cast<std::uint8_t>(r > 12.0 ? 0 : 250.0 - 8.0 * r);
    }));
    trigger("isovalue.logCounts");
    const double clipped = plot().yAxis->range().upper;
    const auto air = static_cast<double>(plot().view().values().cells.front().count);
    EXPECT_LT(clipped, air / 4.0);
    const auto isMarked = [&] {
        for (int i = 0; i < plot().itemCount(); ++i)
            if (auto* text = qobject_cast<QCPItemText*>(plot().item(i));
                text && text->objectName() == QLatin1String("clippedCount"))
                if (text->visible() && text->text().contains(QStringLiteral("▲")))
                    return true;
        return false;
    };
    EXPECT_TRUE(isMarked());
    keep("histogram_clipped");
    trigger("isovalue.clipCounts");
    EXPECT_GT(plot().yAxis->range().upper, air);
    EXPECT_FALSE(isMarked());
}

TEST_F(HistogramTest, ControlDragZoomsToWhatItCovers) {
    openBytes();
    const double before = isovalue().requested();
    drag(onPlot(100.0), onPlot(150.0), Qt::ControlModifier);
    EXPECT_EQ(isovalue().requested(), before);
    EXPECT_NEAR(plot().visibleRange().lower, 100.0, 1.0);
    EXPECT_NEAR(plot().visibleRange().upper, 150.0, 1.0);
    const double shown = plot().visibleRange().size();
    QTest::keyClick(&plot(), Qt::Key_Minus);
    EXPECT_GT(plot().visibleRange().size(), shown);
    trigger("isovalue.resetZoom");
    EXPECT_GT(plot().visibleRange().size(), 200.0);
}

TEST_F(HistogramTest, TheMenuOfThePlotHasItsCommands) {
    openBytes();
    Q_EMIT plot().customContextMenuRequested(plot().rect().center());
    auto* menu = child<QMenu>("histogramMenu");
    ASSERT_TRUE(menu->isVisible());
    const auto has = [&](const char* id) {
        const QAction* action = window_->actions().action(id);
        for (const QAction* entry : menu->actions())
            if (entry == action || (entry->menu() != nullptr && entry->menu()->actions().contains(action)))
                return true;
        return false;
    };
    for (const char* id : {"isovalue.linearValues", "isovalue.logValues", "isovalue.symlogValues", "isovalue.logCounts",
                           "isovalue.clipCounts", "isovalue.snap", "isovalue.snapToSamples", "isovalue.zoomIn",
                           "isovalue.zoomOut", "isovalue.resetZoom", "isovalue.wholeRange", "isovalue.showHandle"})
        EXPECT_TRUE(has(id)) << id;
    keepPicture(*menu, "histogram_menu");
    menu->close();
}

TEST_F(HistogramTest, FocusIsVisible) {
    openBytes();
    plot().setFocus();
    const auto cornerColour = [&] { return plot().grab().toImage().pixelColor(1, 1); };
    const QColor focused = cornerColour();
    edit().setFocus();
    EXPECT_NE(cornerColour(), focused);
}

TEST_F(HistogramTest, ASessionKeepsEverySetting) {
    openDecades();
    for (const char* id :
         {"isovalue.symlogValues", "isovalue.logCounts", "isovalue.clipCounts", "isovalue.snapToSamples"})
        trigger(id);
    const auto kept = session_->histogramOptions().options();
    EXPECT_EQ(kept, (model::HistogramOptions{model::ScaleKind::Symlog, false, false, true}));
    const auto path = folder_ / "a.isosession";
    dialogs_.answers.push_back(QString::fromStdString(path.string()));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([&] { return model::readSession(path).isOk(); }));
    session_->histogramOptions().setOptions({});
    ASSERT_EQ(plot().scale().kind(), model::ScaleKind::Linear);
    const auto generation = session_->datasetGeneration();
    drop(path);
    ASSERT_TRUE(waitUntil([&] { return session_->datasetGeneration() != generation && session_->isSettled(); }));
    EXPECT_EQ(session_->histogramOptions().options(), kept);
    EXPECT_EQ(plot().scale().kind(), model::ScaleKind::Symlog);
    EXPECT_TRUE(window_->actions().action("isovalue.symlogValues")->isChecked());
    EXPECT_TRUE(window_->actions().action("isovalue.snapToSamples")->isChecked());
}

} // namespace
} // namespace isoslider::test
