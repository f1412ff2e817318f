// Surfaces coloured by values: what the picture shows, where it may not, what is undone and kept.
#include <cmath>
#include <limits>
#include <numbers>

#include <QAction>
#include <QComboBox>
#include <QDockWidget>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QToolTip>
#include <QtTest>

#include <glm/geometric.hpp>

#include "tests/gui/float_volume.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/colouring/colour_model.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/opening/volume_dialog.h"
#include "ui/widgets/viewport/colour_bar_view.h"
#include "ui/widgets/viewport/orientation_cube.h"
#include "ui/widgets/viewport/scale_bar_view.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"
#include "ui/widgets/window/session_keeper.h"

namespace isoslider::test {
namespace {

using model::ColourBy;
using model::ColourRange;

constexpr int kFieldPoints = 24;
constexpr double kFieldMiddle = (kFieldPoints - 1) / 2.0;
constexpr double kTolerance = 0.035; // of a colour, as seen; pictures have 8 bits

template <class Value>
std::filesystem::path writeVolume(const TemporaryFolder& folder, const char* name, int n, const Value& value) {
    return writeFloats(folder, name, {n, n, n}, value);
}

class ColourTest : public WindowTest {
protected:
    void SetUp() override {
        if (window_->viewportHost().viewport() == nullptr)
            GTEST_SKIP() << "no OpenGL 3.3 here";
        openBall(kFieldPoints);
        lookAlongY();
    }
    void lookAlongY() { // X to the right, Z upwards
        auto options = view().options();
        options.showsBox = false;
        view().setOptions(options);
        QTest::keyClick(window_.get(), Qt::Key_1);
    }
    widgets::ViewportWidget& viewport() { return *window_->viewportHost().viewport(); }
    model::ColourModel& colours() { return window_->viewportHost().colours(); }
    model::ViewState& view() { return window_->viewportHost().viewState(); }
    QAction& action(const char* id) { return *window_->actions().action(id); }
    widgets::ColourBarView& bar() { return *child<widgets::ColourBarView>("colourBar"); }
    void slideTo(double isovalue) {
        session_->isovalue().request(isovalue);
        ASSERT_TRUE(waitUntilSettled());
    }
    void choose(const char* id, ColourBy by) {
        trigger(id);
        ASSERT_TRUE(waitUntil([&] { return colours().colours().by == by; }));
        EXPECT_TRUE(action(id).isChecked());
    }
    /// Where a place of the volume, in index units, is in the view.
    QPoint seenAt(const glm::dvec3& place) {
        const auto& camera = viewport().camera();
        const double aspect = static_cast<double>(viewport().width()) / viewport().height();
        const glm::dvec4 clip =
            camera.projectionMatrix(aspect) * camera.viewMatrix() * glm::dvec4(place - kFieldMiddle, 1.0);
        return QPointF((clip.x / clip.w + 1.0) / 2.0 * viewport().width(),
                       (1.0 - clip.y / clip.w) / 2.0 * viewport().height())
            .toPoint();
    }
    /// On the ball's side towards the viewer.
    static glm::dvec3 onBall(double radius, double degrees, double height = 0.0) {
        const double angle = degrees * std::numbers::pi / 180.0, across = std::sqrt(radius * radius - height * height);
        return glm::dvec3(kFieldMiddle) + glm::dvec3(across * std::sin(angle), -across * std::cos(angle), height);
    }
    QImage picture() { return viewport().grabFramebuffer().convertToFormat(QImage::Format_RGB32); }
    QImage pictureOf(const std::optional<ColourRange>& range) {
        colours().change([&](model::Colouring& colouring) { colouring.range = range; });
        return picture();
    }
    /// The colours at these places without the light: what light does to two known colours states what it does to
    /// others.
    std::vector<model::SeenColour> unlit(const std::vector<glm::dvec3>& places) {
        const auto range = colours().wanted().range;
        const QImage shown = pictureOf(range), low = pictureOf(ColourRange{1e6, 2e6}),
                     high = pictureOf(ColourRange{-2e6, -1e6});
        pictureOf(range);
        const auto linear = [](double seen) { return std::pow(seen, 2.2); };
        std::vector<model::SeenColour> found;
        for (const glm::dvec3& place : places) {
            const QPoint point = seenAt(place);
            model::SeenColour colour{};
            for (std::size_t part = 0; part < 3; ++part) {
                const auto of = [&](const QImage& image) {
                    return linear((image.pixel(point) >> (16 - 8 * part) & 0xff) / 255.0);
                };
                const auto mapped = [&](double at) {
                    return linear(static_cast<double>(
                        model::colourAt(colours().wanted().map, colours().wanted().isReversed, at)[part]));
                };
                const double share = (of(shown) - of(low)) / (of(high) - of(low));
                colour[part] = static_cast<float>(
                    std::pow(std::max(0.0, mapped(0.0) + share * (mapped(1.0) - mapped(0.0))), 1.0 / 2.2));
            }
            found.push_back(colour);
        }
        return found;
    }
    static void expectNear(const model::SeenColour& found, const model::SeenColour& wanted, const std::string& where) {
        for (std::size_t part = 0; part < 3; ++part)
            EXPECT_NEAR(found[part], wanted[part], kTolerance) << where << ", part " << part;
    }
    void expectColours(const std::vector<glm::dvec3>& places, const std::function<double(const glm::dvec3&)>& value) {
        const ColourRange range = colours().colours().range;
        const auto found = unlit(places);
        for (std::size_t i = 0; i < places.size(); ++i)
            expectNear(found[i],
                       model::colourAt(colours().wanted().map, colours().wanted().isReversed,
                                       (value(places[i]) - range.low) / (range.high - range.low)),
                       std::to_string(value(places[i])));
    }
    void chooseField(const std::filesystem::path& path) {
        dialogs_.answers.push_back(qpath(path));
        trigger("colour.field");
        widgets::VolumeDialog* dialog = nullptr;
        ASSERT_TRUE(waitUntil([&] { return (dialog = window_->findChild<widgets::VolumeDialog*>()) != nullptr; }));
        Q_EMIT dialog->openRequested(qpath(path), {});
        dialog->close();
        delete dialog;
    }
    static void letStepEnd() { QTest::qWait(600); }
};

TEST_F(ColourTest, ThePictureHasTheColoursOfX) {
    choose("colour.x", ColourBy::X);
    EXPECT_EQ(colours().colours().range, (ColourRange{0.0, kFieldPoints - 1.0}));
    for (const double radius : {8.0, 5.0}) { // the second after a slide
        slideTo(-radius);
        expectColours({onBall(radius, -45), onBall(radius, -10), onBall(radius, 15), onBall(radius, 40)},
                      [](const glm::dvec3& place) { return place.x; });
    }
    keepPicture(*window_, "colours");
    trigger("colour.cividis");
    trigger("colour.reverse");
    choose("colour.middle", ColourBy::Middle);
    expectColours({onBall(5, -30, -3), onBall(5, 20, 2.5)}, [](const glm::dvec3&) { return 5.0; });
    choose("colour.z", ColourBy::Z);
    expectColours({onBall(5, -30, -3), onBall(5, 20, 2.5)}, [](const glm::dvec3& place) { return place.z; });
}

TEST_F(ColourTest, ThePictureHasTheColoursOfTheGradient) {
    // Along the plane in the middle the value changes the faster the farther right.
    const auto path =
        writeVolume(folder_, "wedge.mha", kFieldPoints, [](int x, int y, int) { return (y - 11.0) * (1.0 + x / 8.0); });
    window_->openFile(qpath(path));
    ASSERT_TRUE(waitUntil([&] { return session_->dataset()->name == "wedge.mha" && session_->isSettled(); }));
    lookAlongY();
    slideTo(0.0);
    choose("colour.gradient", ColourBy::Gradient);
    colours().change([](model::Colouring& colouring) { colouring.range = ColourRange{0.0, 5.0}; });
    std::vector<glm::dvec3> places;
    for (const double x : {2.0, 7.5, 16.0, 21.0})
        places.emplace_back(x, 11.0, 14.0);
    expectColours(places, [](const glm::dvec3& place) { return 1.0 + place.x / 8.0; });
    trigger("colour.fit");
    ASSERT_TRUE(waitUntil([this] { return colours().wanted().range != ColourRange({0.0, 5.0}); }));
    EXPECT_NEAR(colours().colours().range.low, 1.0, 0.02);
    EXPECT_NEAR(colours().colours().range.high, 1.0 + (kFieldPoints - 1) / 8.0, 0.02);
}

TEST_F(ColourTest, ASecondFieldIsGreyWhereItHasNoValue) {
    slideTo(-8.0);
    chooseField(writeVolume(folder_, "other.mha", kFieldPoints, [](int x, int, int z) {
        return x < 8 ? std::numeric_limits<double>::quiet_NaN() : 10.0 * z;
    }));
    ASSERT_TRUE(waitUntil([this] { return colours().colours().by == ColourBy::Field; }));
    expectColours({onBall(8, 20, -4), onBall(8, 30, 3)}, [](const glm::dvec3& place) { return 10.0 * place.z; });
    EXPECT_EQ(bar().content().title, QStringLiteral("other.mha"));
    EXPECT_TRUE(bar().content().hasMissing);
    const QRgb missing = picture().pixel(seenAt(onBall(8, -60)));
    EXPECT_LT(std::abs(qRed(missing) - qBlue(missing)), 14) << std::hex << missing;
    EXPECT_GT(qGray(missing), 40);
}

TEST_F(ColourTest, AFieldOfAnotherGridIsRefused) {
    choose("colour.y", ColourBy::Y);
    chooseField(writeBall(folder_, "small.mha", 20));
    auto& messages = window_->messageBar();
    ASSERT_TRUE(waitUntil([&] { return messages.isVisible(); }));
    QStringList said;
    for (const auto* label : messages.findChildren<QLabel*>())
        said << label->text();
    const QString text = said.join(QLatin1Char('\n'));
    for (const char* part : {"small.mha", "ball.mha", "20 × 20 × 20 points instead of 24 × 24 × 24"})
        EXPECT_TRUE(text.contains(QString::fromUtf8(part))) << text.toStdString();
    EXPECT_EQ(colours().wanted().by, ColourBy::Y) << "as it was";
    EXPECT_FALSE(colours().wanted().field);
    EXPECT_TRUE(action("colour.y").isChecked());
}

TEST_F(ColourTest, AnIndexOfEdgesIsColouredByGradientToo) {
    builder_->kind = index::IndexKind::Edges;
    openBall(20);
    ASSERT_TRUE(waitUntil([this] { return session_->dataset()->index && session_->isSettled(); }));
    std::filesystem::remove(folder_ / "ball.mha"); // its own samples do
    choose("colour.gradient", ColourBy::Gradient);
    EXPECT_TRUE(bar().isVisible());
}

TEST_F(ColourTest, TheBarStandsClearOfTheOthersAndInSavedPictures) {
    EXPECT_FALSE(bar().isVisible());
    const QImage plain = window_->viewportHost().picture().convertToFormat(QImage::Format_RGB32);
    choose("colour.x", ColourBy::X);
    EXPECT_TRUE(bar().isVisible());
    EXPECT_FALSE(bar().geometry().intersects(child<widgets::OrientationCube>("orientationCube")->geometry()));
    EXPECT_FALSE(bar().geometry().intersects(child<widgets::ScaleBarView>("scaleBar")->geometry()));
    EXPECT_TRUE(viewport().rect().contains(bar().geometry()));
    ASSERT_GE(bar().ticks().size(), 4u);
    EXPECT_EQ(bar().ticks().front().text, "0");
    EXPECT_GT(bar().yOf(0.0), bar().yOf(20.0));
    const QImage saved = window_->viewportHost().picture().convertToFormat(QImage::Format_RGB32);
    ASSERT_EQ(saved.size(), plain.size());
    // Halfway up its strip is the map's middle.
    const QPoint middle = bar().pos() + QPoint(16, static_cast<int>(std::lround(bar().yOf((kFieldPoints - 1) / 2.0))));
    const QRgb pixel = saved.pixel(middle);
    const auto wanted = model::colourAt(model::ColourMap::Viridis, false, 0.5);
    expectNear({static_cast<float>(qRed(pixel)) / 255.0f, static_cast<float>(qGreen(pixel)) / 255.0f,
                static_cast<float>(qBlue(pixel)) / 255.0f},
               wanted, "bar");
    trigger("colour.bar");
    EXPECT_FALSE(bar().isVisible());
    trigger("colour.bar");
    trigger("pieces.colour");
    EXPECT_FALSE(bar().isVisible()) << "pieces have no values";
    trigger("colour.one");
    EXPECT_FALSE(action("pieces.colour").isChecked());
    EXPECT_FALSE(bar().isVisible());
}

TEST_F(ColourTest, WhatHasNoEffectIsDisabled) {
    child<QDockWidget>("colourDock")->raise();
    const auto expectMap = [this](bool isOn, const char* when) {
        for (const char* id : {"colour.viridis", "colour.grey", "colour.reverse", "colour.bar", "colour.automatic"})
            EXPECT_EQ(action(id).isEnabled(), isOn) << id << " " << when;
        EXPECT_EQ(child<QComboBox>("colourMap")->isEnabled(), isOn) << when;
        for (const char* name : {"colourLow", "colourHigh"})
            EXPECT_EQ(child<QLineEdit>(name)->isEnabled(), isOn) << name << " " << when;
        EXPECT_TRUE(child<QComboBox>("colourKey")->isEnabled()) << when;
    };
    expectMap(false, "of one colour");
    keepPicture(*window_, "colour_panel_one");
    choose("colour.x", ColourBy::X);
    expectMap(true, "by X");
    keepPicture(*window_, "colour_panel_x");
    trigger("pieces.colour");
    expectMap(false, "by pieces");
    trigger("colour.x");
    ASSERT_TRUE(waitUntil([this] { return action("colour.x").isChecked(); }));
    expectMap(true, "by X again");
    trigger("colour.one");
    expectMap(false, "of one colour again");
}

TEST_F(ColourTest, ARangeThatIsNoneIsPutBackWithAReason) {
    choose("colour.x", ColourBy::X);
    child<QDockWidget>("colourDock")->raise();
    auto *low = child<QLineEdit>("colourLow"), *high = child<QLineEdit>("colourHigh");
    const auto* note = child<QLabel>("colourNote");
    const auto before = colours().colours().range;
    const QString lowText = low->text();
    const auto type = [](QLineEdit* edit, const char* text) {
        edit->setFocus();
        edit->selectAll();
        QTest::keyClicks(edit, QLatin1String(text));
        QTest::keyClick(edit, Qt::Key_Return);
    };
    type(low, "900");
    EXPECT_EQ(colours().colours().range, before);
    EXPECT_EQ(low->text(), lowText);
    EXPECT_TRUE(note->text().contains(QStringLiteral("is above its last"))) << note->text().toStdString();
    if (low->hasFocus()) {
        EXPECT_TRUE(QToolTip::text().contains(QStringLiteral("is above its last"))) << QToolTip::text().toStdString();
    }
    keepPicture(*window_, "colour_range_backwards");
    QTest::keyClicks(low, QStringLiteral("1"));
    EXPECT_FALSE(note->text().contains(QStringLiteral("is above its last"))) << "something else is typed";
    type(high, "-5");
    EXPECT_TRUE(note->text().contains(QStringLiteral("is above its last")));
    type(high, "wide");
    EXPECT_TRUE(note->text().contains(QStringLiteral("is not a number"))) << note->text().toStdString();
    type(low, "2");
    type(high, "2");
    EXPECT_TRUE(note->text().contains(QStringLiteral("both its values"))) << note->text().toStdString();
    type(high, "9");
    EXPECT_EQ(colours().wanted().range, (ColourRange{2.0, 9.0}));
    EXPECT_FALSE(note->text().contains(QStringLiteral("range was not"))) << note->text().toStdString();
    type(low, "11");
    trigger("colour.y");
    EXPECT_FALSE(note->text().contains(QStringLiteral("is above its last"))) << "of what is not shown any more";
}

// On a white background, the least legible there is: against its plate.
TEST_F(ColourTest, TheWordsOfTheBarAreLegible) {
    choose("colour.x", ColourBy::X);
    auto content = bar().content();
    content.unit = QStringLiteral("mm");
    bar().setBar(content, bar().height());
    QImage picture(bar().size(), QImage::Format_RGB32);
    picture.fill(Qt::white);
    QPainter painter(&picture);
    bar().paint(painter);
    painter.end();
    const int line = bar().fontMetrics().height(), top = bar().fontMetrics().height() + 8; // of the unit
    double most = 1.0;
    const QColor plate(picture.pixel(3, top + line / 2));
    for (int y = top; y < top + line; ++y)
        for (int x = 8; x < picture.width() - 8; ++x)
            most = std::max(most, widgets::contrastOf(QColor(picture.pixel(x, y)), plate));
    EXPECT_GE(most, 4.5);
}

TEST_F(ColourTest, ChoicesAreUndoneAndKept) {
    letStepEnd();
    choose("colour.z", ColourBy::Z);
    letStepEnd();
    child<QDockWidget>("colourDock")->raise();
    auto* low = child<QLineEdit>("colourLow");
    low->setFocus();
    low->selectAll();
    QTest::keyClicks(low, QStringLiteral("3,5"));
    QTest::keyClick(low, Qt::Key_Return);
    ASSERT_EQ(colours().wanted().range, (ColourRange{3.5, kFieldPoints - 1.0}));
    EXPECT_FALSE(action("colour.automatic").isChecked());
    letStepEnd();
    keepPicture(*window_, "colour-panel");
    const auto path = folder_ / "kept.isosession";
    dialogs_.answers.push_back(qpath(path));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(path); }));
    trigger("edit.undo");
    EXPECT_FALSE(colours().wanted().range);
    EXPECT_EQ(colours().colours().by, ColourBy::Z);
    trigger("edit.undo");
    EXPECT_EQ(colours().colours().by, ColourBy::One);
    EXPECT_EQ(child<QComboBox>("colourKey")->currentIndex(), 0);
    trigger("edit.redo");
    EXPECT_EQ(colours().colours().by, ColourBy::Z);
    session_->close();
    EXPECT_EQ(colours().wanted().by, ColourBy::One);
    window_->openFile(qpath(path));
    ASSERT_TRUE(waitUntil([this] { return colours().colours().by == ColourBy::Z; }));
    EXPECT_EQ(colours().colours().range, (ColourRange{3.5, kFieldPoints - 1.0}));
    low->setFocus();
    low->selectAll();
    QTest::keyClicks(low, QStringLiteral("1e9"));
    QTest::keyClick(low, Qt::Key_Return);
    EXPECT_EQ(colours().colours().range, (ColourRange{3.5, kFieldPoints - 1.0})) << "it would not ascend";
}

} // namespace
} // namespace isoslider::test
