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

/// Records whose scalars are of double precision taken apart: a group of edges, a column per field.
struct VertexColumns {
    static constexpr std::size_t kMost = 16;
    alignas(64) float x[kMost], y[kMost], z[kMost]; ///< of the edges' lower grid points
    alignas(64) float t[kMost], along[kMost]; ///< fraction of the leaf edge, and the same in cells
    alignas(64) std::int32_t axis[kMost], u1[kMost], v1[kMost], u2[kMost], v2[kMost], rises[kMost];
};

inline __attribute__((always_inline)) void takeApart(const EdgeRecord<double>* records, std::uint32_t count,
                                                     std::size_t lanes, const glm::vec3& first, double isovalue,
                                                     VertexColumns& out) {
    for (std::size_t k = 0; k < lanes; ++k) {
        const EdgeRecord<double>& record = records[std::min<std::size_t>(k, count - 1)];
        const int side = 1 << record.levelOrUpperZ;
        auto place = coordsOf(startOf(record.edge));
        out.axis[k] = axisOf(record.edge);
        place[static_cast<std::size_t>(out.axis[k])] &= ~(side - 1);
        out.x[k] = first.x + static_cast<float>(place[0]);
        out.y[k] = first.y + static_cast<float>(place[1]);
        out.z[k] = first.z + static_cast<float>(place[2]);
        out.t[k] = static_cast<float>(edgeFraction(record.scalar1, record.scalar2, isovalue));
        out.along[k] = out.t[k] * static_cast<float>(side);
        out.rises[k] = record.scalar1 < record.scalar2 ? -1 : 0;
        out.u1[k] = static_cast<std::int8_t>(record.normal1 & 0xff);
        out.v1[k] = static_cast<std::int8_t>(record.normal1 >> 8);
        out.u2[k] = static_cast<std::int8_t>(record.normal2 & 0xff);
        out.v2[k] = static_cast<std::int8_t>(record.normal2 >> 8);
    }
}

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

#if HWY_TARGET <= HWY_AVX2
// Elements narrower than four bytes are gathered with what stands behind them.
template <class D, class Stored>
HWY_INLINE hn::Vec<D> gatherNarrow(D d, const Stored* from, hn::Vec<D> places) {
    const auto* const base = reinterpret_cast<const std::int32_t*>(from);
    const auto offsets = sizeof(Stored) == 1 ? places : hn::ShiftLeft<1>(places);
    return hn::And(hn::GatherOffset(d, base, offsets), hn::Set(d, sizeof(Stored) == 1 ? 0xff : 0xffff));
}
template <class Sample, class D>
HWY_INLINE hn::Vec<D> gatherScalars(D d, const StoredSample<Sample>* samples, hn::Vec<D> places) { // bits of floats
    const hn::RebindToFloat<D> floats;
    if constexpr (std::is_same_v<Sample, float>) {
        return hn::BitCast(d, hn::GatherIndex(floats, samples, places));
    } else {
        const auto key = gatherNarrow(d, samples, places);
        constexpr std::int32_t kZero = std::is_signed_v<Sample> ? 1 << (8 * sizeof(Sample) - 1) : 0; // the key of 0
        return hn::BitCast(d, hn::ConvertTo(floats, hn::Sub(key, hn::Set(d, kZero))));
    }
}
#endif

template <class Sample>
void readRecordsHere(const BrickPoints<Sample>& points, const VertexCode* HWY_RESTRICT codes, std::uint32_t count,
                     EdgeRecord<LiveOf<Sample>>* HWY_RESTRICT records) {
#if HWY_TARGET <= HWY_AVX2
    if constexpr (std::is_same_v<LiveOf<Sample>, float>) {
        const hn::CappedTag<std::int32_t, kCodesTogether> d;
        const hn::Rebind<std::uint16_t, decltype(d)> narrow;
        const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
        const auto one = hn::Set(d, 1), nine = hn::Set(d, kPointStride[1]), eightyOne = hn::Set(d, kPointStride[2]);
        const auto pointMask = hn::Set(d, kEdgePointMask);
        auto levels = hn::Zero(d);
        alignas(64) std::array<EdgeRecord<float>, kCodesTogether> last;
        for (std::uint32_t k = 0; k < count; k += lanes) {
            const auto code = hn::PromoteTo(d, hn::LoadU(narrow, codes + k));
            levels = hn::Or(levels, code);
            const auto axis = hn::And(code, hn::Set(d, 3)), p = hn::And(hn::ShiftRight<2>(code), pointMask);
            const auto stride =
                hn::IfThenElse(hn::Eq(axis, hn::Zero(d)), one, hn::IfThenElse(hn::Eq(axis, one), nine, eightyOne));
            const auto q = hn::Add(p, stride);
            const auto edge = hn::Or(hn::ShiftLeft<kEdgeAxisShift>(axis), p);
            const auto normals =
                hn::Or(gatherNarrow(d, points.normals, p), hn::ShiftLeft<16>(gatherNarrow(d, points.normals, q)));
            const bool isWhole = k + lanes <= count;
            hn::StoreInterleaved4(edge, normals, gatherScalars<Sample>(d, points.samples, p),
                                  gatherScalars<Sample>(d, points.samples, q), d,
                                  reinterpret_cast<std::int32_t*>(isWhole ? records + k : last.data()));
            if (!isWhole)
                std::copy_n(last.data(), count - k, records + k);
        }
        if (!hn::AllTrue(d, hn::Eq(hn::ShiftRight<kCodeLevelShift>(levels), hn::Zero(d))))
            for (std::uint32_t k = 0; k < count; ++k)
                if (levelOf(codes[k]) > 0)
                    records[k] = recordOf(points, codes[k]);
        return;
    }
#endif
    for (std::uint32_t k = 0; k < count; ++k)
        records[k] = recordOf(points, codes[k]);
}

#define ISO_READ(Sample, Name) \
    void readRecords##Name(const BrickPoints<Sample>& p, const VertexCode* c, std::uint32_t n, \
                           EdgeRecord<LiveOf<Sample>>* r) { \
        readRecordsHere<Sample>(p, c, n, r); \
    }
ISO_FOR_EACH_SAMPLE_TYPE(ISO_READ)
#undef ISO_READ

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
    const auto isNone =
        hn::RebindMask(d, hn::And(hn::Eq(bytesU, hn::Set(ints, -128)), hn::Eq(bytesV, hn::Set(ints, -128))));
    x = hn::IfThenZeroElse(isNone, x);
    y = hn::IfThenZeroElse(isNone, y);
    z = hn::IfThenZeroElse(isNone, z);
}

// Places of the points p of a brick, as coordsOf(): quotients by 9 and 81 as products.
static_assert([] {
    for (int p = 0; p <= kEdgePointMask; ++p)
        if (p < kClosedPoints && (p * 7282 >> 16 != p / 9 || p * 810 >> 16 != p / 81))
            return false;
    return true;
}());

using VertexLanes = hn::CappedTag<float, VertexColumns::kMost>;

// Vertices that are placed together, and where they go.
template <class D>
class Placing {
public:
    using V = hn::Vec<D>;
    using I = hn::Vec<hn::RebindToSigned<D>>;
    using M = hn::Mask<D>;

    HWY_INLINE Placing(const std::array<std::int32_t, 3>& origin, glm::vec3* HWY_RESTRICT positions,
                       glm::vec3* HWY_RESTRICT normals)
        : first_{hn::Set(d_, static_cast<float>(origin[0])), hn::Set(d_, static_cast<float>(origin[1])),
                 hn::Set(d_, static_cast<float>(origin[2]))},
          positions_(positions),
          normals_(normals) {}

    // edgeFraction() of edge_interpolation.h, lane by lane.
    HWY_INLINE V fraction(V s1, V s2, float isovalue) const {
        const auto half = hn::Set(d_, 0.5f), one = hn::Set(d_, 1.0f);
        const auto halfS1 = hn::Mul(s1, half);
        const auto t =
            hn::Div(hn::Sub(hn::Mul(hn::Set(d_, isovalue), half), halfS1), hn::Sub(hn::Mul(s2, half), halfS1));
        const auto above = hn::IfThenElseZero(hn::Gt(t, hn::Zero(d_)), t);
        return hn::IfThenElse(hn::Lt(above, one), above, one);
    }

    // Of edges, or leaf edges, of `side` cells along `axis` from the brick's points p on; normals as codes side by
    // side.
    HWY_INLINE void place(std::uint32_t at, std::uint32_t count, I p, I axis, I side, V t, M rises, I codes) const {
        const auto ninth = hn::ShiftRight<16>(hn::Mul(p, hn::Set(ints_, 7282))),
                   z = hn::ShiftRight<16>(hn::Mul(p, hn::Set(ints_, 810)));
        const auto y = hn::Sub(ninth, hn::Mul(z, hn::Set(ints_, 9))), x = hn::Sub(p, hn::Mul(ninth, hn::Set(ints_, 9)));
        const auto inside = hn::Sub(side, hn::Set(ints_, 1));
        const auto lower = [&](I local, int a) HWY_ATTR { // of the leaf edge
            return hn::ConvertTo(d_, hn::IfThenElse(hn::Eq(axis, hn::Set(ints_, a)), hn::AndNot(inside, local), local));
        };
        place(at, count, hn::Add(first_[0], lower(x, 0)), hn::Add(first_[1], lower(y, 1)),
              hn::Add(first_[2], lower(z, 2)), t, hn::Mul(t, hn::ConvertTo(d_, side)), axis, rises,
              hn::ShiftRight<24>(hn::ShiftLeft<24>(codes)), hn::ShiftRight<24>(hn::ShiftLeft<16>(codes)),
              hn::ShiftRight<24>(hn::ShiftLeft<8>(codes)), hn::ShiftRight<24>(codes));
    }

    HWY_INLINE void place(std::uint32_t at, std::uint32_t count, V x, V y, V z, V t, V along, I axis, M rises, I u1,
                          I v1, I u2, I v2) const {
        const auto zero = hn::Zero(d_), one = hn::Set(d_, 1.0f);
        const auto alongX = hn::RebindMask(d_, hn::Eq(axis, hn::Zero(ints_))),
                   alongY = hn::RebindMask(d_, hn::Eq(axis, hn::Set(ints_, 1))),
                   alongZ = hn::RebindMask(d_, hn::Eq(axis, hn::Set(ints_, 2)));
        store(hn::Add(x, hn::IfThenElseZero(alongX, along)), hn::Add(y, hn::IfThenElseZero(alongY, along)),
              hn::Add(z, hn::IfThenElseZero(alongZ, along)), count, positions_ + at);
        auto x1 = zero, y1 = zero, z1 = zero, x2 = zero, y2 = zero, z2 = zero;
        decode(d_, u1, v1, x1, y1, z1);
        decode(d_, u2, v2, x2, y2, z2);
        // edgeNormal() of edge_interpolation.h, lane by lane.
        const auto nx = hn::Add(x1, hn::Mul(t, hn::Sub(x2, x1)));
        const auto ny = hn::Add(y1, hn::Mul(t, hn::Sub(y2, y1)));
        const auto nz = hn::Add(z1, hn::Mul(t, hn::Sub(z2, z1)));
        const auto square = hn::Add(hn::Add(hn::Mul(nx, nx), hn::Mul(ny, ny)), hn::Mul(nz, nz));
        const auto isFlat = hn::Lt(square, hn::Set(d_, kLeastNormalSquare));
        const auto scale = hn::Div(one, hn::Sqrt(hn::IfThenElse(isFlat, one, square)));
        const auto down = hn::IfThenElse(rises, hn::Neg(one), one);
        store(hn::IfThenElse(isFlat, hn::IfThenElseZero(alongX, down), hn::Mul(nx, scale)),
              hn::IfThenElse(isFlat, hn::IfThenElseZero(alongY, down), hn::Mul(ny, scale)),
              hn::IfThenElse(isFlat, hn::IfThenElseZero(alongZ, down), hn::Mul(nz, scale)), count, normals_ + at);
    }

private:
    HWY_INLINE void store(V x, V y, V z, std::uint32_t count, glm::vec3* out) const {
        if (count >= hn::Lanes(d_)) {
            hn::StoreInterleaved3(x, y, z, d_, &out->x);
            return;
        }
        alignas(64) float group[3 * VertexColumns::kMost];
        hn::StoreInterleaved3(x, y, z, d_, group);
        std::copy_n(group, 3 * count, &out->x);
    }

    D d_;
    hn::RebindToSigned<D> ints_;
    V first_[3];
    glm::vec3* positions_;
    glm::vec3* normals_;
};

template <class Live>
void interpolate(const EdgeRecord<Live>* HWY_RESTRICT records, std::uint32_t count,
                 const std::array<std::int32_t, 3>& origin, Live isovalue, glm::vec3* HWY_RESTRICT positions,
                 glm::vec3* HWY_RESTRICT normals) {
    const VertexLanes d;
    const hn::RebindToSigned<decltype(d)> ints;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
    const Placing<VertexLanes> placing(origin, positions, normals);
    for (std::uint32_t at = 0; at < count; at += lanes) {
        const std::uint32_t here = std::min(lanes, count - at);
        if constexpr (std::is_same_v<Live, float>) {
            std::array<EdgeRecord<float>, VertexColumns::kMost> last; // whole vectors are read
            const EdgeRecord<float>* from = records + at;
            if (here < lanes) {
                std::fill(std::copy_n(from, here, last.begin()), last.end(), from[0]);
                from = last.data();
            }
            hn::Vec<decltype(ints)> places, codes, bits1, bits2;
            hn::LoadInterleaved4(ints, reinterpret_cast<const std::int32_t*>(from), places, codes, bits1, bits2);
            const auto level = hn::ShiftRight<16>(places),
                       axis = hn::ShiftRight<kEdgeAxisShift>(hn::And(places, hn::Set(ints, 0xffff))),
                       p = hn::And(places, hn::Set(ints, kEdgePointMask));
            const auto s1 = hn::BitCast(d, bits1), s2 = hn::BitCast(d, bits2);
            placing.place(at, here, p, axis, hn::Shl(hn::Set(ints, 1), level), placing.fraction(s1, s2, isovalue),
                          hn::Lt(s1, s2), codes);
        } else {
            const glm::vec3 first(static_cast<float>(origin[0]), static_cast<float>(origin[1]),
                                  static_cast<float>(origin[2]));
            VertexColumns columns;
            takeApart(records + at, here, lanes, first, isovalue, columns);
            const auto rises = hn::RebindMask(d, hn::Ne(hn::Load(ints, columns.rises), hn::Zero(ints)));
            placing.place(at, here, hn::Load(d, columns.x), hn::Load(d, columns.y), hn::Load(d, columns.z),
                          hn::Load(d, columns.t), hn::Load(d, columns.along), hn::Load(ints, columns.axis), rises,
                          hn::Load(ints, columns.u1), hn::Load(ints, columns.v1), hn::Load(ints, columns.u2),
                          hn::Load(ints, columns.v2));
        }
    }
}

// The same without records between: ends are taken one by one, for a gather takes longer, and placed together.
template <class Sample>
bool placePlainHere(const BrickPoints<Sample>& points, const VertexCode* HWY_RESTRICT codes, std::uint32_t count,
                    const std::array<std::int32_t, 3>& origin, float isovalue, glm::vec3* HWY_RESTRICT positions,
                    glm::vec3* HWY_RESTRICT normals) {
    const VertexLanes d;
    const hn::RebindToSigned<decltype(d)> ints;
    const hn::Rebind<std::uint16_t, decltype(d)> halves;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
    const Placing<VertexLanes> placing(origin, positions, normals);
    constexpr std::array<std::uint16_t, 4> kStrides{kPointStride[0], kPointStride[1], kPointStride[2], 0};
    alignas(64) std::array<float, kNearVertices> lower, upper;
    alignas(64) std::array<std::uint32_t, kNearVertices> itsNormals;
    for (std::uint32_t begin = 0; begin < count; begin += kNearVertices) {
        const std::uint32_t together = std::min(kNearVertices, count - begin);
        const std::uint32_t whole = (together + kCodesTogether - 1) / kCodesTogether * kCodesTogether;
        unsigned levels = 0;
        for (std::uint32_t k = 0; k < whole; ++k) {
            const unsigned code = codes[begin + k], p = (code & kCodePlaceMask) >> 2, q = p + kStrides[code & 3u];
            levels |= code;
            lower[k] = static_cast<float>(sampleOf<Sample>(points.samples[p]));
            upper[k] = static_cast<float>(sampleOf<Sample>(points.samples[q]));
            itsNormals[k] = points.normals[p] | static_cast<std::uint32_t>(points.normals[q]) << 16;
        }
        if (levels >> kCodeLevelShift != 0)
            return false;
        for (std::uint32_t k = 0; k < together; k += lanes) {
            const auto code = hn::BitCast(
                ints, hn::PromoteTo(hn::RebindToUnsigned<decltype(ints)>(), hn::LoadU(halves, codes + begin + k)));
            const auto s1 = hn::Load(d, lower.data() + k), s2 = hn::Load(d, upper.data() + k);
            placing.place(begin + k, together - k, hn::ShiftRight<2>(code), hn::And(code, hn::Set(ints, 3)),
                          hn::Set(ints, 1), placing.fraction(s1, s2, isovalue), hn::Lt(s1, s2),
                          hn::BitCast(ints, hn::Load(hn::RebindToUnsigned<decltype(ints)>(), itsNormals.data() + k)));
        }
    }
    return true;
}

#define ISO_PLACE(Sample, Name) \
    bool placePlain##Name(const BrickPoints<Sample>& p, const VertexCode* c, std::uint32_t n, \
                          const std::array<std::int32_t, 3>& o, float i, glm::vec3* q, glm::vec3* r) { \
        if constexpr (std::is_same_v<LiveOf<Sample>, float>) \
            return placePlainHere<Sample>(p, c, n, o, i, q, r); \
        return false; \
    }
ISO_FOR_EACH_SAMPLE_TYPE(ISO_PLACE)
#undef ISO_PLACE

void interpolateF32(const EdgeRecord<float>* r, std::uint32_t n, const std::array<std::int32_t, 3>& o, float i,
                    glm::vec3* p, glm::vec3* q) {
    interpolate(r, n, o, i, p, q);
}
void interpolateF64(const EdgeRecord<double>* r, std::uint32_t n, const std::array<std::int32_t, 3>& o, double i,
                    glm::vec3* p, glm::vec3* q) {
    interpolate(r, n, o, i, p, q);
}

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::extract {

HWY_EXPORT(interpolateF32);
HWY_EXPORT(interpolateF64);
#define ISO_EXPORT(Sample, Name) \
    HWY_EXPORT(readRecords##Name); \
    HWY_EXPORT(placePlain##Name);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_EXPORT)
#undef ISO_EXPORT

template <class Live>
void readRecords(ScalarType type, const PointLine* points, const VertexCode* codes, std::uint32_t count,
                 EdgeRecord<Live>* records) {
    switch (type) {
#define ISO_CASE(Sample, Name) \
    case ScalarType::Name: \
        if constexpr (std::is_same_v<LiveOf<Sample>, Live>) \
            return HWY_DYNAMIC_DISPATCH(readRecords##Name)(pointsIn<Sample>(points), codes, count, records); \
        break;
        ISO_FOR_EACH_SAMPLE_TYPE(ISO_CASE)
#undef ISO_CASE
    }
    checkFailed("samples that live as the records do", __FILE__, __LINE__);
}
template void readRecords(ScalarType, const PointLine*, const VertexCode*, std::uint32_t, EdgeRecord<float>*);
template void readRecords(ScalarType, const PointLine*, const VertexCode*, std::uint32_t, EdgeRecord<double>*);

template <class Live>
EdgeRecord<Live> readRecord(ScalarType type, const PointLine* points, VertexCode code) {
    return visitScalarType(type, [&](auto sample) -> EdgeRecord<Live> {
        using Sample = decltype(sample);
        if constexpr (std::is_same_v<LiveOf<Sample>, Live>)
            return recordOf(pointsIn<Sample>(points), code);
        checkFailed("samples that live as the records do", __FILE__, __LINE__);
    });
}
template EdgeRecord<float> readRecord(ScalarType, const PointLine*, VertexCode);
template EdgeRecord<double> readRecord(ScalarType, const PointLine*, VertexCode);

template <>
void interpolateVertices(const EdgeRecord<float>* records, std::uint32_t count,
                         const std::array<std::int32_t, 3>& origin, float isovalue, glm::vec3* positions,
                         glm::vec3* normals) {
    HWY_DYNAMIC_DISPATCH(interpolateF32)(records, count, origin, isovalue, positions, normals);
}
template <>
void interpolateVertices(const EdgeRecord<double>* records, std::uint32_t count,
                         const std::array<std::int32_t, 3>& origin, double isovalue, glm::vec3* positions,
                         glm::vec3* normals) {
    HWY_DYNAMIC_DISPATCH(interpolateF64)(records, count, origin, isovalue, positions, normals);
}

template <class Live>
void placeVertices(ScalarType type, const PointLine* points, const VertexCode* codes, std::uint32_t count,
                   const std::array<std::int32_t, 3>& origin, Live isovalue, glm::vec3* positions, glm::vec3* normals) {
    if constexpr (std::is_same_v<Live, float>)
        switch (type) {
#define ISO_CASE(Sample, Name) \
    case ScalarType::Name: \
        if (HWY_DYNAMIC_DISPATCH(placePlain##Name)(pointsIn<Sample>(points), codes, count, origin, isovalue, \
                                                   positions, normals)) \
            return; \
        break;
            ISO_FOR_EACH_SAMPLE_TYPE(ISO_CASE)
#undef ISO_CASE
        }
    std::array<EdgeRecord<Live>, kNearVertices> records;
    for (std::uint32_t k = 0; k < count; k += kNearVertices) {
        const std::uint32_t here = std::min(kNearVertices, count - k);
        readRecords(type, points, codes + k, here, records.data());
        interpolateVertices(records.data(), here, origin, isovalue, positions + k, normals + k);
    }
}
template void placeVertices(ScalarType, const PointLine*, const VertexCode*, std::uint32_t,
                            const std::array<std::int32_t, 3>&, float, glm::vec3*, glm::vec3*);
template void placeVertices(ScalarType, const PointLine*, const VertexCode*, std::uint32_t,
                            const std::array<std::int32_t, 3>&, double, glm::vec3*, glm::vec3*);

} // namespace isoslider::extract
#endif
