#include "core/extract/live/vertex_kernels.h"

#include <algorithm>
#include <array>
#include <type_traits>

#include "core/extract/edge_interpolation.h"

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/extract/live/vertex_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef ISO_VERTEX_COLUMNS
#define ISO_VERTEX_COLUMNS
namespace isoslider::extract {

template <class Sample>
inline EdgeRecord<LiveOf<Sample>> recordOf(const BrickPoints<Sample>& points, VertexCode code) {
    using Live = LiveOf<Sample>;
    const auto [lower, upper] = endsOf(code);
    return {edgeOf(code),
            static_cast<std::uint16_t>(levelOf(code)),
            points.normals[lower],
            points.normals[upper],
            static_cast<Live>(sampleOf<Sample>(points.samples[lower])),
            static_cast<Live>(sampleOf<Sample>(points.samples[upper]))};
}

} // namespace isoslider::extract
#endif

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// decodeDirection() of normal_codec.h, lane by lane, of codes that stand for a direction.
template <class D, class I, class V>
HWY_INLINE void decode(D d, I bytesU, I bytesV, V& x, V& y, V& z) {
    const auto step = hn::Set(d, 1.0f / 127.0f);
    const auto u = hn::Mul(hn::ConvertTo(d, bytesU), step), v = hn::Mul(hn::ConvertTo(d, bytesV), step);
    z = hn::Sub(hn::Sub(hn::Set(d, 1.0f), hn::Abs(u)), hn::Abs(v));
    const auto fold = hn::Max(hn::Neg(z), hn::Zero(d));
    x = hn::Sub(u, hn::CopySignToAbs(fold, u));
    y = hn::Sub(v, hn::CopySignToAbs(fold, v));
}

// Places of the points p of a brick, as coordsOf(): quotients by 9 and 81 as products.
static_assert([] {
    for (int p = 0; p <= kEdgePointMask; ++p)
        if (p < kClosedPoints && (p * 7282 >> 16 != p / 9 || p * 810 >> 16 != p / 81))
            return false;
    return true;
}());

using VertexLanes = hn::CappedTag<float, kGroupSize>;

// Vertices that are placed together, and where they go.
template <class D>
class Placing {
public:
    using V = hn::Vec<D>;
    using I = hn::Vec<hn::RebindToSigned<D>>;
    using M = hn::Mask<D>;

    HWY_INLINE Placing(const std::array<std::int32_t, 3>& origin, const VertexRoom& room)
        : first_{hn::Set(d_, static_cast<float>(origin[0])), hn::Set(d_, static_cast<float>(origin[1])),
                 hn::Set(d_, static_cast<float>(origin[2]))},
          room_(room) {}

    // edgeFraction() of edge_interpolation.h, lane by lane.
    HWY_INLINE V fraction(V s1, V s2, float isovalue) const {
        const auto half = hn::Set(d_, 0.5f), one = hn::Set(d_, 1.0f);
        const auto halfS1 = hn::Mul(s1, half);
        const auto t =
            hn::Div(hn::Sub(hn::Mul(hn::Set(d_, isovalue), half), halfS1), hn::Sub(hn::Mul(s2, half), halfS1));
        const auto above = hn::IfThenElseZero(hn::Gt(t, hn::Zero(d_)), t);
        return hn::IfThenElse(hn::Lt(above, one), above, one);
    }

    // Vertex `at` and those behind it, `count` of them at most, on edges, or leaf edges of 2^level cells, along `axis`
    // from the brick's points p on; normals as codes side by side. What is rare is left out where no lane has it.
    HWY_INLINE void place(std::uint32_t at, std::uint32_t count, I p, I axis, I level, V t, M rises, I codes) const {
        const auto ninth = hn::ShiftRight<16>(hn::Mul(p, hn::Set(ints_, 7282))),
                   z = hn::ShiftRight<16>(hn::Mul(p, hn::Set(ints_, 810)));
        const auto y = hn::Sub(ninth, hn::Mul(z, hn::Set(ints_, 9))), x = hn::Sub(p, hn::Mul(ninth, hn::Set(ints_, 9)));
        const auto alongX = hn::Eq(axis, hn::Zero(ints_)), alongY = hn::Eq(axis, hn::Set(ints_, 1)),
                   alongZ = hn::Eq(axis, hn::Set(ints_, 2));
        const auto position = [&](V first, I lower, auto isAlong, V along) HWY_ATTR {
            return hn::Add(hn::Add(first, hn::ConvertTo(d_, lower)),
                           hn::IfThenElseZero(hn::RebindMask(d_, isAlong), along));
        };
        if (hn::AllTrue(ints_, hn::Eq(level, hn::Zero(ints_)))) {
            store(position(first_[0], x, alongX, t), position(first_[1], y, alongY, t),
                  position(first_[2], z, alongZ, t), at, count, room_.positions);
        } else {
            const auto side = hn::Shl(hn::Set(ints_, 1), level);
            const auto inside = hn::Sub(side, hn::Set(ints_, 1));
            const auto along = hn::Mul(t, hn::ConvertTo(d_, side));
            const auto lower = [&](I local, auto isAlong) HWY_ATTR { // end of the leaf edge
                return hn::IfThenElse(isAlong, hn::AndNot(inside, local), local);
            };
            store(position(first_[0], lower(x, alongX), alongX, along),
                  position(first_[1], lower(y, alongY), alongY, along),
                  position(first_[2], lower(z, alongZ), alongZ, along), at, count, room_.positions);
        }
        const auto zero = hn::Zero(d_), one = hn::Set(d_, 1.0f);
        auto x1 = zero, y1 = zero, z1 = zero, x2 = zero, y2 = zero, z2 = zero;
        decode(d_, hn::ShiftRight<24>(hn::ShiftLeft<24>(codes)), hn::ShiftRight<24>(hn::ShiftLeft<16>(codes)), x1, y1,
               z1);
        decode(d_, hn::ShiftRight<24>(hn::ShiftLeft<8>(codes)), hn::ShiftRight<24>(codes), x2, y2, z2);
        const auto none = hn::Set(ints_, kNoNormal);
        const auto isNone1 = hn::Eq(hn::And(codes, hn::Set(ints_, 0xffff)), none),
                   isNone2 = hn::Eq(hn::And(hn::ShiftRight<16>(codes), hn::Set(ints_, 0xffff)), none);
        if (!hn::AllFalse(ints_, hn::Or(isNone1, isNone2))) {
            for (V* each : {&x1, &y1, &z1})
                *each = hn::IfThenZeroElse(hn::RebindMask(d_, isNone1), *each);
            for (V* each : {&x2, &y2, &z2})
                *each = hn::IfThenZeroElse(hn::RebindMask(d_, isNone2), *each);
        }
        // edgeNormal() of edge_interpolation.h, lane by lane.
        const auto nx = hn::Add(x1, hn::Mul(t, hn::Sub(x2, x1)));
        const auto ny = hn::Add(y1, hn::Mul(t, hn::Sub(y2, y1)));
        const auto nz = hn::Add(z1, hn::Mul(t, hn::Sub(z2, z1)));
        const auto square = hn::Add(hn::Add(hn::Mul(nx, nx), hn::Mul(ny, ny)), hn::Mul(nz, nz));
        const auto isFlat = hn::Lt(square, hn::Set(d_, kLeastNormalSquare));
        if (hn::AllFalse(d_, isFlat)) {
            const auto scale = hn::Div(one, hn::Sqrt(square));
            store(hn::Mul(nx, scale), hn::Mul(ny, scale), hn::Mul(nz, scale), at, count, room_.normals);
            return;
        }
        const auto scale = hn::Div(one, hn::Sqrt(hn::IfThenElse(isFlat, one, square)));
        const auto down = hn::IfThenElse(rises, hn::Neg(one), one);
        const auto unit = [&](V n, auto isAlong) HWY_ATTR {
            return hn::IfThenElse(isFlat, hn::IfThenElseZero(hn::RebindMask(d_, isAlong), down), hn::Mul(n, scale));
        };
        store(unit(nx, alongX), unit(ny, alongY), unit(nz, alongZ), at, count, room_.normals);
    }

private:
    HWY_INLINE void store(V x, V y, V z, std::uint32_t at, std::uint32_t count, glm::vec3* out) const {
        if (at + hn::Lanes(d_) <= room_.count) {
            hn::StoreInterleaved3(x, y, z, d_, &out[at].x);
            return;
        }
        alignas(64) float group[3 * kGroupSize];
        hn::StoreInterleaved3(x, y, z, d_, group);
        std::copy_n(group, 3 * count, &out[at].x);
    }

    D d_;
    hn::RebindToSigned<D> ints_;
    V first_[3];
    VertexRoom room_;
};

template <class Live>
void placeHere(const VertexGroup<Live>* HWY_RESTRICT groups, std::uint32_t count,
               const std::array<std::int32_t, 3>& origin, Live isovalue, const VertexRoom& room) {
    const VertexLanes d;
    const hn::RebindToSigned<decltype(d)> ints;
    const hn::RebindToUnsigned<decltype(d)> words;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
    const Placing<VertexLanes> placing(origin, room);
    for (std::uint32_t at = 0; at < count; at += lanes) {
        const VertexGroup<Live>& group = groups[at / kGroupSize];
        const std::size_t k = at % kGroupSize;
        const auto code = hn::BitCast(ints, hn::Load(words, group.codes + k));
        const auto normals = hn::BitCast(ints, hn::Load(words, group.normals + k));
        const auto axis = hn::And(code, hn::Set(ints, 3)),
                   p = hn::And(hn::ShiftRight<2>(code), hn::Set(ints, kEdgePointMask)),
                   level = hn::ShiftRight<kCodeLevelShift>(code);
        if constexpr (std::is_same_v<Live, float>) {
            const auto s1 = hn::Load(d, group.lower + k), s2 = hn::Load(d, group.upper + k);
            placing.place(at, count - at, p, axis, level, placing.fraction(s1, s2, isovalue), hn::Lt(s1, s2), normals);
        } else {
            alignas(64) float t[kGroupSize], rises[kGroupSize];
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const Live s1 = group.lower[k + lane], s2 = group.upper[k + lane];
                t[lane] = static_cast<float>(edgeFraction(s1, s2, isovalue));
                rises[lane] = s1 < s2 ? 1.0f : 0.0f;
            }
            placing.place(at, count - at, p, axis, level, hn::Load(d, t), hn::Ne(hn::Load(d, rises), hn::Zero(d)),
                          normals);
        }
    }
}

// Ends are taken one by one, for a gather takes longer; keys become scalars together.
template <class Sample>
void gatherHere(const BrickPoints<Sample>& points, const VertexCode* HWY_RESTRICT codes, std::uint32_t count,
                VertexGroup<LiveOf<Sample>>* HWY_RESTRICT groups) {
    using Live = LiveOf<Sample>;
    using Scalar = std::conditional_t<sizeof(Sample) <= 2, std::uint32_t, Live>;
    constexpr std::array<std::uint16_t, 4> kStrides{kPointStride[0], kPointStride[1], kPointStride[2], 0};
    for (std::uint32_t begin = 0; begin < count; begin += kGroupSize, codes += kGroupSize) {
        VertexGroup<Live>& group = groups[begin / kGroupSize];
        auto* const HWY_RESTRICT lower = reinterpret_cast<Scalar*>(group.lower);
        auto* const HWY_RESTRICT upper = reinterpret_cast<Scalar*>(group.upper);
        const auto take = [&](std::uint32_t k, std::size_t p, std::size_t q) {
            lower[k] = static_cast<Scalar>(points.samples[p]);
            upper[k] = static_cast<Scalar>(points.samples[q]);
            group.normals[k] = points.normals[p] | static_cast<std::uint32_t>(points.normals[q]) << 16;
        };
        const std::uint32_t here = std::min(kGroupSize, count - begin);
        unsigned levels = 0;
        for (std::uint32_t k = 0; k < here; ++k) {
            const unsigned code = codes[k], p = (code & kCodePlaceMask) >> 2;
            levels |= code;
            group.codes[k] = code;
            take(k, p, p + kStrides[code & 3u]);
        }
        if (levels >> kCodeLevelShift != 0)
            for (std::uint32_t k = 0; k < here; ++k)
                if (levelOf(codes[k]) > 0) {
                    const auto [p, q] = endsOf(codes[k]);
                    take(k, p, q);
                }
        if constexpr (sizeof(Sample) <= 2) {
            const VertexLanes d;
            const hn::RebindToSigned<decltype(d)> ints;
            constexpr std::int32_t kZero = std::is_signed_v<Sample> ? 1 << (8 * sizeof(Sample) - 1) : 0; // the key of 0
            for (float* column : {group.lower, group.upper})
                for (std::size_t k = 0; k < kGroupSize; k += hn::Lanes(d)) {
                    const auto keys = hn::BitCast(ints, hn::Load(d, column + k));
                    hn::Store(hn::ConvertTo(d, hn::Sub(keys, hn::Set(ints, kZero))), d, column + k);
                }
        }
    }
}

#define ISO_GATHER(Sample, Name) \
    void gather##Name(const BrickPoints<Sample>& p, const VertexCode* c, std::uint32_t n, \
                      VertexGroup<LiveOf<Sample>>* g) { \
        gatherHere<Sample>(p, c, n, g); \
    }
ISO_FOR_EACH_SAMPLE_TYPE(ISO_GATHER)
#undef ISO_GATHER

void placeF32(const VertexGroup<float>* g, std::uint32_t n, const std::array<std::int32_t, 3>& o, float i,
              const VertexRoom& r) {
    placeHere(g, n, o, i, r);
}
void placeF64(const VertexGroup<double>* g, std::uint32_t n, const std::array<std::int32_t, 3>& o, double i,
              const VertexRoom& r) {
    placeHere(g, n, o, i, r);
}

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::extract {

HWY_EXPORT(placeF32);
HWY_EXPORT(placeF64);
#define ISO_EXPORT(Sample, Name) HWY_EXPORT(gather##Name);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_EXPORT)
#undef ISO_EXPORT

namespace {

/// Calls use(points as they are stored) where samples of `type` live as Live.
template <class Live, class Use>
auto withPoints(ScalarType type, const PointLine* points, const Use& use) {
    return visitScalarType(type, [&](auto sample) -> decltype(use(pointsIn<Live>(points))) {
        using Sample = decltype(sample);
        if constexpr (std::is_same_v<LiveOf<Sample>, Live>)
            return use(pointsIn<Sample>(points));
        else
            checkFailed("samples that live as the surface does", __FILE__, __LINE__);
    });
}

} // namespace

template <class Live>
EdgeRecord<Live> readRecord(ScalarType type, const PointLine* points, VertexCode code) {
    return withPoints<Live>(type, points, [&](const auto& its) { return recordOf(its, code); });
}
template EdgeRecord<float> readRecord(ScalarType, const PointLine*, VertexCode);
template EdgeRecord<double> readRecord(ScalarType, const PointLine*, VertexCode);

template <class Live>
void readRecords(ScalarType type, const PointLine* points, const VertexCode* codes, std::uint32_t count,
                 EdgeRecord<Live>* records) {
    withPoints<Live>(type, points, [&](const auto& its) {
        std::transform(codes, codes + count, records, [&](VertexCode code) { return recordOf(its, code); });
    });
}
template void readRecords(ScalarType, const PointLine*, const VertexCode*, std::uint32_t, EdgeRecord<float>*);
template void readRecords(ScalarType, const PointLine*, const VertexCode*, std::uint32_t, EdgeRecord<double>*);

template <class Live>
void gatherVertices(ScalarType type, const PointLine* points, const VertexCode* codes, std::uint32_t count,
                    VertexGroup<Live>* groups) {
    switch (type) {
#define ISO_CASE(Sample, Name) \
    case ScalarType::Name: \
        if constexpr (std::is_same_v<LiveOf<Sample>, Live>) \
            return HWY_DYNAMIC_DISPATCH(gather##Name)(pointsIn<Sample>(points), codes, count, groups); \
        break;
        ISO_FOR_EACH_SAMPLE_TYPE(ISO_CASE)
#undef ISO_CASE
    }
    checkFailed("samples that live as the surface does", __FILE__, __LINE__);
}
template void gatherVertices(ScalarType, const PointLine*, const VertexCode*, std::uint32_t, VertexGroup<float>*);
template void gatherVertices(ScalarType, const PointLine*, const VertexCode*, std::uint32_t, VertexGroup<double>*);

template <>
void placeVertices(const VertexGroup<float>* groups, std::uint32_t count, const std::array<std::int32_t, 3>& origin,
                   float isovalue, const VertexRoom& room) {
    HWY_DYNAMIC_DISPATCH(placeF32)(groups, count, origin, isovalue, room);
}
template <>
void placeVertices(const VertexGroup<double>* groups, std::uint32_t count, const std::array<std::int32_t, 3>& origin,
                   double isovalue, const VertexRoom& room) {
    HWY_DYNAMIC_DISPATCH(placeF64)(groups, count, origin, isovalue, room);
}

template <class Live>
void placeVertices(ScalarType type, const PointLine* points, const VertexCode* codes, std::uint32_t count,
                   const std::array<std::int32_t, 3>& origin, Live isovalue, const VertexRoom& room) {
    constexpr std::uint32_t kNear = 256; // they and what they are made from stay in the nearest cache
    std::array<VertexGroup<Live>, kNear / kGroupSize> groups;
    for (std::uint32_t k = 0; k < count; k += kNear) {
        const std::uint32_t here = std::min(kNear, count - k);
        gatherVertices(type, points, codes + k, here, groups.data());
        placeVertices(groups.data(), here, origin, isovalue, room.from(k));
    }
}
template void placeVertices(ScalarType, const PointLine*, const VertexCode*, std::uint32_t,
                            const std::array<std::int32_t, 3>&, float, const VertexRoom&);
template void placeVertices(ScalarType, const PointLine*, const VertexCode*, std::uint32_t,
                            const std::array<std::int32_t, 3>&, double, const VertexRoom&);

} // namespace isoslider::extract
#endif
