// Pieces of the surface, each in a separate colour, and pieces that are hidden: from records as from arrays.
#include <cmath>

#include <QImage>
#include <QTest>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/extract/live/brick_picture.h"
#include "core/extract/slide_engine.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/support/result_matchers.h"
#include "ui/render/gl_support.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::test {
namespace {

using extract::SurfaceFrame;

constexpr int kConePoints = 48;

/// Eight balls of different sizes, apart from each other below 0.
std::shared_ptr<const ScalarGrid> balls() {
    GridGeometry geometry;
    geometry.dims = {kConePoints, kConePoints, kConePoints};
    std::vector<float> values;
    for (int z = 0; z < kConePoints; ++z)
        for (int y = 0; y < kConePoints; ++y)
            for (int x = 0; x < kConePoints; ++x) {
                float value = -100.0f;
                for (int ball = 0; ball < 8; ++ball) {
                    const auto middle = [&](int bit) { return (ball & bit) != 0 ? 36.0f : 12.0f; };
                    const float radius = 2.5f + static_cast<float>(ball);
                    value = std::max(value, radius - std::hypot(static_cast<float>(x) - middle(1),
                                                                static_cast<float>(y) - middle(2),
                                                                static_cast<float>(z) - middle(4)));
                }
                values.push_back(value);
            }
    return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values));
}

model::PieceOptions pieces(bool isColoured, double leastSize) {
    model::PieceOptions options;
    options.isColoured = isColoured;
    options.leastSize = leastSize;
    return options;
}

class PieceTintsTest : public ::testing::Test {
protected:
    void SetUp() override {
        if (!render::isOpenGlUsable())
            GTEST_SKIP() << "no OpenGL 3.3 here";
        viewport_ = std::make_unique<widgets::ViewportWidget>();
        viewport_->resize(500, 420);
        viewport_->show();
        ASSERT_TRUE(QTest::qWaitForWindowExposed(viewport_.get()));
        auto engine = preprocess::makeMemoryEngine(balls());
        ASSERT_THAT(engine, IsOk());
        engine_ = std::move(engine).value();
    }
    std::shared_ptr<SurfaceFrame> slideTo(double isovalue) {
        EXPECT_THAT(engine_->slideTo(isovalue), IsOk());
        auto frame = std::make_shared<SurfaceFrame>();
        engine_->copyFrame(*frame, {.pieces = true});
        EXPECT_NE(frame->pieces, nullptr);
        return frame;
    }
    static std::shared_ptr<SurfaceFrame> arraysOf(const SurfaceFrame& frame) {
        auto arrays = std::make_shared<SurfaceFrame>(frame);
        expandPicture(*arrays);
        EXPECT_EQ(arrays->bricks, nullptr);
        return arrays;
    }
    QImage grab(std::shared_ptr<const SurfaceFrame> frame, const model::PieceOptions& shown) {
        model::ViewOptions options;
        options.showsBox = false;
        options.pieces = shown;
        viewport_->changeCamera([&](model::Camera& camera) { camera.reset(render::sceneRadius(frame->geometry)); });
        viewport_->setOptions(options);
        viewport_->setFrame(std::move(frame));
        return viewport_->grabFramebuffer().convertToFormat(QImage::Format_RGB32);
    }
    static int largestDifference(const QImage& a, const QImage& b) {
        int largest = 0;
        for (int y = 0; y < a.height(); ++y)
            for (int x = 0; x < a.width(); ++x) {
                const QRgb p = a.pixel(x, y), q = b.pixel(x, y);
                largest = std::max({largest, std::abs(qRed(p) - qRed(q)), std::abs(qGreen(p) - qGreen(q)),
                                    std::abs(qBlue(p) - qBlue(q))});
            }
        return largest;
    }
    /// Pixels of colours that are clearly no grey, by sixths of the circle of hues.
    static std::array<int, 6> hues(const QImage& image) {
        std::array<int, 6> counts{};
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x)
                if (const QColor colour = image.pixelColor(x, y); colour.saturation() > 60 && colour.value() > 60)
                    ++counts[static_cast<std::size_t>(colour.hue() / 60)];
        return counts;
    }
    static int lit(const QImage& image) {
        int count = 0;
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x)
                count += image.pixelColor(x, y).value() > 90;
        return count;
    }

    std::unique_ptr<widgets::ViewportWidget> viewport_;
    std::unique_ptr<extract::SlideEngine> engine_;
};

TEST_F(PieceTintsTest, EachPieceHasItsColourInRecordsAndInArrays) {
    const auto frame = slideTo(0.1);
    ASSERT_EQ(frame->pieces->pieces().size(), 8u);
    const QImage plain = grab(frame, {}), coloured = grab(frame, pieces(true, 0.0));
    EXPECT_EQ(hues(plain)[3], 0) << "cyan and blue";
    int seen = 0;
    for (const int count : hues(coloured))
        seen += count > 100;
    EXPECT_GE(seen, 4);
    EXPECT_LE(largestDifference(coloured, grab(arraysOf(*frame), pieces(true, 0.0))), 2);
    EXPECT_EQ(largestDifference(plain, grab(frame, {})), 0) << "without colours again";
}

/// Of colours in linear light, as eyes tell them apart (CIE 1976, white of D65): 2 or so is just seen.
double differenceOf(const model::PieceTint& a, const model::PieceTint& b) {
    const auto lab = [](const model::PieceTint& tint) {
        const double red = tint[0] / 255.0, green = tint[1] / 255.0, blue = tint[2] / 255.0;
        const auto root = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
        const double x = root((0.4124 * red + 0.3576 * green + 0.1805 * blue) / 0.9505),
                     y = root(0.2126 * red + 0.7152 * green + 0.0722 * blue),
                     z = root((0.0193 * red + 0.1192 * green + 0.9505 * blue) / 1.089);
        return glm::dvec3(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z));
    };
    return glm::distance(lab(a), lab(b));
}

TEST(PieceColours, NoneIsLikeThatOfTheSelectedPiece) {
    constexpr int kSide = 4, kApart = 8, kPoints = kSide * kApart; // more balls than there are colours
    GridGeometry geometry;
    geometry.dims = {kPoints, kPoints, kPoints};
    std::vector<float> values;
    for (int z = 0; z < kPoints; ++z)
        for (int y = 0; y < kPoints; ++y)
            for (int x = 0; x < kPoints; ++x)
                values.push_back(3.0f - std::hypot(static_cast<float>(x % kApart) - 3.6f,
                                                   static_cast<float>(y % kApart) - 3.6f,
                                                   static_cast<float>(z % kApart) - 3.6f));
    auto engine = preprocess::makeMemoryEngine(
        std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values)));
    ASSERT_THAT(engine, IsOk());
    ASSERT_THAT(engine.value()->slideTo(0.5), IsOk());
    SurfaceFrame frame;
    engine.value()->copyFrame(frame, {.pieces = true});
    const auto all = frame.pieces->pieces();
    ASSERT_EQ(all.size(), static_cast<std::size_t>(kSide * kSide * kSide));
    model::PieceOptions options = pieces(true, 0.0);
    options.selected = all[0].id;
    const model::PieceDisplay display(*frame.pieces, geometry, options);
    const model::PieceTint selected = display.tint(0);
    for (std::size_t piece = 0; piece < all.size(); ++piece)
        EXPECT_GT(differenceOf(selected, display.colour(piece)), 50.0)
            << "colour of piece " << all[piece].id.number() + 1;
}

TEST_F(PieceTintsTest, SmallPiecesAreNotDrawn) {
    const auto frame = slideTo(0.1);
    const double largest = model::sizeOf(frame->pieces->pieces()[0], frame->geometry);
    const int all = lit(grab(frame, {})), few = lit(grab(frame, pieces(false, 0.6 * largest))),
              one = lit(grab(frame, pieces(false, largest)));
    EXPECT_LT(few, all - 500);
    EXPECT_LT(one, few - 500);
    EXPECT_GT(one, 1000);
    const auto half = pieces(false, 0.6 * largest);
    EXPECT_LE(largestDifference(grab(frame, half), grab(arraysOf(*frame), half)), 2);
    EXPECT_EQ(lit(grab(frame, pieces(false, 10.0 * largest))), 0);
}

TEST_F(PieceTintsTest, ColoursStayWhileThePiecesGrowAndAreSentOnce) {
    const auto colours = pieces(true, 0.0);
    const QImage first = grab(slideTo(0.5), colours);
    const auto slid = slideTo(0.25);
    const QImage second = grab(slid, colours);
    // All but the rims of the balls.
    int changed = 0, coloured = 0;
    for (int y = 0; y < first.height(); ++y)
        for (int x = 0; x < first.width(); ++x) {
            const QColor a = first.pixelColor(x, y), b = second.pixelColor(x, y);
            const bool hasColour = a.saturation() > 60 && b.saturation() > 60;
            coloured += hasColour;
            changed += hasColour && std::min(std::abs(a.hue() - b.hue()), 360 - std::abs(a.hue() - b.hue())) > 12;
        }
    EXPECT_GT(coloured, 5000);
    EXPECT_LT(changed, coloured / 40);
    const std::uint64_t sent = viewport_->uploadedBytes();
    (void)grab(slid, colours);
    EXPECT_EQ(viewport_->uploadedBytes(), sent);
    (void)grab(slid, pieces(true, 100.0));
    EXPECT_GT(viewport_->uploadedBytes(), sent) << "all are hidden now";
}

} // namespace
} // namespace isoslider::test
