// Pictures of the real viewport against what geometry states they must be.
#include <cmath>
#include <numbers>

#include <QApplication>
#include <QImage>
#include <QMainWindow>
#include <QTest>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/image/ball_frame.h"
#include "ui/render/gl_support.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::test {
namespace {

constexpr int kBallPoints = 40;
constexpr double kRadius = 14.0; // cells

/// The surface, and nothing of the grey background, is warm: clearly more red than blue.
bool isSurface(QRgb pixel) { return qRed(pixel) > qBlue(pixel) + 12; }
bool isHighlight(QRgb pixel) { return qRed(pixel) > 110 && qRed(pixel) > 2 * qGreen(pixel); }

/// Cyan, as nothing else in the view.
bool isSpot(QRgb pixel) { return qBlue(pixel) > 100 && qGreen(pixel) > 80 && qBlue(pixel) > 2 * qRed(pixel); }

template <class Predicate>
std::size_t countPixels(const QImage& image, Predicate&& predicate) {
    std::size_t count = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            count += predicate(image.pixel(x, y)) ? 1 : 0;
    return count;
}

class ViewportImageTest : public ::testing::Test {
protected:
    void SetUp() override {
        if (!render::isOpenGlUsable())
            GTEST_SKIP() << "no OpenGL 3.3 here";
        viewport_ = std::make_unique<widgets::ViewportWidget>();
        viewport_->resize(600, 500);
        options_.showsBox = false;
        viewport_->setOptions(options_);
        viewport_->show();
        ASSERT_TRUE(QTest::qWaitForWindowExposed(viewport_.get()));
    }

    void show(std::shared_ptr<const extract::SurfaceFrame> frame, bool isPerspective = false) {
        const double radius = render::sceneRadius(frame->geometry);
        viewport_->changeCamera([&](model::Camera& camera) {
            camera.reset(radius);
            camera.setPerspective(isPerspective);
        });
        viewport_->setFrame(std::move(frame));
    }

    QImage grab() { return viewport_->grabFramebuffer().convertToFormat(QImage::Format_RGB32); }

    /// Pixels per world unit on the target plane.
    double pixelsPerUnit(const QImage& image) { return image.height() / (2.0 * viewport_->camera().halfHeight()); }

    void expectArea(const QImage& image, double expectedPixels, double tolerance) {
        const auto area = static_cast<double>(countPixels(image, isSurface));
        EXPECT_NEAR(area / expectedPixels, 1.0, tolerance) << area << " of " << expectedPixels << " pixels";
    }

    std::unique_ptr<widgets::ViewportWidget> viewport_;
    model::ViewOptions options_;
};

TEST_F(ViewportImageTest, AnOrthographicSphereCoversItsDisc) {
    show(sphereFrame(cubeGeometry(kBallPoints), kRadius));
    const QImage image = grab();
    const double radius = kRadius * pixelsPerUnit(image);
    expectArea(image, std::numbers::pi * radius * radius, 0.02);
}

TEST_F(ViewportImageTest, APerspectiveSphereCoversItsSilhouette) {
    show(sphereFrame(cubeGeometry(kBallPoints), kRadius), true);
    const QImage image = grab();
    const double distance = viewport_->camera().distance();
    const double silhouette = kRadius * distance / std::sqrt(distance * distance - kRadius * kRadius);
    const double radius = silhouette * pixelsPerUnit(image);
    expectArea(image, std::numbers::pi * radius * radius, 0.02);
}

TEST_F(ViewportImageTest, TheCentreIsBrightAndTheCornersAreBackground) {
    show(sphereFrame(cubeGeometry(kBallPoints), kRadius));
    const QImage image = grab();
    EXPECT_GT(qGray(image.pixel(image.width() / 2, image.height() / 2)), 150);
    for (const QPoint corner : {QPoint(2, 2), QPoint(image.width() - 3, 2), QPoint(2, image.height() - 3),
                                QPoint(image.width() - 3, image.height() - 3)}) {
        EXPECT_FALSE(isSurface(image.pixel(corner)));
        EXPECT_LT(qGray(image.pixel(corner)), 80);
    }
}

TEST_F(ViewportImageTest, EveryPixelIsOpaque) {
    options_.showsBox = true;
    viewport_->setOptions(options_);
    show(sphereFrame(cubeGeometry(kBallPoints), kRadius));
    const QImage image = viewport_->grabFramebuffer().convertToFormat(QImage::Format_ARGB32);
    EXPECT_EQ(countPixels(image, [](QRgb pixel) { return qAlpha(pixel) != 255; }), 0u);
}

TEST_F(ViewportImageTest, AnisotropicSpacingStretchesTheSphere) {
    auto geometry = cubeGeometry(kBallPoints);
    geometry.spacing = {1.0, 1.0, 2.0};
    show(sphereFrame(geometry, kRadius));
    viewport_->changeCamera([](model::Camera& camera) { camera.setStandardView(model::StandardView::Front); });
    const QImage image = grab();
    const double scale = pixelsPerUnit(image);
    expectArea(image, std::numbers::pi * kRadius * kRadius * 2.0 * scale * scale, 0.02);
    const int x = image.width() / 2;
    const int y = image.height() / 2;
    EXPECT_TRUE(isSurface(image.pixel(x, y - static_cast<int>(kRadius * 1.8 * scale))));
    EXPECT_FALSE(isSurface(image.pixel(x + static_cast<int>(kRadius * 1.1 * scale), y)));
}

TEST_F(ViewportImageTest, ALeftHandedVolumeIsSeenFromOutside) {
    show(sphereFrame(cubeGeometry(kBallPoints), kRadius));
    viewport_->changeCamera([](model::Camera& camera) { camera.setStandardView(model::StandardView::Front); });
    const QImage rightHanded = grab();
    auto mirrored = cubeGeometry(kBallPoints);
    mirrored.direction[0] = {-1.0, 0.0, 0.0};
    show(sphereFrame(mirrored, kRadius));
    viewport_->changeCamera([](model::Camera& camera) { camera.setStandardView(model::StandardView::Front); });
    const QImage leftHanded = grab();
    const QPoint centre(rightHanded.width() / 2, rightHanded.height() / 2);
    // The back faces' darker tint would show at once.
    EXPECT_NEAR(qGray(leftHanded.pixel(centre)), qGray(rightHanded.pixel(centre)), 6);
    EXPECT_GT(qGray(leftHanded.pixel(centre + QPoint(-60, -60))), 120);
}

TEST_F(ViewportImageTest, FarFromTheOriginThePictureIsTheSame) {
    show(sphereFrame(cubeGeometry(kBallPoints), kRadius));
    const QImage near = grab();
    auto geometry = cubeGeometry(kBallPoints);
    geometry.origin = {1e7, -3e7, 2e7};
    show(sphereFrame(geometry, kRadius));
    const QImage far = grab();
    std::size_t different = 0;
    for (int y = 0; y < near.height(); ++y)
        for (int x = 0; x < near.width(); ++x)
            different += std::abs(qGray(near.pixel(x, y)) - qGray(far.pixel(x, y))) > 8 ? 1 : 0;
    EXPECT_LT(different, 20u);
}

TEST_F(ViewportImageTest, WhatChangedIsHighlightedWhereItIs) {
    auto frame = sphereFrame(cubeGeometry(kBallPoints), kRadius);
    // The half nearer to the default camera's right: every triangle with x beyond the middle.
    for (std::size_t i = 0; i + 2 < frame->indices.size(); i += 3)
        if (frame->positions[frame->indices[i]].x > (kBallPoints - 1) / 2.0f)
            frame->changedIndices.insert(frame->changedIndices.end(),
                                         frame->indices.begin() + static_cast<std::ptrdiff_t>(i),
                                         frame->indices.begin() + static_cast<std::ptrdiff_t>(i) + 3);
    show(frame);
    viewport_->changeCamera([](model::Camera& camera) { camera.setStandardView(model::StandardView::Front); });
    EXPECT_EQ(countPixels(grab(), isHighlight), 0u) << "unless asked for";
    options_.showsChanged = true;
    viewport_->setOptions(options_);
    const QImage highlighted = grab();
    const auto surface = countPixels(highlighted, isSurface);
    const auto highlight = countPixels(highlighted, isHighlight);
    EXPECT_NEAR(static_cast<double>(highlight) / static_cast<double>(surface), 0.5, 0.08);
    const QPoint centre(highlighted.width() / 2, highlighted.height() / 2);
    EXPECT_TRUE(isHighlight(highlighted.pixel(centre + QPoint(40, 0))));
    EXPECT_FALSE(isHighlight(highlighted.pixel(centre - QPoint(40, 0))));

    options_.showsChanged = false;
    viewport_->setOptions(options_);
    EXPECT_EQ(countPixels(grab(), isHighlight), 0u);
}

TEST_F(ViewportImageTest, ASpotIsHighlightedAndGoesAgain) {
    show(sphereFrame(cubeGeometry(kBallPoints), kRadius));
    viewport_->changeCamera([](model::Camera& camera) {
        camera.setStandardView(model::StandardView::Front);
        camera.zoom(3.0, {0.0, 0.0}, 1.0);
    });
    const double middle = (kBallPoints - 1) / 2.0;
    const QImage plain = grab();
    ASSERT_EQ(countPixels(plain, isSpot), 0u);
    viewport_->setSpot(glm::dvec3(middle, middle - kRadius, middle)); // nearest to the viewer
    const QImage image = grab();
    const double cell = pixelsPerUnit(image);
    const QPoint centre(image.width() / 2, image.height() / 2);
    EXPECT_TRUE(isSpot(image.pixel(centre)));
    EXPECT_TRUE(isSpot(image.pixel(centre + QPoint(static_cast<int>(0.9 * cell), 0))));
    EXPECT_TRUE(isSurface(image.pixel(centre + QPoint(static_cast<int>(2.2 * cell), 0)))) << "other cells are not";
    EXPECT_FALSE(isHighlight(image.pixel(centre)));
    viewport_->setSpot(glm::dvec3(middle, middle - kRadius, middle), 0.35f);
    const QRgb faint = grab().pixel(centre);
    EXPECT_FALSE(isSpot(faint));
    EXPECT_NE(faint, plain.pixel(centre));
    viewport_->setSpot(std::nullopt);
    EXPECT_EQ(grab(), plain);
}

TEST_F(ViewportImageTest, ASpotBehindTheSurfaceHasARingAllTheSame) {
    show(sphereFrame(cubeGeometry(kBallPoints), kRadius));
    viewport_->changeCamera([](model::Camera& camera) { camera.setStandardView(model::StandardView::Front); });
    const double middle = (kBallPoints - 1) / 2.0;
    const QImage plain = grab();
    viewport_->setSpot(glm::dvec3(middle, middle + kRadius, middle));
    const QImage image = grab();
    const QPoint centre(image.width() / 2, image.height() / 2);
    EXPECT_EQ(image.pixel(centre), plain.pixel(centre)) << "the surface before it is not highlighted";
    const auto ring = countPixels(image, isSpot);
    EXPECT_GT(ring, 80u);
    EXPECT_LT(ring, 700u);
    viewport_->changeCamera([](model::Camera& camera) { camera.setPerspective(true); });
    viewport_->setSpot(glm::dvec3(middle, -1e6, middle)); // behind the viewer
    EXPECT_EQ(countPixels(grab(), isSpot), 0u);
}

TEST_F(ViewportImageTest, ASpotOnWhatChangedIsSeen) {
    auto frame = sphereFrame(cubeGeometry(kBallPoints), kRadius);
    frame->changedIndices.assign(frame->indices.begin(),
                                 frame->indices.begin() + static_cast<std::ptrdiff_t>(frame->indices.size() / 30 * 27));
    show(frame);
    viewport_->changeCamera([](model::Camera& camera) {
        camera.setStandardView(model::StandardView::Front);
        camera.zoom(3.0, {0.0, 0.0}, 1.0);
    });
    const double middle = (kBallPoints - 1) / 2.0;
    options_.showsChanged = true;
    viewport_->setOptions(options_);
    const QPoint centre(300, 250);
    ASSERT_TRUE(isHighlight(grab().pixel(centre)));
    viewport_->setSpot(glm::dvec3(middle, middle - kRadius, middle));
    EXPECT_TRUE(isSpot(grab().pixel(centre)));
}

TEST_F(ViewportImageTest, ASurfaceThatIsNewThroughoutIsNotHighlighted) {
    auto frame = sphereFrame(cubeGeometry(kBallPoints), kRadius);
    frame->changedIndices = frame->indices;
    show(frame);
    EXPECT_EQ(countPixels(grab(), isHighlight), 0u);
}

TEST_F(ViewportImageTest, ANewFrameReplacesTheOldOne) {
    show(sphereFrame(cubeGeometry(kBallPoints), 14.0));
    const auto large = countPixels(grab(), isSurface);
    viewport_->setFrame(sphereFrame(cubeGeometry(kBallPoints), 7.0));
    const auto small = countPixels(grab(), isSurface);
    EXPECT_NEAR(static_cast<double>(small) / static_cast<double>(large), 0.25, 0.02);
    viewport_->setFrame(nullptr);
    EXPECT_EQ(countPixels(grab(), isSurface), 0u);
}

double meanX(const QImage& image) {
    double sum = 0.0, count = 0.0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            if (isSurface(image.pixel(x, y))) {
                sum += x;
                ++count;
            }
    return sum / count;
}

TEST_F(ViewportImageTest, APartOfTheVolumeIsDrawnAtItsPlace) {
    auto frame = sphereFrame(cubeGeometry(kBallPoints), kRadius);
    show(frame);
    viewport_->changeCamera([](model::Camera& camera) { camera.setStandardView(model::StandardView::Front); });
    const double middle = meanX(grab());
    GridGeometry volume = frame->geometry;
    volume.dims[0] += 6; // its centre is three cells further
    viewport_->setFrame(nullptr);
    viewport_->setFrame(frame, volume);
    const QImage image = grab();
    EXPECT_NEAR(std::abs(meanX(image) - middle), 3.0 * volume.spacing.x * pixelsPerUnit(image), 1.0);
}

TEST_F(ViewportImageTest, ThePictureSurvivesANewContext) {
    show(sphereFrame(cubeGeometry(kBallPoints), kRadius));
    const auto before = countPixels(grab(), isSurface);
    // Another window means another context: everything on the GPU is made again.
    QMainWindow other;
    other.resize(600, 500);
    auto* viewport = viewport_.get();
    other.setCentralWidget(viewport_.release());
    other.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&other));
    QTest::qWait(50);
    const QImage image = viewport->grabFramebuffer().convertToFormat(QImage::Format_RGB32);
    EXPECT_NEAR(static_cast<double>(countPixels(image, isSurface)) / static_cast<double>(before), 1.0, 0.03);
}

} // namespace
} // namespace isoslider::test
