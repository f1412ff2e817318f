#include "core/extract/live/vertex_kernels.h"

#include <algorithm>

#include "core/extract/edge_interpolation.h"

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/extract/live/vertex_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef ISO_VERTEX_COLUMNS
#define ISO_VERTEX_COLUMNS
namespace isoslider::extract {

/// Records taken apart: a group of edges, a column per field.
struct VertexColumns {
    static constexpr std::size_t kMost = 16;
    alignas(64) float x[kMost], y[kMost], z[kMost]; ///< of the edges' lower grid points
    alignas(64) float t[kMost];
    alignas(64) std::int32_t axis[kMost], u1[kMost], v1[kMost], u2[kMost], v2[kMost], rises[kMost];
};

template <class Live>
inline __attribute__((always_inline)) void takeApart(const EdgeRecord<Live>* records, std::uint32_t count, std::size_t lanes,
                                                     const glm::vec3& first, Live isovalue, VertexColumns& out) {
    for (std::size_t k = 0; k < lanes; ++k) {
        const EdgeRecord<Live>& record = records[std::min<std::size_t>(k, count - 1)];
        const auto place = coordsOf(record.edge & kEdgePointMask);
        out.axis[k] = record.edge >> kEdgeAxisShift;
        out.x[k] = first.x + static_cast<float>(place[0]);
        out.y[k] = first.y + static_cast<float>(place[1]);
        out.z[k] = first.z + static_cast<float>(place[2]);
        out.t[k] = static_cast<float>(edgeFraction<Live>(record.scalar1, record.scalar2, isovalue));
        out.rises[k] = record.scalar1 < record.scalar2 ? -1 : 0;
        out.u1[k] = static_cast<std::int8_t>(record.normal1 & 0xff);
        out.v1[k] = static_cast<std::int8_t>(record.normal1 >> 8);
        out.u2[k] = static_cast<std::int8_t>(record.normal2 & 0xff);
        out.v2[k] = static_cast<std::int8_t>(record.normal2 >> 8);
    }
}

} // namespace isoslider::extract
#endif

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// decodeDirection() of normal_codec.h, lane by lane.
template <class D, class I, class V>
HWY_INLINE void decode(D d, I bytesU, I bytesV, V& x, V& y, V& z) {
    const hn::RebindToSigned<D> ints;
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f), step = hn::Set(d, 1.0f / 127.0f);
    const auto u = hn::Mul(hn::ConvertTo(d, bytesU), step), v = hn::Mul(hn::ConvertTo(d, bytesV), step);
    z = hn::Sub(hn::Sub(one, hn::Abs(u)), hn::Abs(v));
    const auto fold = hn::Max(hn::Neg(z), zero);
    x = hn::Add(u, hn::IfThenElse(hn::Ge(u, zero), hn::Neg(fold), fold));
    y = hn::Add(v, hn::IfThenElse(hn::Ge(v, zero), hn::Neg(fold), fold));
    const auto isNone = hn::RebindMask(d, hn::And(hn::Eq(bytesU, hn::Set(ints, -128)), hn::Eq(bytesV, hn::Set(ints, -128))));
    x = hn::IfThenZeroElse(isNone, x);
    y = hn::IfThenZeroElse(isNone, y);
    z = hn::IfThenZeroElse(isNone, z);
}

template <class Live>
void interpolate(const EdgeRecord<Live>* HWY_RESTRICT records, std::uint32_t count, const std::array<std::int32_t, 3>& origin,
                 Live isovalue, glm::vec3* HWY_RESTRICT positions, glm::vec3* HWY_RESTRICT normals) {
    const hn::CappedTag<float, VertexColumns::kMost> d;
    const hn::RebindToSigned<decltype(d)> ints;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
    const glm::vec3 first(static_cast<float>(origin[0]), static_cast<float>(origin[1]), static_cast<float>(origin[2]));
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    VertexColumns columns;
    alignas(64) float group[3 * VertexColumns::kMost];
    for (std::uint32_t at = 0; at < count; at += lanes) {
        const std::uint32_t here = std::min(lanes, count - at);
        takeApart(records + at, here, lanes, first, isovalue, columns);
        const auto t = hn::Load(d, columns.t);
        const auto axis = hn::Load(ints, columns.axis);
        const auto alongX = hn::RebindMask(d, hn::Eq(axis, hn::Zero(ints))), alongY = hn::RebindMask(d, hn::Eq(axis, hn::Set(ints, 1))),
                   alongZ = hn::RebindMask(d, hn::Eq(axis, hn::Set(ints, 2)));
        const auto store = [&](auto x, auto y, auto z, glm::vec3* out) HWY_ATTR {
            if (here == lanes) {
                hn::StoreInterleaved3(x, y, z, d, &out[at].x);
                return;
            }
            hn::StoreInterleaved3(x, y, z, d, group);
            std::copy_n(group, 3 * here, &out[at].x);
        };
        store(hn::Add(hn::Load(d, columns.x), hn::IfThenElseZero(alongX, t)), hn::Add(hn::Load(d, columns.y), hn::IfThenElseZero(alongY, t)),
              hn::Add(hn::Load(d, columns.z), hn::IfThenElseZero(alongZ, t)), positions);

        auto x1 = zero, y1 = zero, z1 = zero, x2 = zero, y2 = zero, z2 = zero;
        decode(d, hn::Load(ints, columns.u1), hn::Load(ints, columns.v1), x1, y1, z1);
        decode(d, hn::Load(ints, columns.u2), hn::Load(ints, columns.v2), x2, y2, z2);
        // edgeNormal() of edge_interpolation.h, lane by lane.
        const auto x = hn::Add(x1, hn::Mul(t, hn::Sub(x2, x1)));
        const auto y = hn::Add(y1, hn::Mul(t, hn::Sub(y2, y1)));
        const auto z = hn::Add(z1, hn::Mul(t, hn::Sub(z2, z1)));
        const auto square = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
        const auto isFlat = hn::Lt(square, hn::Set(d, kLeastNormalSquare));
        const auto scale = hn::Div(one, hn::Sqrt(hn::IfThenElse(isFlat, one, square)));
        const auto rises = hn::RebindMask(d, hn::Ne(hn::Load(ints, columns.rises), hn::Zero(ints)));
        const auto down = hn::IfThenElse(rises, hn::Neg(one), one);
        store(hn::IfThenElse(isFlat, hn::IfThenElseZero(alongX, down), hn::Mul(x, scale)),
              hn::IfThenElse(isFlat, hn::IfThenElseZero(alongY, down), hn::Mul(y, scale)),
              hn::IfThenElse(isFlat, hn::IfThenElseZero(alongZ, down), hn::Mul(z, scale)), normals);
    }
}

void interpolateF32(const EdgeRecord<float>* r, std::uint32_t n, const std::array<std::int32_t, 3>& o, float i, glm::vec3* p, glm::vec3* q) {
    interpolate(r, n, o, i, p, q);
}
void interpolateF64(const EdgeRecord<double>* r, std::uint32_t n, const std::array<std::int32_t, 3>& o, double i, glm::vec3* p, glm::vec3* q) {
    interpolate(r, n, o, i, p, q);
}

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::extract {

HWY_EXPORT(interpolateF32);
HWY_EXPORT(interpolateF64);

template <>
void interpolateVertices(const EdgeRecord<float>* records, std::uint32_t count, const std::array<std::int32_t, 3>& origin, float isovalue,
                         glm::vec3* positions, glm::vec3* normals) {
    HWY_DYNAMIC_DISPATCH(interpolateF32)(records, count, origin, isovalue, positions, normals);
}
template <>
void interpolateVertices(const EdgeRecord<double>* records, std::uint32_t count, const std::array<std::int32_t, 3>& origin, double isovalue,
                         glm::vec3* positions, glm::vec3* normals) {
    HWY_DYNAMIC_DISPATCH(interpolateF64)(records, count, origin, isovalue, positions, normals);
}

} // namespace isoslider::extract
#endif
