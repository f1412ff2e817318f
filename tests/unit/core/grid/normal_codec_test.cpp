#include "core/grid/normal_codec.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace isoslider {
namespace {

double angleDegrees(const glm::vec3& a, const glm::vec3& b) {
    const glm::dvec3 u(a), v(b);
    return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)) * 180.0 / 3.14159265358979;
}

TEST(NormalCodec, KeepsEveryDirectionWithinItsBound) {
    std::mt19937 random(5);
    std::normal_distribution<float> gauss;
    double worst = 0.0;
    for (int i = 0; i < 50000; ++i) {
        glm::vec3 n(gauss(random), gauss(random), gauss(random));
        n = glm::normalize(n);
        const NormalCode code = encodeNormal(n);
        ASSERT_NE(code, kNoNormal);
        const glm::vec3 back = decodeNormal(code);
        ASSERT_NEAR(glm::length(back), 1.0f, 1e-5f);
        worst = std::max(worst, angleDegrees(n, back));
    }
    EXPECT_LT(worst, 0.95);
    EXPECT_GT(worst, 0.3) << "too good to be 16 bits";
}

TEST(NormalCodec, KeepsAxesExactly) {
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.0f, 1.0f}) {
            glm::vec3 n(0.0f);
            n[axis] = sign;
            EXPECT_EQ(decodeNormal(encodeNormal(n)), n);
        }
}

// On the upper half the bytes are the first two coordinates, where their sum is one.
TEST(NormalCodec, RoundsHalvesAwayFromZero) {
    int halves = 0;
    for (int k = -254; k <= 254; ++k) {
        const float half = static_cast<float>(k) / 254.0f;
        for (const float c : {std::nextafter(half, -1.0f), half, std::nextafter(half, 1.0f)}) {
            const glm::vec3 n(c, 0.0f, 1.0f - std::abs(c));
            const float scaled = n.x / (std::abs(n.x) + std::abs(n.z)) * 127.0f;
            halves += std::abs(scaled - std::trunc(scaled)) == 0.5f ? 1 : 0;
            EXPECT_EQ(static_cast<std::int8_t>(encodeNormal(n) & 0xff), std::lround(scaled)) << scaled;
        }
    }
    EXPECT_GT(halves, 100) << "no ties were tried";
}

TEST(NormalCodec, HasACodeForNoNormal) {
    EXPECT_EQ(encodeNormal(glm::vec3(0.0f)), kNoNormal);
    EXPECT_EQ(decodeDirection(kNoNormal), glm::vec3(0.0f));
    EXPECT_EQ(decodeNormal(kNoNormal), glm::vec3(0.0f));
}

TEST(NormalCodec, DirectionsHaveTheLengthThatInterpolationCountsOn) {
    for (int u = -127; u <= 127; ++u)
        for (int v = -127; v <= 127; ++v) {
            const auto code = static_cast<NormalCode>((u & 255) | (v & 255) << 8);
            const float length = glm::length(decodeDirection(code));
            ASSERT_GE(length, 0.5773f);
            ASSERT_LE(length, 1.0f + 1e-6f);
        }
}

} // namespace
} // namespace isoslider
