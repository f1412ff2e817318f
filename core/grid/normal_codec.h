#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace isoslider {

/// A unit normal in 16 bits (PAPER 2.1): octahedral map, two signed bytes in [-127, 127], low byte
/// first. Worst angular error 0.95 degrees. Source: Meyer et al. 2010, "On Floating-Point
/// Normal Vectors".
using NormalCode = std::uint16_t;

/// A point without gradient has no normal: both bytes -128, outside the code's range.
inline constexpr NormalCode kNoNormal = 0x8080;

/// A coordinate of the octahedral map as a signed byte, halves away from zero.
inline std::uint8_t quantiseNormal(float c) {
    // As std::lround, which is a call: the difference to the whole number is exact.
    const float scaled = std::clamp(c, -1.0f, 1.0f) * 127.0f;
    const int whole = static_cast<int>(scaled);
    const float rest = scaled - static_cast<float>(whole);
    return static_cast<std::uint8_t>(whole + (rest >= 0.5f ? 1 : 0) - (rest <= -0.5f ? 1 : 0));
}

inline NormalCode encodeNormal(const glm::vec3& normal) {
    const float sum = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    if (!(sum > 0.0f))
        return kNoNormal;
    float u = normal.x / sum;
    float v = normal.y / sum;
    if (normal.z < 0.0f) {
        const float folded = (1.0f - std::abs(v)) * (u >= 0.0f ? 1.0f : -1.0f);
        v = (1.0f - std::abs(u)) * (v >= 0.0f ? 1.0f : -1.0f);
        u = folded;
    }
    return static_cast<NormalCode>(quantiseNormal(u) | (quantiseNormal(v) << 8));
}

/// The vector behind a code, NOT of unit length: between 1/sqrt(3) and 1, nearly equal for nearby
/// directions, so that interpolation may work on it and normalise once. Zero for kNoNormal.
inline glm::vec3 decodeDirection(NormalCode code) {
    if (code == kNoNormal)
        return glm::vec3(0.0f);
    float u = static_cast<float>(static_cast<std::int8_t>(code & 0xff)) * (1.0f / 127.0f);
    float v = static_cast<float>(static_cast<std::int8_t>(code >> 8)) * (1.0f / 127.0f);
    const float z = 1.0f - std::abs(u) - std::abs(v);
    const float fold = std::max(-z, 0.0f);
    u += u >= 0.0f ? -fold : fold;
    v += v >= 0.0f ? -fold : fold;
    return {u, v, z};
}

inline glm::vec3 decodeNormal(NormalCode code) {
    const glm::vec3 direction = decodeDirection(code);
    const float length = std::sqrt(glm::dot(direction, direction));
    return length > 0.0f ? direction / length : direction;
}

} // namespace isoslider
