#include "core/extract/vertex_interpolation.h"

#include <cmath>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#define ISO_TARGET_AVX2 __attribute__((target("arch=x86-64-v3")))
#endif

#include "core/extract/edge_interpolation.h"

// Written in vectors of 8 (GCC and Clang vector extensions): left to itself the compiler cuts these
// loops into pieces of four. Compiled twice, for AVX2 and for any machine; chosen at run time.
// (Vectors of 16 were tried: GCC 12 takes them apart for AVX2 and fails on AVX-512.)
#define ISO_INLINE inline __attribute__((always_inline))

namespace isoslider::extract {
namespace {

constexpr int kLanes = 8;
typedef float Floats __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * kLanes)));
typedef std::uint16_t Shorts __attribute__((vector_size(2 * kLanes)));
static_assert(kInterpolationGroup % kLanes == 0);

template <class Vector>
ISO_INLINE void load(Vector& vector, const void* from) {
    std::memcpy(&vector, from, sizeof vector);
}

ISO_INLINE void fractions(const float* scalars1, const float* scalars2, float isovalue, Floats& t) {
    Floats s1, s2;
    load(s1, scalars1);
    load(s2, scalars2);
    t = (isovalue * 0.5f - s1 * 0.5f) / (s2 * 0.5f - s1 * 0.5f); // edgeFraction(), lane by lane
    t = t > 0.0f ? t : Floats{};
    t = t < 1.0f ? t : Floats{} + 1.0f;
}

ISO_INLINE void fractions(const double* scalars1, const double* scalars2, double isovalue, Floats& t) {
    for (int i = 0; i < kLanes; ++i)
        t[i] = static_cast<float>(edgeFraction<double>(scalars1[i], scalars2[i], isovalue));
}

ISO_INLINE void rising(const float* scalars1, const float* scalars2, Ints& mask) {
    Floats s1, s2;
    load(s1, scalars1);
    load(s2, scalars2);
    mask = s1 < s2;
}

ISO_INLINE void rising(const double* scalars1, const double* scalars2, Ints& mask) {
    for (int i = 0; i < kLanes; ++i)
        mask[i] = scalars1[i] < scalars2[i] ? -1 : 0;
}

// decodeDirection() of normal_codec.h for byte pairs that are already sign-extended.
ISO_INLINE void decode(const Ints& byteU, const Ints& byteV, Floats& x, Floats& y, Floats& z) {
    const Floats u = __builtin_convertvector(byteU, Floats) * (1.0f / 127.0f);
    const Floats v = __builtin_convertvector(byteV, Floats) * (1.0f / 127.0f);
    const Floats absU = u < 0.0f ? -u : u;
    const Floats absV = v < 0.0f ? -v : v;
    z = 1.0f - absU - absV;
    const Floats fold = z < 0.0f ? -z : Floats{};
    x = u + (u >= 0.0f ? -fold : fold);
    y = v + (v >= 0.0f ? -fold : fold);
    const Ints exists = byteU != -128; // kNoNormal alone has this byte
    x = exists ? x : Floats{};
    y = exists ? y : Floats{};
    z = exists ? z : Floats{};
}

// 1 / sqrt(x) for normal x: the exponent halved as an integer, then three steps of Newton, relative
// error below 2e-7.
ISO_INLINE void inverseSquareRoot(const Floats& x, Floats& out) {
    Ints bits;
    std::memcpy(&bits, &x, sizeof bits);
    bits = 0x5f3759df - (bits >> 1);
    Floats y;
    std::memcpy(&y, &bits, sizeof y);
    for (int step = 0; step < 3; ++step)
        y = y * (1.5f - 0.5f * x * y * y);
    out = y;
}

// x0 y0 z0 x1 y1 z1 … for 8 vectors.
template <class Store>
ISO_INLINE void storeInterleaved(const Floats& x, const Floats& y, const Floats& z, float* out, const Store& store) {
    const Floats a = __builtin_shufflevector(x, y, 0, 8, 0, 1, 9, 0, 2, 10);
    const Floats b = __builtin_shufflevector(x, y, 0, 3, 11, 0, 4, 12, 0, 5);
    const Floats c = __builtin_shufflevector(x, y, 13, 0, 6, 14, 0, 7, 15, 0);
    const Floats first = __builtin_shufflevector(a, z, 0, 1, 8, 3, 4, 9, 6, 7);
    const Floats second = __builtin_shufflevector(b, z, 10, 1, 2, 11, 4, 5, 12, 7);
    const Floats third = __builtin_shufflevector(c, z, 0, 13, 2, 3, 14, 5, 6, 15);
    store(out, first);
    store(out + kLanes, second);
    store(out + 2 * kLanes, third);
}

template <class Live, class Store>
ISO_INLINE void interpolateGroup(const EdgeColumns<Live>& e, std::size_t at, const std::array<std::int32_t, 3>& origin, Live isovalue,
                                 float* positions, float* normals, const Store& store) {
    Floats t;
    fractions(e.scalars1 + at, e.scalars2 + at, isovalue, t);

    Shorts shorts;
    load(shorts, e.edges + at);
    const Ints edges = __builtin_convertvector(shorts, Ints);
    const Ints axis = edges >> 9;
    const Ints alongX = axis == 0, alongY = axis == 1, alongZ = axis == 2;
    const Floats x = __builtin_convertvector((edges & 7) + origin[0], Floats) + (alongX ? t : Floats{});
    const Floats y = __builtin_convertvector((edges >> 3 & 7) + origin[1], Floats) + (alongY ? t : Floats{});
    const Floats z = __builtin_convertvector((edges >> 6 & 7) + origin[2], Floats) + (alongZ ? t : Floats{});
    storeInterleaved(x, y, z, positions, store);

    Ints codes;
    load(codes, e.normals + at);
    Floats x1, y1, z1, x2, y2, z2;
    decode(codes << 24 >> 24, codes << 16 >> 24, x1, y1, z1);
    decode(codes << 8 >> 24, codes >> 24, x2, y2, z2);
    Floats nx = x1 + t * (x2 - x1);
    Floats ny = y1 + t * (y2 - y1);
    Floats nz = z1 + t * (z2 - z1);
    const Floats square = nx * nx + ny * ny + nz * nz;
    // Flat at both ends, or opposite normals that cancel: along the edge, towards below.
    const Ints isFlat = square < 1e-12f;
    Ints rises;
    rising(e.scalars1 + at, e.scalars2 + at, rises);
    const Floats down = rises ? Floats{} - 1.0f : Floats{} + 1.0f;
    Floats scale;
    inverseSquareRoot(isFlat ? Floats{} + 1.0f : square, scale);
    nx = isFlat ? (alongX ? down : Floats{}) : nx * scale;
    ny = isFlat ? (alongY ? down : Floats{}) : ny * scale;
    nz = isFlat ? (alongZ ? down : Floats{}) : nz * scale;
    storeInterleaved(nx, ny, nz, normals, store);
}

struct PlainStore {
    ISO_INLINE void operator()(float* out, const Floats& value) const { std::memcpy(out, &value, sizeof value); }
};

template <class Live, class Store>
ISO_INLINE void interpolateAll(const EdgeColumns<Live>& edges, std::size_t count, const std::array<std::int32_t, 3>& origin,
                               Live isovalue, glm::vec3* positions, glm::vec3* normals, const Store& store) {
    for (std::size_t at = 0; at < count; at += kLanes)
        interpolateGroup<Live>(edges, at, origin, isovalue, &positions[at].x, &normals[at].x, store);
}

#if defined(__x86_64__)
// Past the caches: V and N are written whole and read by others much later, so fetching their old
// lines would only add to the traffic that decides the speed here.
struct StreamingStore {
    ISO_TARGET_AVX2 inline void operator()(float* out, const Floats& value) const {
        __m256 bits;
        std::memcpy(&bits, &value, sizeof bits);
        _mm256_stream_ps(out, bits);
    }
};

template <class Live>
ISO_TARGET_AVX2 void interpolateAvx2(const EdgeColumns<Live>& edges, std::size_t count, const std::array<std::int32_t, 3>& origin,
                                     Live isovalue, glm::vec3* positions, glm::vec3* normals) {
    const bool isAligned = ((reinterpret_cast<std::uintptr_t>(positions) | reinterpret_cast<std::uintptr_t>(normals)) & 31) == 0;
    if (isAligned)
        interpolateAll<Live>(edges, count, origin, isovalue, positions, normals, StreamingStore{});
    else
        interpolateAll<Live>(edges, count, origin, isovalue, positions, normals, PlainStore{});
}
#endif

template <class Live>
void interpolate(const EdgeColumns<Live>& edges, std::size_t count, const std::array<std::int32_t, 3>& origin, Live isovalue,
                 glm::vec3* positions, glm::vec3* normals) {
#if defined(__x86_64__)
    static const bool hasAvx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (hasAvx2)
        return interpolateAvx2<Live>(edges, count, origin, isovalue, positions, normals);
#endif
    interpolateAll<Live>(edges, count, origin, isovalue, positions, normals, PlainStore{});
}

} // namespace

void interpolateVertices(const EdgeColumns<float>& edges, std::size_t count, const std::array<std::int32_t, 3>& origin,
                         float isovalue, glm::vec3* positions, glm::vec3* normals) {
    interpolate<float>(edges, count, origin, isovalue, positions, normals);
}

void interpolateVertices(const EdgeColumns<double>& edges, std::size_t count, const std::array<std::int32_t, 3>& origin,
                         double isovalue, glm::vec3* positions, glm::vec3* normals) {
    interpolate<double>(edges, count, origin, isovalue, positions, normals);
}

void orderInterpolatedVertices() {
#if defined(__x86_64__)
    _mm_sfence();
#endif
}

} // namespace isoslider::extract
