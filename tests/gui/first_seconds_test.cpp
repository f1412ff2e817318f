// What a user sees before the index of a volume is there: the volume in memory, or a preview of it.
#include <cmath>
#include <fstream>

#include <QAction>
#include <QDockWidget>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QTest>

#include "tests/gui/gyroid_file.h"
#include "tests/gui/run_recorder.h"
#include "tests/gui/window_fixture.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;

class FirstSecondsTest : public WindowTest {
protected:
    widgets::HistogramPlot& plot() { return window_->isovaluePanel().plot(); }
    model::IsovalueModel& isovalue() { return session_->isovalue(); }

    bool waitUntilDisplayed() {
        return waitUntil([this] { return session_->frame() != nullptr && !isovalue().isLagging(); },
                         std::chrono::seconds(30));
    }
    /// The frame that arrived is also on screen, where there is a screen.
    bool waitUntilPainted() {
        auto* viewport = window_->viewportHost().viewport();
        if (viewport == nullptr)
            return true;
        const auto before = viewport->paintedFrames();
        viewport->showAgain();
        return waitUntil([&] { return viewport->paintedFrames() > before; });
    }
    void pressKey(Qt::Key key, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
        plot().setFocus();
        QTest::keyClick(&plot(), key, modifiers);
    }
    /// Drags the handle by a share of the range, as a hand does: press, some moves, release.
    void dragHandle(double share) {
        const auto pixel = [this](double value) { return static_cast<int>(std::lround(plot().pixelOf(value))); };
        const int y = plot().axisRect()->center().y();
        const int from = pixel(isovalue().requested());
        const int to = pixel(isovalue().requested() + share * (isovalue().max() - isovalue().min()));
        QTest::mousePress(&plot(), Qt::LeftButton, {}, QPoint(from, y));
        for (int step = 1; step <= 4; ++step) {
            const QPoint point(from + (to - from) * step / 4, y);
            QMouseEvent move(QEvent::MouseMove, point, plot().mapToGlobal(QPointF(point)), Qt::NoButton, Qt::LeftButton,
                             Qt::NoModifier);
            QApplication::sendEvent(&plot(), &move);
            ASSERT_TRUE(waitUntilDisplayed());
        }
        QTest::mouseRelease(&plot(), Qt::LeftButton, {}, QPoint(to, y));
    }
};

TEST_F(FirstSecondsTest, TheHandleSlidesWhileTheIndexIsBuiltBehindIt) {
    builder_->holds = true;
    makeWindow();
    window_->openFile(QString::fromStdString(writeBall(folder_, "ball.mha", 24).string()));
    ASSERT_TRUE(waitUntil([&] { return session_->frame() != nullptr; }));
    EXPECT_EQ(session_->indexState(), model::IndexState::Building);
    EXPECT_FALSE(session_->frame()->isWholeExtraction);
    EXPECT_FALSE(session_->frame()->isFromIndex);

    auto* plot = &window_->isovaluePanel().plot();
    plot->setFocus();
    const double before = session_->isovalue().displayed();
    for (int step = 0; step < 3; ++step) {
        QTest::keyClick(plot, Qt::Key_PageUp);
        ASSERT_TRUE(waitUntil([&] { return !session_->isovalue().isLagging(); }));
    }
    EXPECT_GT(session_->isovalue().displayed(), before);
    EXPECT_FALSE(session_->frame()->stats.hasRebuilt) << "patched, not extracted anew";
    EXPECT_GT(session_->frame()->stats.bricksRead, 0u);

    // The index takes over without a seam.
    const auto inMemory = session_->frame();
    builder_->holds = false;
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->isFromIndex; }));
    EXPECT_EQ(session_->frame()->isovalue, inMemory->isovalue);
    EXPECT_EQ(session_->frame()->stats.triangles, inMemory->stats.triangles);
    EXPECT_EQ(session_->frame()->stats.activeEdges, inMemory->stats.activeEdges);
    EXPECT_TRUE(waitUntilSettled());
}

TEST_F(FirstSecondsTest, TheFirstSurfaceIsStoppedAndAskedForOnTheCard) {
    builder_->holdsEngine = true;
    window_->openFile(qpath(writeBall(folder_, "ball.mha", 24)));
    auto* card = child<QWidget>("loadingCard");
    auto* button = child<QPushButton>("cancelOpening");
    auto* stage = child<QLabel>("loadingStage");
    ASSERT_TRUE(waitUntil([&] { return session_->dataset() != nullptr && session_->moveProgress() > 0.0; }));
    EXPECT_TRUE(card->isVisible());
    EXPECT_EQ(button->text(), QStringLiteral("Cancel"));
    EXPECT_TRUE(stage->text().startsWith(QStringLiteral("Extracting · 15 %"))) << stage->text().toStdString();
    EXPECT_TRUE(waitUntil([&] { return stage->text().contains(QStringLiteral("s left")); }))
        << stage->text().toStdString();
    keepPicture(*window_, "first_surface_comes");
    QTest::mouseClick(button, Qt::LeftButton);
    EXPECT_TRUE(session_->hasStoppedMove());
    EXPECT_TRUE(card->isVisible());
    EXPECT_EQ(button->text(), QStringLiteral("Extract Surface"));
    builder_->holdsEngine = false;
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->indexState(), model::IndexState::Ready);
    EXPECT_EQ(session_->frame(), nullptr) << "nor does the index bring it";
    keepPicture(*window_, "first_surface_stopped");
    QTest::mouseClick(button, Qt::LeftButton);
    ASSERT_TRUE(waitUntil([&] { return session_->frame() != nullptr; }));
    EXPECT_FALSE(card->isVisible());
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_TRUE(session_->frame()->isFromIndex);
}

TEST_F(FirstSecondsTest, EscapeStopsTheFirstSurfaceAndNothingElse) {
    builder_->holdsEngine = true;
    window_->openFile(qpath(writeBall(folder_, "ball.mha", 24)));
    ASSERT_TRUE(waitUntil([&] { return session_->dataset() != nullptr && session_->moveProgress() > 0.0; }));
    QTest::keyClick(&plot(), Qt::Key_Escape);
    EXPECT_TRUE(session_->hasStoppedMove());
    builder_->holdsEngine = false;
    ASSERT_TRUE(waitUntilSettled());
    QTest::keyClick(&plot(), Qt::Key_Escape);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->frame(), nullptr) << "it asks for nothing";
    QTest::mouseClick(child<QPushButton>("cancelOpening"), Qt::LeftButton);
    ASSERT_TRUE(waitUntil([&] { return session_->frame() != nullptr; }));
    auto* edit = child<QLineEdit>("isovalueEdit");
    trigger("isovalue.edit");
    const QString text = edit->text();
    QTest::keyClicks(edit, QStringLiteral("7"));
    QTest::keyClick(edit, Qt::Key_Escape);
    EXPECT_EQ(edit->text(), text) << "as it does elsewhere";
}

TEST_F(FirstSecondsTest, AFresh256CubeIsSlidBeforeItsIndexIsThere) {
    const auto volume = writeGyroid(folder_, 256);
    builder_->holds = true; // the index may be there sooner than a key can be pressed
    RunRecorder recorder("fresh-256", *window_, *session_);
    recorder.begin("dropped on the window");
    drop(volume);
    recorder.setStep("first surface");
    ASSERT_TRUE(waitUntilDisplayed());
    ASSERT_FALSE(session_->frame()->isFromIndex);
    const double first = session_->frame()->isovalue;

    recorder.setStep("key: right");
    pressKey(Qt::Key_Right);
    ASSERT_TRUE(waitUntilDisplayed());
    EXPECT_GT(session_->frame()->isovalue, first);
    EXPECT_FALSE(session_->frame()->isFromIndex);
    EXPECT_FALSE(session_->frame()->isWholeExtraction);
    EXPECT_NE(session_->indexState(), model::IndexState::Ready);
    const double slidSeconds = recorder.lastArrival();
    // Recorded, not required: another program may have the machine.
    std::printf("first slid surface %.3f s after the file was dropped\n", slidSeconds);
    EXPECT_TRUE(waitUntilPainted());
    recorder.takePicture("first-slide");

    recorder.setStep("key: page up");
    pressKey(Qt::Key_PageUp);
    ASSERT_TRUE(waitUntilDisplayed());
    recorder.setStep("mouse: drag by 10 %");
    dragHandle(0.1);
    const auto slid = session_->frame();
    EXPECT_TRUE(waitUntilPainted());
    recorder.takePicture("dragged");

    recorder.setStep("index is there");
    builder_->holds = false;
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->isFromIndex; }, std::chrono::seconds(60)));
    EXPECT_EQ(session_->frame()->isovalue, slid->isovalue);
    EXPECT_EQ(session_->frame()->stats.triangles, slid->stats.triangles);
    EXPECT_TRUE(waitUntilPainted());
    recorder.takePicture("from-index");
    recorder.setStep("key: page down");
    pressKey(Qt::Key_PageDown);
    ASSERT_TRUE(waitUntilDisplayed());
    EXPECT_TRUE(session_->frame()->isFromIndex);
}

class PreviewTest : public FirstSecondsTest {
protected:
    static constexpr int kDim = 60; // the last of every four is 56: the preview ends before the volume
    static constexpr int kCoarse = 15;

    PreviewTest() {
        builder_->holds = true;
        wholeVolumeBytes_ = std::uint64_t{kDim} * kDim * kDim / 8 * sizeof(std::uint16_t) - 1; // one of two is too much
        makeWindow();
        drop(writeGyroid(folder_, kDim));
        waitUntil([this] { return session_->frame() != nullptr; });
    }
    QLabel& label() { return *child<QLabel>("previewLabel"); }
    /// Nothing that is shown of the label is cut off or under another overlay.
    void expectLegible() {
        EXPECT_TRUE(label().isVisible());
        EXPECT_GE(label().width(), label().sizeHint().width());
        EXPECT_GE(label().height(), label().sizeHint().height());
        EXPECT_TRUE(window_->viewportHost().rect().contains(label().geometry()));
        for (const char* other : {"viewReadout", "loadingCard"}) {
            const auto* overlay = child<QWidget>(other);
            EXPECT_FALSE(overlay->isVisible() && overlay->geometry().intersects(label().geometry())) << other;
        }
    }
    /// The middle of the pixels that show the surface, which alone is warm.
    static QPointF surfaceMiddle(widgets::ViewportWidget& viewport) {
        const QImage image = viewport.grabFramebuffer();
        QPointF sum;
        double count = 0.0;
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x)
                if (const QRgb pixel = image.pixel(x, y); qRed(pixel) > qBlue(pixel) + 12) {
                    sum += QPointF(x, y);
                    ++count;
                }
        return sum / std::max(count, 1.0);
    }
    std::string factText(const char* name) {
        for (const auto* fact : window_->findChildren<QLabel*>())
            if (fact->accessibleName().startsWith(QLatin1String(name) + QStringLiteral(": ")) && fact->isVisible())
                return fact->text().toStdString();
        return "not shown";
    }
};

TEST_F(PreviewTest, IsSlidAndThenTheWholeVolumeTakesItsPlace) {
    RunRecorder recorder("preview", *window_, *session_);
    recorder.begin("preview is there");
    ASSERT_NE(session_->frame(), nullptr);
    EXPECT_EQ(session_->frame()->geometry.dims, (GridDims{kCoarse, kCoarse, kCoarse}));
    expectLegible();
    EXPECT_EQ(label().text(),
              QStringLiteral("preview at 1:4\none of 4 samples along each axis\nthe index is being built"));
    EXPECT_EQ(factText("Grid points"), "60 × 60 × 60 = 216,000");
    EXPECT_EQ(factText("Preview"), "15 × 15 × 15, at 1:4");
    EXPECT_EQ(factText("Missing samples"), "none in the preview");
    EXPECT_EQ(factText("Distinct values"), "not shown");
    EXPECT_TRUE(waitUntilPainted());
    recorder.takePicture("preview");

    const double first = session_->frame()->isovalue;
    recorder.setStep("key: page up");
    pressKey(Qt::Key_PageUp);
    ASSERT_TRUE(waitUntilDisplayed());
    recorder.setStep("mouse: drag by 10 %");
    dragHandle(0.1);
    ASSERT_TRUE(waitUntilDisplayed());
    const auto coarse = session_->frame();
    EXPECT_GT(coarse->isovalue, first);
    EXPECT_EQ(session_->shownStep(), 4);
    EXPECT_TRUE(waitUntilPainted());
    recorder.takePicture("slid");

    auto* viewport = window_->viewportHost().viewport();
    QPointF place;
    if (viewport != nullptr) {
        QTest::keyClick(viewport, Qt::Key_7);
        place = surfaceMiddle(*viewport);
    }
    const auto camera = viewport != nullptr ? viewport->camera() : model::Camera();
    recorder.setStep("index is there");
    builder_->holds = false;
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->isFromIndex; }));
    EXPECT_EQ(session_->frame()->isovalue, coarse->isovalue);
    EXPECT_EQ(isovalue().requested(), coarse->isovalue);
    EXPECT_EQ(session_->frame()->geometry.dims, (GridDims{kDim, kDim, kDim}));
    EXPECT_GT(session_->frame()->stats.triangles, 10 * coarse->stats.triangles);
    EXPECT_FALSE(label().isVisible());
    EXPECT_EQ(factText("Preview"), "not shown");
    EXPECT_EQ(factText("Missing samples"), "none");
    if (viewport != nullptr) {
        EXPECT_EQ(viewport->camera().viewMatrix(), camera.viewMatrix());
        EXPECT_EQ(viewport->camera().sceneRadius(), camera.sceneRadius());
        // About its own middle the preview would lie 1.5 cells off, some ten pixels each way.
        const QPointF moved = surfaceMiddle(*viewport) - place;
        EXPECT_LT(std::hypot(moved.x(), moved.y()), 4.0) << moved.x() << ", " << moved.y();
    }
    EXPECT_TRUE(waitUntilPainted());
    recorder.takePicture("whole");
    EXPECT_TRUE(waitUntilSettled());
}

TEST_F(PreviewTest, IsNotExportedAndNoFileNameIsAskedFor) {
    child<QDockWidget>("meshDock")->raise();
    trigger("mesh.export"); // an unexpected dialog would fail
    ASSERT_TRUE(window_->messageBar().isVisible());
    EXPECT_TRUE(window_->messageBar().text().contains(
        QStringLiteral("the index is still being built; the preview is not exported")));
    EXPECT_TRUE(waitUntilPainted());
    RunRecorder("preview", *window_, *session_).takePicture("export-refused");
    expectLegible();
}

TEST_F(PreviewTest, StaysAndSaysSoWhenTheBuildIsCancelled) {
    session_->cancelJob(session_->jobs().entries().back().id);
    ASSERT_TRUE(waitUntil([&] { return session_->indexState() == model::IndexState::Cancelled; }));
    expectLegible();
    EXPECT_TRUE(label().text().endsWith(QStringLiteral("building the index was cancelled")));
    pressKey(Qt::Key_PageUp);
    EXPECT_TRUE(waitUntilDisplayed());
    EXPECT_TRUE(waitUntilPainted());
    RunRecorder("preview", *window_, *session_).takePicture("build-cancelled");
    builder_->holds = false;
    trigger("index.build");
    ASSERT_TRUE(waitUntil([&] { return session_->frame()->isFromIndex; }));
    EXPECT_FALSE(label().isVisible());
}

TEST_F(PreviewTest, ItsLabelTakesThePlaceOfAHiddenReadout) {
    trigger("view.readout");
    expectLegible();
    trigger("view.readout");
    expectLegible();
}

} // namespace
} // namespace isoslider::test
