// What is darkened where light from all sides would not come: hollows are, planes are not, at any scale.
#include <algorithm>
#include <cmath>

#include <QImage>
#include <QTest>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "tests/support/result_matchers.h"
#include "ui/render/gl_support.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::test {
namespace {

constexpr int kGroovePoints = 33;
constexpr double kGrooveMiddle = 16.0;

/// A plane across z with a groove along y, seen from above.
std::shared_ptr<extract::SurfaceFrame> groove(double unit) {
    GridGeometry geometry;
    geometry.dims = {kGroovePoints, kGroovePoints, kGroovePoints};
    geometry.spacing = glm::dvec3(unit);
    std::vector<float> values;
    for (int z = 0; z < kGroovePoints; ++z)
        for (int y = 0; y < kGroovePoints; ++y)
            for (int x = 0; x < kGroovePoints; ++x) {
                const double depth = 6.0 * std::max(0.0, 1.0 - std::abs(x - kGrooveMiddle) / 3.0);
                values.push_back(static_cast<float>(z - (20.1 - depth)));
            }
    const auto grid = ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values);
    auto mesh = extract::extractFull(grid, 0.0).value();
    auto frame = std::make_shared<extract::SurfaceFrame>();
    frame->geometry = geometry;
    frame->isovalue = 0.0;
    frame->stats.triangles = mesh.triangles.size() / 3;
    frame->indices = std::move(mesh.triangles);
    frame->positions = std::move(mesh.positions);
    frame->normals = std::move(mesh.normals);
    return frame;
}

class AmbientOcclusionTest : public ::testing::Test {
protected:
    void SetUp() override {
        if (!render::isOpenGlUsable())
            GTEST_SKIP() << "no OpenGL 3.3 here";
        viewport_ = std::make_unique<widgets::ViewportWidget>();
        viewport_->resize(401, 333); // halves that do not come out even
        viewport_->show();
        ASSERT_TRUE(QTest::qWaitForWindowExposed(viewport_.get()));
        options_.showsBox = false;
        options_.stage.light = model::Light::Headlight;
    }
    QImage grab(const std::shared_ptr<const extract::SurfaceFrame>& frame, bool hasOcclusion,
                bool isPerspective = true) {
        options_.stage.hasOcclusion = hasOcclusion;
        viewport_->setOptions(options_);
        viewport_->changeCamera([&](model::Camera& camera) {
            camera.reset(render::sceneRadius(frame->geometry));
            model::CameraPose pose = camera.pose();
            pose.orientation = model::standardOrientation(model::StandardView::Top);
            pose.isPerspective = isPerspective;
            camera.setPose(pose);
            camera.zoom(2.5, {0.0, 0.0}, 1.2);
        });
        viewport_->setFrame(frame);
        return viewport_->grabFramebuffer().convertToFormat(QImage::Format_RGB32);
    }
    /// How much of its light the picture keeps so far beside the middle, as a part of half its height; the mean of a
    /// column.
    static double kept(const QImage& with, const QImage& without, double across) {
        const int x = with.width() / 2 + static_cast<int>(across * with.height() / 2);
        double sum = 0.0, all = 0.0;
        for (int y = with.height() / 4; y < with.height() * 3 / 4; ++y) {
            sum += qGray(with.pixel(x, y));
            all += qGray(without.pixel(x, y));
        }
        return sum / all;
    }

    std::unique_ptr<widgets::ViewportWidget> viewport_;
    model::ViewOptions options_;
};

TEST_F(AmbientOcclusionTest, DarkensHollowsAndNoPlanes) {
    const auto frame = groove(1.0);
    for (const bool isPerspective : {true, false}) {
        const QImage plain = grab(frame, false, isPerspective), image = grab(frame, true, isPerspective);
        EXPECT_LT(kept(image, plain, 0.0), 0.87) << isPerspective << ": at the bottom";
        EXPECT_NEAR(kept(image, plain, 0.6), 1.0, 0.01) << isPerspective << ": on the plane";
        EXPECT_NEAR(kept(image, plain, -0.6), 1.0, 0.01) << isPerspective;
        EXPECT_NEAR(kept(image, plain, 0.1), kept(image, plain, -0.1), 0.05)
            << isPerspective << ": alike on both sides";
        EXPECT_EQ(image.pixel(1, 1), plain.pixel(1, 1)) << "the background stays";
        EXPECT_EQ(grab(frame, false, isPerspective), plain);
    }
}

TEST_F(AmbientOcclusionTest, HasNoPatternAndNoScale) {
    const QImage image = grab(groove(1.0), true);
    const int x = image.width() / 2;
    for (int y = image.height() / 3; y < image.height() * 2 / 3; ++y)
        EXPECT_NEAR(qGray(image.pixel(x, y)), qGray(image.pixel(x, y + 1)), 8) << y << ": along the groove";
    for (const double unit : {1e-6, 1e7}) {
        const QImage other = grab(groove(unit), true);
        for (int u = 10; u < image.width() - 10; u += 7)
            EXPECT_NEAR(qGray(image.pixel(u, image.height() / 2)), qGray(other.pixel(u, image.height() / 2)), 3)
                << unit << ' ' << u;
    }
}

} // namespace
} // namespace isoslider::test
