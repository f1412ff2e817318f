#include "core/extract/sources/point_kernels.h"

#include <algorithm>
#include <array>
#include <type_traits>

#include "core/grid/gradient.h"
#include "core/grid/scalar_type.h"

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/extract/sources/point_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef ISO_GRADIENT_SAMPLES
#define ISO_GRADIENT_SAMPLES
namespace isoslider::extract {

/// What differences of samples are taken in, as in derivativeAt().
template <class Sample>
using GradientType =
    std::conditional_t<std::is_same_v<Sample, double> || std::is_same_v<Sample, std::int32_t>, double, float>;

/// The samples that gradients at a brick's points depend on. The points of its last column, x = 8, and those on either
/// side of it stand once more where they can be read as rows.
///
/// Outside the box stand the samples nearest to there: so a one-sided difference is that of a point and its only
/// neighbour, as derivativeAt() takes it, if it is not halved.
template <class Wide>
struct GradientSamples {
    static constexpr int kRow = SampleBlock<Wide>::kRow, kPlane = SampleBlock<Wide>::kPlane;
    static constexpr int kColumnRow = SampleBlock<Wide>::kSide;
    static constexpr int kFirstOfColumn = kColumnRow + 1; ///< y = z = 0
    static constexpr int kColumn = 128; ///< 11 * 11 in whole vectors
    static constexpr int kOverread = 16;

    struct Scales { ///< 0.5, and 1 where there is one neighbour
        alignas(64) std::array<Wide, kRow> x, y, z;
        alignas(64) std::array<Wide, kColumn> columnY, columnZ;
    };
    static const Scales& halves() {
        static const Scales all = [] {
            Scales scales;
            for (auto* some : {&scales.x, &scales.y, &scales.z})
                some->fill(Wide(0.5));
            scales.columnY.fill(Wide(0.5));
            scales.columnZ.fill(Wide(0.5));
            return scales;
        }();
        return all;
    }
    static constexpr int placeInColumn(int y, int z) { return kFirstOfColumn + y + kColumnRow * z; }

    alignas(64) std::array<Wide, static_cast<std::size_t>(kPlane* kColumnRow)> block; ///< as SampleBlock::offset()
    alignas(64) std::array<Wide, kColumn + kOverread> before, last, behind; ///< x = 7, 8 and 9
    const Scales* scales = &halves();
    Scales own; ///< of a brick that reaches out of the box
};

/// Samples of a brick that reaches out of the box.
template <class Sample>
void fillBesideBox(const SampleRows<Sample>& rows, GradientSamples<GradientType<Sample>>& out,
                   StoredSample<Sample>* stored) {
    using Wide = GradientType<Sample>;
    SampleBlock<Sample> block;
    readBlock(rows, block);
    const auto inside = [&](int at, std::size_t axis) {
        return std::clamp(at, block.begin[axis], block.end[axis] - 1);
    };
    for (int z = -1; z <= kPointSide; ++z)
        for (int y = -1; y <= kPointSide; ++y) {
            const Sample* const row = block.samples.data() + block.offset(0, inside(y, 1), inside(z, 2));
            const auto at = [&](int x) { return row[inside(x, 0)]; };
            Wide* const to = out.block.data() + block.offset(0, y, z);
            for (int x = -1; x <= kPointSide; ++x)
                to[x] = static_cast<Wide>(at(x));
            const auto place = static_cast<std::size_t>(out.placeInColumn(y, z));
            out.before[place] = to[kPointSide - 2];
            out.last[place] = to[kPointSide - 1];
            out.behind[place] = to[kPointSide];
            if (std::min(y, z) >= 0 && std::max(y, z) < kPointSide)
                for (int x = 0; x < kPointSide; ++x)
                    stored[closedPoint(x, y, z).index()] = storedOf(at(x));
        }
    const auto scaleAt = [&](int at, std::size_t axis) {
        return at > block.begin[axis] && at + 1 < block.end[axis] ? Wide(0.5) : Wide(1);
    };
    out.own = GradientSamples<Wide>::halves();
    for (int at = 0; at < kPointSide; ++at) {
        const auto i = static_cast<std::size_t>(at);
        out.own.x[i] = scaleAt(at, 0);
        out.own.y[i] = scaleAt(at, 1);
        out.own.z[i] = scaleAt(at, 2);
    }
    for (int z = 0; z < kPointSide; ++z)
        for (int y = 0; y < kPointSide; ++y) {
            const auto place = static_cast<std::size_t>(out.placeInColumn(y, z));
            out.own.columnY[place] = scaleAt(y, 1);
            out.own.columnZ[place] = scaleAt(z, 2);
        }
    out.scales = &out.own;
}

} // namespace isoslider::extract
#endif

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Samples as floats or doubles, which hold them exactly.
template <class D, class Sample>
HWY_INLINE hn::Vec<D> loadWide(D d, const Sample* from) {
    if constexpr (std::is_same_v<Sample, hn::TFromD<D>>) {
        return hn::LoadU(d, from);
    } else if constexpr (std::is_same_v<hn::TFromD<D>, double>) {
        return hn::PromoteTo(d, hn::LoadU(hn::Rebind<Sample, D>(), from));
    } else {
        const hn::Rebind<std::int32_t, D> ints;
        return hn::ConvertTo(d, hn::PromoteTo(ints, hn::LoadU(hn::Rebind<Sample, D>(), from)));
    }
}

// Samples of a brick that lies in the box with all that is beside it. Of the rows beside the brick only what is in line
// with its points: other lines would be waited for in vain.
template <class Sample>
HWY_INLINE void fillInBox(const SampleRows<Sample>& rows, GradientSamples<GradientType<Sample>>& out,
                          StoredSample<Sample>* HWY_RESTRICT stored) {
    using Wide = GradientType<Sample>;
    using Block = SampleBlock<Wide>;
    const hn::CappedTag<Wide, kBrickSide> d;
    for (int z = -1; z <= kPointSide; ++z) {
        const bool isPlane = z >= 0 && z < kPointSide;
        for (int y = isPlane ? -1 : 0; y < (isPlane ? kPointSide + 1 : kPointSide); ++y) {
            const auto row = rows.row(y, z);
            Wide* const to = out.block.data() + Block::offset(0, y, z);
            for (std::size_t x = 0; x < kBrickSide; x += hn::Lanes(d))
                hn::StoreU(loadWide(d, row.own + x), d, to + x);
            const auto place = static_cast<std::size_t>(out.placeInColumn(y, z));
            to[kBrickSide] = out.last[place] = static_cast<Wide>(row.behind[0]);
            if (!isPlane || y < 0 || y >= kPointSide)
                continue;
            to[-1] = static_cast<Wide>(row.before[0]);
            out.before[place] = static_cast<Wide>(row.own[kBrickSide - 1]);
            to[kPointSide] = out.behind[place] = static_cast<Wide>(row.behind[1]);
            StoredSample<Sample>* const own = stored + closedPoint(0, y, z).index();
            for (std::size_t x = 0; x < kBrickSide; ++x)
                own[x] = storedOf(row.own[x]);
            own[kBrickSide] = storedOf(row.behind[0]);
        }
    }
    out.scales = &out.halves();
}

// quantiseNormal(), lane by lane: a signed byte in an int. REQUIRES: |c| is at most one and a rounding error. Halves go
// away from zero, because the sum of a half and the number before 0.5 is rounded up; what lies below a half does not.
template <class D, class V>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> quantise(D d, V c) {
    const hn::RebindToSigned<D> ints;
    constexpr float kBeforeHalf = 0.49999997f;
    const auto scaled = hn::Mul(c, hn::Set(d, 127.0f));
    const auto further = hn::Add(scaled, hn::CopySignToAbs(hn::Set(d, kBeforeHalf), scaled));
    return hn::And(hn::ConvertTo(ints, further), hn::Set(ints, 0xff));
}

// normalOfGradient(), lane by lane, of gradients of a plain length or none; the mask marks those.
template <class D, class V>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> codesOf(D d, V gx, V gy, V gz, hn::Mask<D>& isPlain) {
    const hn::RebindToSigned<D> ints;
    const auto one = hn::Set(d, 1.0f);
    const auto sum = hn::Add(hn::Add(hn::Abs(gx), hn::Abs(gy)), hn::Abs(gz));
    const auto hasLength =
        hn::And(hn::Ge(sum, hn::Set(d, kLeastPlainGradient)), hn::Le(sum, hn::Set(d, kGreatestPlainGradient)));
    isPlain = hn::Or(hasLength, hn::Eq(sum, hn::Zero(d)));
    const auto scale = hn::Div(one, hn::IfThenElse(hasLength, sum, one));
    const auto u = hn::Mul(hn::Neg(gx), scale), v = hn::Mul(hn::Neg(gy), scale);
    // With the sign of the other; that of -0, which zero takes away, is none.
    const auto fold = [&](auto c, auto other) HWY_ATTR {
        return hn::Xor(hn::Sub(one, hn::Abs(other)), hn::And(hn::Add(c, hn::Zero(d)), hn::SignBit(d)));
    };
    const auto foldedU = fold(u, v), foldedV = fold(v, u);
    const auto folds = hn::Gt(gz, hn::Zero(d));
    const auto low = quantise(d, hn::IfThenElse(folds, foldedU, u)),
               high = quantise(d, hn::IfThenElse(folds, foldedV, v));
    const auto code = hn::Or(low, hn::ShiftLeft<8>(high));
    return hn::IfThenElse(hn::RebindMask(ints, hasLength), code, hn::Set(ints, kNoNormal));
}

// Codes of as many points as there are lanes.
template <class D, class V>
HWY_INLINE void writeCodes(D d, V gx, V gy, V gz, NormalCode* HWY_RESTRICT codes) {
    hn::Mask<D> isPlain;
    const auto found = codesOf(d, gx, gy, gz, isPlain);
    hn::StoreU(hn::DemoteTo(hn::Rebind<NormalCode, D>(), found), hn::Rebind<NormalCode, D>(), codes);
    if (HWY_UNLIKELY(!hn::AllTrue(d, isPlain))) {
        alignas(64) std::array<float, 16> xs, ys, zs;
        hn::Store(gx, d, xs.data());
        hn::Store(gy, d, ys.data());
        hn::Store(gz, d, zs.data());
        for (std::size_t i = 0; i < hn::Lanes(d); ++i)
            codes[i] = normalOfGradient({xs[i], ys[i], zs[i]});
    }
}

// derivativeAt(), in floats.
template <class D>
HWY_INLINE auto derivative(D d, const hn::TFromD<D>* lower, const hn::TFromD<D>* upper, hn::Vec<D> scale,
                           float inverseSpacing) {
    const auto difference = hn::Sub(hn::Mul(hn::LoadU(d, upper), scale), hn::Mul(hn::LoadU(d, lower), scale));
    const auto wide = hn::Mul(difference, hn::Set(d, static_cast<hn::TFromD<D>>(inverseSpacing)));
    if constexpr (std::is_same_v<hn::TFromD<D>, float>)
        return wide;
    else
        return hn::DemoteTo(hn::Rebind<float, D>(), wide);
}

template <class Wide>
HWY_INLINE void findNormals(const GradientSamples<Wide>& from, const glm::vec3& inverseSpacing,
                            NormalCode* HWY_RESTRICT codes) {
    using From = GradientSamples<Wide>;
    const hn::CappedTag<Wide, kBrickSide> d;
    const hn::Rebind<float, decltype(d)> floats;
    const std::size_t lanes = hn::Lanes(d);
    const typename From::Scales& scales = *from.scales;
    for (int z = 0; z < kPointSide; ++z)
        for (int y = 0; y < kPointSide; ++y) {
            const auto scaleY = hn::Set(d, scales.y[static_cast<std::size_t>(y)]),
                       scaleZ = hn::Set(d, scales.z[static_cast<std::size_t>(z)]);
            for (std::size_t x = 0; x < kBrickSide; x += lanes) {
                const Wide* const at = from.block.data() + SampleBlock<Wide>::offset(0, y, z) + x;
                writeCodes(floats, derivative(d, at - 1, at + 1, hn::Load(d, scales.x.data() + x), inverseSpacing.x),
                           derivative(d, at - From::kRow, at + From::kRow, scaleY, inverseSpacing.y),
                           derivative(d, at - From::kPlane, at + From::kPlane, scaleZ, inverseSpacing.z),
                           codes + closedPoint(0, y, z).index() + x);
            }
        }
    alignas(64) std::array<NormalCode, From::kColumn + From::kOverread> column;
    const auto scaleX = hn::Set(d, scales.x[kPointSide - 1]);
    for (std::size_t i = From::kFirstOfColumn; i <= From::placeInColumn(kPointSide - 1, kPointSide - 1); i += lanes)
        writeCodes(floats, derivative(d, from.before.data() + i, from.behind.data() + i, scaleX, inverseSpacing.x),
                   derivative(d, from.last.data() + i - 1, from.last.data() + i + 1,
                              hn::LoadU(d, scales.columnY.data() + i), inverseSpacing.y),
                   derivative(d, from.last.data() + i - From::kColumnRow, from.last.data() + i + From::kColumnRow,
                              hn::LoadU(d, scales.columnZ.data() + i), inverseSpacing.z),
                   column.data() + i);
    for (int z = 0; z < kPointSide; ++z)
        for (int y = 0; y < kPointSide; ++y)
            codes[closedPoint(kPointSide - 1, y, z).index()] =
                column[static_cast<std::size_t>(From::placeInColumn(y, z))];
}

template <class Sample>
void readPointsHere(const SampleRows<Sample>& rows, const glm::vec3& inverseSpacing, BrickPoints<Sample>& points) {
    GradientSamples<GradientType<Sample>> samples;
    // Read with the others, and of no consequence; but vectors of numbers that are none would be looked at one by one.
    for (auto* column : {&samples.before, &samples.last, &samples.behind})
        column->fill(0);
    if (rows.isWhole())
        fillInBox(rows, samples, points.samples);
    else
        fillBesideBox(rows, samples, points.samples);
    std::fill(points.samples + kClosedPoints, points.samples + kKeptPoints, points.samples[0]);
    findNormals(samples, inverseSpacing, points.normals);
}

#define ISO_READ_POINTS(Sample, Name) \
    void readPoints##Name(const SampleRows<Sample>& r, const glm::vec3& i, BrickPoints<Sample>& p) { \
        readPointsHere<Sample>(r, i, p); \
    }
ISO_FOR_EACH_SAMPLE_TYPE(ISO_READ_POINTS)
#undef ISO_READ_POINTS

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::extract {

#define ISO_READ_POINTS(Sample, Name) \
    HWY_EXPORT(readPoints##Name); \
    template <> \
    void readPoints<Sample>(const SampleRows<Sample>& r, const glm::vec3& i, BrickPoints<Sample>& p) { \
        HWY_DYNAMIC_DISPATCH(readPoints##Name)(r, i, p); \
    }
ISO_FOR_EACH_SAMPLE_TYPE(ISO_READ_POINTS)
#undef ISO_READ_POINTS

template <class Sample>
void readPointsReference(const SampleRows<Sample>& rows, const glm::vec3& inverseSpacing, BrickPoints<Sample>& points) {
    SampleBlock<Sample> block;
    readBlock(rows, block);
    StoredSample<Sample> any{};
    for (int p = kClosedPoints; p-- > 0;) {
        const auto at = coordsOf(ClosedPoint(static_cast<unsigned>(p)));
        if (!block.isInside(at[0], at[1], at[2]))
            continue;
        const Sample sample = block.samples[static_cast<std::size_t>(block.offset(at[0], at[1], at[2]))];
        if (!isMissing(sample))
            any = storedOf(sample);
        points.normals[p] = normalOfGradient(block.gradient(at[0], at[1], at[2], inverseSpacing));
    }
    std::fill_n(points.samples, kKeptPoints, any);
    for (unsigned p = 0; p < kClosedPoints; ++p) {
        const auto at = coordsOf(ClosedPoint(p));
        if (!block.isInside(at[0], at[1], at[2]))
            continue;
        const Sample sample = block.samples[static_cast<std::size_t>(block.offset(at[0], at[1], at[2]))];
        if (!isMissing(sample))
            points.samples[p] = storedOf(sample);
    }
}
#define ISO_INSTANTIATE(Sample, Name) \
    template void readPointsReference(const SampleRows<Sample>&, const glm::vec3&, BrickPoints<Sample>&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
#endif
