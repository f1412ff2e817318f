#include "core/extract/vertex_interpolation.h"

#include <algorithm>
#include <cmath>

#include "core/extract/edge_interpolation.h"

// One binary, the widest vectors the machine has. Sanitizers run before the resolver can, so they
// get the plain version.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define ISO_VECTOR_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define ISO_VECTOR_CLONES
#endif

namespace isoslider::extract {
namespace {

constexpr std::size_t kBlock = kInterpolationGroup; // a constant count leaves the compiler no remainder loops

struct Block {
    float t[kBlock];
    float x[kBlock], y[kBlock], z[kBlock];
    float nx[kBlock], ny[kBlock], nz[kBlock];
};

// The decoded direction of one byte pair: decodeDirection() of normal_codec.h without branches.
struct Direction {
    float x, y, z;
};

inline __attribute__((always_inline)) Direction decode(std::uint32_t code) {
    float u = static_cast<float>(static_cast<std::int8_t>(code & 0xff)) * (1.0f / 127.0f);
    float v = static_cast<float>(static_cast<std::int8_t>(code >> 8 & 0xff)) * (1.0f / 127.0f);
    const float z = 1.0f - std::abs(u) - std::abs(v);
    const float fold = z < 0.0f ? -z : 0.0f;
    u += u >= 0.0f ? -fold : fold;
    v += v >= 0.0f ? -fold : fold;
    const float exists = (code & 0xffff) == kNoNormal ? 0.0f : 1.0f;
    return {u * exists, v * exists, z * exists};
}

template <class Live>
inline __attribute__((always_inline)) void interpolateBlock(const EdgeColumns<Live>& e, std::size_t first,
                                                            const std::array<std::int32_t, 3>& origin, Live isovalue,
                                                            Block& b) {
    for (std::size_t i = 0; i < kBlock; ++i)
        b.t[i] = static_cast<float>(edgeFraction<Live>(e.scalars1[first + i], e.scalars2[first + i], isovalue));
    for (std::size_t i = 0; i < kBlock; ++i) {
        const std::uint32_t edge = e.edges[first + i];
        const std::uint32_t axis = edge >> 9;
        b.x[i] = static_cast<float>(origin[0] + static_cast<std::int32_t>(edge & 7)) + (axis == 0 ? b.t[i] : 0.0f);
        b.y[i] = static_cast<float>(origin[1] + static_cast<std::int32_t>(edge >> 3 & 7)) + (axis == 1 ? b.t[i] : 0.0f);
        b.z[i] = static_cast<float>(origin[2] + static_cast<std::int32_t>(edge >> 6 & 7)) + (axis == 2 ? b.t[i] : 0.0f);
    }
    for (std::size_t i = 0; i < kBlock; ++i) {
        const std::uint32_t codes = e.normals[first + i];
        const Direction d1 = decode(codes);
        const Direction d2 = decode(codes >> 16);
        const float t = b.t[i];
        float x = d1.x + t * (d2.x - d1.x);
        float y = d1.y + t * (d2.y - d1.y);
        float z = d1.z + t * (d2.z - d1.z);
        // Flat at both ends, or opposite normals that cancel: along the edge, towards below.
        const std::uint32_t axis = e.edges[first + i] >> 9;
        const float down = e.scalars1[first + i] < e.scalars2[first + i] ? -1.0f : 1.0f;
        const float square = x * x + y * y + z * z;
        const bool isFlat = square < 1e-12f;
        x = isFlat ? (axis == 0 ? down : 0.0f) : x;
        y = isFlat ? (axis == 1 ? down : 0.0f) : y;
        z = isFlat ? (axis == 2 ? down : 0.0f) : z;
        const float scale = 1.0f / std::sqrt(isFlat ? 1.0f : square);
        b.nx[i] = x * scale;
        b.ny[i] = y * scale;
        b.nz[i] = z * scale;
    }
}

inline __attribute__((always_inline)) void interleave(const float* x, const float* y, const float* z, float* out) {
    for (std::size_t i = 0; i < kBlock; ++i) {
        out[3 * i] = x[i];
        out[3 * i + 1] = y[i];
        out[3 * i + 2] = z[i];
    }
}

template <class Live>
inline __attribute__((always_inline)) void interpolateAll(const EdgeColumns<Live>& edges, std::size_t count,
                                                          const std::array<std::int32_t, 3>& origin, Live isovalue,
                                                          glm::vec3* positions, glm::vec3* normals) {
    Block block;
    for (std::size_t first = 0; first < count; first += kBlock) {
        interpolateBlock<Live>(edges, first, origin, isovalue, block);
        interleave(block.x, block.y, block.z, &positions[first].x);
        interleave(block.nx, block.ny, block.nz, &normals[first].x);
    }
}

} // namespace

ISO_VECTOR_CLONES void interpolateVertices(const EdgeColumns<float>& edges, std::size_t count,
                                           const std::array<std::int32_t, 3>& origin, float isovalue,
                                           glm::vec3* positions, glm::vec3* normals) {
    interpolateAll<float>(edges, count, origin, isovalue, positions, normals);
}

ISO_VECTOR_CLONES void interpolateVertices(const EdgeColumns<double>& edges, std::size_t count,
                                           const std::array<std::int32_t, 3>& origin, double isovalue,
                                           glm::vec3* positions, glm::vec3* normals) {
    interpolateAll<double>(edges, count, origin, isovalue, positions, normals);
}

} // namespace isoslider::extract
