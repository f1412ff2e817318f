// Background, light and stretched axes: menus, dialog, pictures, what is kept and undone.
#include <fstream>
#include <vector>

#include <QAction>
#include <QDialog>
#include <QDoubleSpinBox>
#include <QImage>
#include <QLabel>
#include <QPushButton>
#include <QtTest>

#include <glm/geometric.hpp>

#include "tests/gui/window_fixture.h"
#include "ui/widgets/slices/slice_pane.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::test {
namespace {

using model::Background;
using model::Light;

class StageTest : public WindowTest {
protected:
    void SetUp() override {
        if (window_->viewportHost().viewport() == nullptr)
            GTEST_SKIP() << "no OpenGL 3.3 here";
        openBall();
        slideTo(-8.0);
        QTest::keyClick(window_.get(), Qt::Key_1); // looks along +Y: X to the right, Z upwards
        QTest::keyClick(window_.get(), Qt::Key_5); // without perspective
    }
    void slideTo(double isovalue) {
        ASSERT_TRUE(session_->isovalue().request(isovalue));
        ASSERT_TRUE(waitUntil([&] { return session_->isovalue().displayed() == isovalue; }));
    }
    widgets::ViewportWidget& viewport() { return *window_->viewportHost().viewport(); }
    const model::Stage& stage() { return window_->viewportHost().viewState().options().stage; }
    QAction& action(const char* id) { return *window_->actions().action(id); }
    void stretchTo(const glm::dvec3& stretch) {
        auto options = window_->viewportHost().viewState().options();
        options.stage.stretch = stretch;
        window_->viewportHost().viewState().setOptions(options);
    }
    /// Pixels across and down that differ from the picture without a surface.
    QSize seenSize() {
        const QImage with = viewport().grabFramebuffer();
        auto surfaces = session_->surfaces().list();
        surfaces.surfaces[0].isVisible = false;
        session_->surfaces().setList(surfaces);
        const QImage without = viewport().grabFramebuffer();
        surfaces.surfaces[0].isVisible = true;
        session_->surfaces().setList(surfaces);
        QRect seen;
        for (int y = 0; y < with.height(); ++y)
            for (int x = 0; x < with.width(); ++x)
                if (with.pixel(x, y) != without.pixel(x, y))
                    seen |= QRect(x, y, 1, 1);
        return seen.size();
    }
    /// A volume whose third axis has another unit.
    std::filesystem::path writeNeedle() {
        constexpr int kPoints = 20;
        std::vector<float> samples;
        for (int k = 0; k < kPoints; ++k)
            for (int j = 0; j < kPoints; ++j)
                for (int i = 0; i < kPoints; ++i)
                    samples.push_back(static_cast<float>(-(i - 9.5) * (i - 9.5) - (j - 9.5) * (j - 9.5) - k));
        const auto path = folder_ / "needle.mha";
        std::ofstream file(path, std::ios::binary);
        file << "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                "ElementSpacing = 1 1 100\nDimSize = 20 20 20\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n";
        file.write(reinterpret_cast<const char*>(samples.data()),
                   static_cast<std::streamsize>(samples.size() * sizeof(float)));
        return path;
    }
    void openNeedle() {
        const auto before = session_->datasetGeneration();
        window_->openFile(QString::fromStdString(writeNeedle().string()));
        ASSERT_TRUE(waitUntil([&] { return session_->datasetGeneration() != before && session_->frame() != nullptr; }));
        ASSERT_TRUE(waitUntilSettled());
    }
};

TEST_F(StageTest, BackgroundsAreChosenKeptAndUndone) {
    const auto cornerOf = [this] { return viewport().grabFramebuffer().pixelColor(2, 2); };
    const QColor dark = cornerOf();
    EXPECT_LT(dark.lightness(), 80);
    EXPECT_TRUE(action("stage.dark").isChecked());
    trigger("stage.white");
    EXPECT_EQ(cornerOf(), QColor(Qt::white));
    EXPECT_EQ(settings_->text("view/background"), QStringLiteral("white"));
    EXPECT_TRUE(action("stage.white").isChecked());
    EXPECT_FALSE(action("stage.dark").isChecked());
    trigger("stage.light");
    EXPECT_GT(cornerOf().lightness(), 200);
    keepPicture(*window_, "light_background");
    trigger("stage.light");
    EXPECT_TRUE(action("stage.light").isChecked()) << "one of them is always";
    trigger("stage.black");
    EXPECT_EQ(cornerOf(), QColor(Qt::black));
    QTest::qWait(600); // a separate step
    trigger("edit.undo");
    EXPECT_EQ(cornerOf(), dark) << "changes at once are one step";
    EXPECT_TRUE(action("stage.dark").isChecked());
    trigger("edit.redo");
    EXPECT_EQ(stage().background, Background::Black);
    makeWindow();
    EXPECT_EQ(stage().background, Background::Black) << "the next window begins with it";
}

TEST_F(StageTest, AmbientOcclusionIsChosenKeptAndUndone) {
    EXPECT_TRUE(stage().hasOcclusion) << "unless the settings say otherwise";
    auto options = window_->viewportHost().viewState().options();
    options.clipping.plane() = {true, {0.0, 0.0, 1.0}, 10.0, model::Cap::None}; // the ball is open: it has an inside
    window_->viewportHost().viewState().setOptions(options);
    QTest::qWait(600); // a separate step
    const QImage with = viewport().grabFramebuffer();
    trigger("stage.occlusion");
    EXPECT_FALSE(stage().hasOcclusion);
    EXPECT_FALSE(settings_->boolean("view/occlusion"));
    EXPECT_NE(viewport().grabFramebuffer(), with);
    QTest::qWait(600); // a separate step
    trigger("edit.undo");
    EXPECT_TRUE(action("stage.occlusion").isChecked());
    EXPECT_EQ(viewport().grabFramebuffer(), with);
    makeWindow();
    EXPECT_FALSE(stage().hasOcclusion) << "the next window begins with it";
}

TEST_F(StageTest, LightsShowTheSurfaceFromOtherSides) {
    const auto at = [this](double across) {
        const QImage picture = viewport().grabFramebuffer();
        return picture.pixelColor(picture.rect().center() + QPoint(static_cast<int>(across * picture.height()), 0))
            .lightness();
    };
    const double rim = 0.12;
    EXPECT_GT(at(-rim), at(rim)) << "from the left";
    trigger("stage.headlight");
    EXPECT_NEAR(at(-rim), at(rim), 6);
    EXPECT_EQ(stage().light, Light::Headlight);
    const int middle = at(0.0);
    trigger("stage.raking");
    EXPECT_LT(at(0.0), middle - 30);
    EXPECT_GT(at(-rim), at(rim) + 40);
    EXPECT_EQ(settings_->text("view/light"), QStringLiteral("raking"));
    trigger("stage.studio");
    EXPECT_EQ(stage().light, Light::Studio);
}

TEST_F(StageTest, AStretchedAxisIsDrawnLongerAndMeasuredAsItIs) {
    const QSize before = seenSize();
    const double area = session_->frame()->stats.triangles;
    EXPECT_TRUE(action("stage.stretch").isEnabled());
    trigger("stage.stretch");
    auto* dialog = window_->findChild<QDialog*>(QStringLiteral("stretchDialog"));
    ASSERT_NE(dialog, nullptr);
    auto* factor = dialog->findChild<QDoubleSpinBox*>(QStringLiteral("stretchZ"));
    EXPECT_EQ(factor->value(), 1.0);
    factor->setFocus();
    factor->selectAll();
    QTest::keyClicks(factor, QStringLiteral("3"));
    QTest::keyClick(factor, Qt::Key_Return);
    EXPECT_EQ(stage().stretch, glm::dvec3(1.0, 1.0, 3.0));
    EXPECT_TRUE(dialog->isVisible()) << "Return takes the number";
    const QSize after = seenSize();
    EXPECT_NEAR(static_cast<double>(after.height()) / after.width(), 3.0 * before.height() / before.width(), 0.1);
    EXPECT_EQ(session_->frame()->stats.triangles, area);
    EXPECT_EQ(child<QLabel>("legend")->text(), QStringLiteral("stretched: Z × 3"));
    keepPicture(*dialog, "stretch_dialog");
    keepPicture(*window_, "stretched");
    // What is below the pointer is found where it is drawn: the top of the ball, which was elsewhere before.
    const auto& camera = viewport().camera();
    const double aspect = static_cast<double>(viewport().width()) / viewport().height();
    const glm::dvec4 top = camera.projectionMatrix(aspect) * camera.viewMatrix() * glm::dvec4(0.0, 0.0, 7.9, 1.0);
    const QPointF point((top.x / top.w + 1.0) / 2.0 * viewport().width(),
                        (1.0 - top.y / top.w) / 2.0 * viewport().height());
    EXPECT_LT(point.y(), 0.5 * viewport().height() - 0.45 * after.height() / viewport().devicePixelRatioF());
    const auto line = viewport().lineOfSight(point);
    ASSERT_TRUE(line);
    EXPECT_NEAR(line->first.z, 11.5 + 7.9, 1e-6);
    EXPECT_NEAR(line->second.z, 11.5 + 7.9, 1e-6);
    QTest::mouseClick(dialog->findChild<QPushButton*>(QStringLiteral("stretchNone")), Qt::LeftButton);
    EXPECT_EQ(stage().stretch, glm::dvec3(1.0));
    EXPECT_EQ(factor->value(), 1.0);
    EXPECT_TRUE(child<QLabel>("legend")->isHidden());
    EXPECT_EQ(seenSize(), before);
    dialog->close();
}

TEST_F(StageTest, AStretchIsUndoneAndEndsWithTheVolume) {
    QTest::qWait(600);
    stretchTo({2.0, 1.0, 1.0});
    QTest::qWait(600);
    const auto stretched = viewport().camera().viewMatrix();
    trigger("edit.undo");
    EXPECT_EQ(stage().stretch, glm::dvec3(1.0));
    EXPECT_EQ(viewport().camera().stretch(), glm::dmat3(1.0));
    trigger("edit.redo");
    EXPECT_EQ(viewport().camera().viewMatrix(), stretched);
    stretchTo({1e9, 1.0, 1.0});
    EXPECT_EQ(stage().stretch.x, model::kMostStretch);
    const auto before = session_->datasetGeneration();
    openBall(20);
    ASSERT_TRUE(waitUntil([&] { return session_->datasetGeneration() != before; }));
    EXPECT_EQ(stage().stretch, glm::dvec3(1.0));
    EXPECT_EQ(viewport().camera().stretch(), glm::dmat3(1.0));
}

TEST_F(StageTest, FitToSurfaceShowsAllOfWhatIsStretched) {
    stretchTo({1.0, 1.0, 4.0});
    trigger("view.fit");
    const double height = viewport().height() * viewport().devicePixelRatioF();
    EXPECT_TRUE(waitUntil([&] { return seenSize().height() > 0.8 * height; })) << "once the camera has arrived";
    ASSERT_TRUE(waitUntil([this] {
        const double distance = viewport().camera().distance();
        QTest::qWait(60);
        return viewport().camera().distance() == distance;
    }));
    EXPECT_GT(seenSize().height(), 0.8 * height);
    EXPECT_LT(seenSize().height(), 0.999 * height);
}

TEST_F(StageTest, IsOfferedForANeedleAndTakenInSlicesToo) {
    EXPECT_FALSE(window_->messageBar().isVisible()) << "a ball needs none";
    trigger("slices.paneX");
    openNeedle();
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("Z × 0.01")))
        << window_->messageBar().text().toStdString();
    auto& pane = *child<widgets::SlicePane>("slicePaneX");
    const auto heightOf = [&] {
        return std::abs(pane.pointOf(glm::dvec3(10.0, 0.0, 19.0)).y() - pane.pointOf(glm::dvec3(10.0, 0.0, 0.0)).y());
    };
    const auto widthOf = [&] {
        return std::abs(pane.pointOf(glm::dvec3(10.0, 19.0, 0.0)).x() - pane.pointOf(glm::dvec3(10.0, 0.0, 0.0)).x());
    };
    EXPECT_GT(heightOf(), 50.0 * widthOf());
    keepPicture(*window_, "needle");
    QPushButton* offer = nullptr;
    for (auto* button : window_->messageBar().findChildren<QPushButton*>())
        offer = button->isVisible() ? button : offer;
    ASSERT_NE(offer, nullptr);
    QTest::mouseClick(offer, Qt::LeftButton);
    EXPECT_EQ(stage().stretch, glm::dvec3(1.0, 1.0, 0.01));
    EXPECT_FALSE(window_->messageBar().isVisible());
    EXPECT_NEAR(heightOf(), widthOf(), 0.02 * widthOf());
    EXPECT_NEAR(glm::length(viewport().camera().stretch()[2]), 0.01, 1e-12);
    keepPicture(*window_, "needle_stretched");
}

} // namespace
} // namespace isoslider::test
