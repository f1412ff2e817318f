#include "core/extract/sources/sample_kernels.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/grid/gradient.h"

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/extract/sources/sample_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/extract/live/bit_lists-inl.h"

#ifndef ISO_FINISH_CLASSIFICATION
#define ISO_FINISH_CLASSIFICATION
namespace isoslider::extract {

/// Do(Stored, Name) for every StoredSample: signed integers of 8 and 16 bits are stored as unsigned ones.
#define ISO_FOR_EACH_STORED_TYPE(Do) \
    Do(std::uint8_t, U8) Do(std::uint16_t, U16) Do(std::int32_t, I32) Do(float, F32) Do(double, F64)

// What follows from the signs, for every instruction set that this is inlined into.
template <class T>
inline __attribute__((always_inline)) void finishClassification(const BrickMasks& masks, const BitString* before,
                                                                ClassifiedBrick<T>& out) {
    findActive(out.above, masks, out.active);
    std::uint32_t owned = 0, added = 0, removed = 0;
    const auto count = [&](std::size_t axis, int i, std::uint64_t was) {
        const auto w = static_cast<std::size_t>(i);
        const std::uint64_t now = out.active.edges[axis].words[w] & masks.owned[axis].words[w];
        was &= masks.owned[axis].words[w];
        owned += static_cast<std::uint32_t>(std::popcount(now));
        added += static_cast<std::uint32_t>(std::popcount(now & ~was));
        removed += static_cast<std::uint32_t>(std::popcount(was & ~now));
    };
    if (before) {
        UnsetBits flipped;
        for (int i = 0; i < kBitWords; ++i) {
            const auto w = static_cast<std::size_t>(i);
            const std::uint64_t here = before->words[w];
            flipped.words[w] = here ^ out.above.words[w];
            count(0, i, here ^ shiftedDown<1>(*before, i));
            count(1, i, here ^ shiftedDown<9>(*before, i));
            count(2, i, here ^ shiftedDown<81>(*before, i));
        }
        cellsAtPoints(flipped, out.changed);
    } else {
        out.changed.words.fill(~std::uint64_t{0});
        for (int i = 0; i < kBitWords; ++i)
            for (std::size_t axis = 0; axis < 3; ++axis)
                count(axis, i, 0);
    }
    out.ownedEdges = owned;
    out.edgesAdded = added;
    out.edgesRemoved = removed;
}

} // namespace isoslider::extract
#endif

HWY_BEFORE_NAMESPACE();
namespace isoslider::extract::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class T>
void findSigns(const T* HWY_RESTRICT samples, T threshold, BitString& above, T& leastAbove, T& greatestBelow) {
    const hn::CappedTag<T, 64> d;
    constexpr std::size_t lanes = hn::MaxLanes(d); // no instruction set of unknown length has less than one word's
    // As wide as a mask is stored: reading it wider than it was written would wait until it is in the cache.
    using Mask = std::conditional_t<
        lanes <= 8, std::uint8_t,
        std::conditional_t<lanes <= 16, std::uint16_t, std::conditional_t<lanes <= 32, std::uint32_t, std::uint64_t>>>;
    static_assert(lanes <= 64);
    const auto limit = hn::Set(d, threshold);
    const auto greatest = hn::Set(d, std::numeric_limits<T>::max()),
               least = hn::Set(d, std::numeric_limits<T>::lowest());
    auto up = greatest, down = least;
    for (std::size_t w = 0; w < kBitWords; ++w) {
        std::uint64_t word = 0;
        for (std::size_t i = 0; i < 64; i += lanes) {
            const auto sample = hn::Load(d, samples + 64 * w + i);
            const auto isBelow = hn::Lt(sample, limit);
            up = hn::Min(up, hn::IfThenElse(isBelow, greatest, sample));
            down = hn::Max(down, hn::IfThenElse(isBelow, sample, least));
            Mask bits = 0;
            hn::StoreMaskBits(d, isBelow, reinterpret_cast<std::uint8_t*>(&bits));
            if constexpr (lanes < 8)
                bits &= static_cast<Mask>((1u << lanes) - 1);
            word |= std::uint64_t{bits} << i;
        }
        above.words[w] = ~word;
    }
    // Lane by lane: reductions of some types are missing in some sets, and this is once in 768 samples.
    alignas(64) T ups[64], downs[64];
    hn::Store(up, d, ups);
    hn::Store(down, d, downs);
    for (std::size_t half = lanes / 2; half > 0; half /= 2)
        for (std::size_t i = 0; i < half; ++i) {
            ups[i] = ups[i + half] < ups[i] ? ups[i + half] : ups[i];
            downs[i] = downs[i + half] > downs[i] ? downs[i + half] : downs[i];
        }
    leastAbove = ups[0];
    greatestBelow = downs[0];
}

template <class T>
void classifyInVectors(const T* HWY_RESTRICT samples, T threshold, const BrickMasks& masks, const BitString* before,
                       ClassifiedBrick<T>& out) {
    findSigns(samples, threshold, out.above, out.up, out.down);
    finishClassification(masks, before, out);
}

#define ISO_CLASSIFY(Stored, Name) \
    void classify##Name(const Stored* s, Stored t, const BrickMasks& m, const BitString* b, \
                        ClassifiedBrick<Stored>& out) { \
        classifyInVectors(s, t, m, b, out); \
    }
ISO_FOR_EACH_STORED_TYPE(ISO_CLASSIFY)
#undef ISO_CLASSIFY

std::uint32_t numberEdgesHere(const ActiveBits& active, VertexCode* HWY_RESTRICT codes, VertexTable& vertices) {
    static_assert(vertexCode(closedEdge(1, ClosedPoint(5))) == 4 * 5 + 1); // also its place in the vertex table
    VertexCode* end = codes;
    end = listBits<4>(active.edges[0], 0, end);
    end = listBits<4>(active.edges[1], 1, end);
    end = listBits<4>(active.edges[2], 2, end);
    const auto count = static_cast<std::uint32_t>(end - codes);
    for (std::uint32_t k = 0; k < count; ++k)
        vertices.numbers[codes[k]] = static_cast<std::uint16_t>(k);
    return count;
}

// Samples as floats, which hold those of up to 16 bits exactly.
template <class D, class Sample>
HWY_INLINE hn::Vec<D> loadFloats(D d, const Sample* from) {
    if constexpr (std::is_same_v<Sample, float>) {
        return hn::LoadU(d, from);
    } else {
        const hn::Rebind<std::int32_t, D> ints;
        const hn::Rebind<Sample, D> narrow;
        return hn::ConvertTo(d, hn::PromoteTo(ints, hn::LoadU(narrow, from)));
    }
}

// The same of stored samples: those that are keys are led back to what they stand for.
template <class Sample, class D>
HWY_INLINE hn::Vec<D> loadStored(D d, const StoredSample<Sample>* from) {
    if constexpr (std::is_same_v<Sample, StoredSample<Sample>>) {
        return loadFloats(d, from);
    } else {
        const hn::Rebind<std::int32_t, D> ints;
        const hn::Rebind<StoredSample<Sample>, D> narrow;
        constexpr std::int32_t kZero = 1 << (8 * sizeof(Sample) - 1); // the key of 0
        return hn::ConvertTo(d, hn::Sub(hn::PromoteTo(ints, hn::LoadU(narrow, from)), hn::Set(ints, kZero)));
    }
}

// quantiseNormal(), lane by lane: a signed byte in an int. REQUIRES: |c| is at most one and a rounding error. Rounds to
// even first; where that was a tie that went towards zero, the difference is half a unit of the number's own sign.
template <class D, class V>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> quantise(D d, V c) {
    const hn::RebindToSigned<D> ints;
    const auto scaled = hn::Mul(c, hn::Set(d, 127.0f));
    const auto even = hn::Round(scaled);
    const auto isTie = hn::Eq(hn::Sub(scaled, even), hn::CopySign(hn::Set(d, 0.5f), scaled));
    const auto away = hn::Add(even, hn::IfThenElseZero(isTie, hn::CopySign(hn::Set(d, 1.0f), scaled)));
    return hn::And(hn::ConvertTo(ints, away), hn::Set(ints, 0xff));
}

// normalOfGradient(), lane by lane, for gradients of a plain length; the mask marks those that have one.
template <class D, class V>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> codesOf(D d, V gx, V gy, V gz, hn::Mask<D>& isPlain) {
    const auto one = hn::Set(d, 1.0f);
    const auto sum = hn::Add(hn::Add(hn::Abs(gx), hn::Abs(gy)), hn::Abs(gz));
    isPlain = hn::And(hn::Ge(sum, hn::Set(d, kLeastPlainGradient)), hn::Le(sum, hn::Set(d, kGreatestPlainGradient)));
    const auto scale = hn::Div(one, hn::IfThenElse(isPlain, sum, one));
    const auto u = hn::Mul(hn::Neg(gx), scale), v = hn::Mul(hn::Neg(gy), scale);
    const auto signOf = [&](auto c) HWY_ATTR { return hn::IfThenElse(hn::Ge(c, hn::Zero(d)), one, hn::Neg(one)); };
    const auto foldedU = hn::Mul(hn::Sub(one, hn::Abs(v)), signOf(u));
    const auto foldedV = hn::Mul(hn::Sub(one, hn::Abs(u)), signOf(v));
    const auto folds = hn::Gt(gz, hn::Zero(d));
    const auto low = quantise(d, hn::IfThenElse(folds, foldedU, u)),
               high = quantise(d, hn::IfThenElse(folds, foldedV, v));
    return hn::Or(low, hn::ShiftLeft<8>(high));
}

template <class Sample>
void findNormalsHere(const StoredSample<Sample>* HWY_RESTRICT samples, const SampleBlock<Sample>& apron,
                     const PointRows& rows, const glm::vec3& inverseSpacing, NormalCode* HWY_RESTRICT codes) {
    using Block = SampleBlock<Sample>;
    using Stored = StoredSample<Sample>;
    const hn::CappedTag<float, 16> d;
    const std::size_t lanes = hn::Lanes(d);
    // Beside the box a one-sided difference is that of the point and its only neighbour: the point stands in for the
    // missing one, and the difference is not halved.
    const bool isAtBegin = apron.begin[0] == 0, isAtEnd = apron.end[0] < 10;
    const auto end = static_cast<std::size_t>(std::min(kPointSide, apron.end[0]));
    alignas(64) float scaleX[32];
    std::fill_n(scaleX, 32, 0.5f);
    if (isAtBegin)
        scaleX[0] = 1.0f;
    if (isAtEnd)
        scaleX[end - 1] = 1.0f;
    alignas(64) Stored firstRow[32]; // with room before it
    if (rows[0] & 1)
        std::copy_n(samples, 31, firstRow + 1);
    for (int z = 0; z < kPointSide; ++z)
        for (unsigned left = rows[static_cast<std::size_t>(z)]; left != 0; left &= left - 1) {
            const int y = std::countr_zero(left);
            NormalCode* const out = codes + closedPoint(0, y, z).index();
            if (z >= apron.end[2] || y >= apron.end[1])
                continue;
            const Stored* const row = samples + closedPoint(0, y, z).index();
            const Stored* const rowBefore = row == samples ? firstRow : row - 1; // what stands at x = -1 is replaced
            const Sample* const beside = apron.samples.data() + Block::offset(0, y, z);
            const Sample before = isAtBegin ? sampleOf<Sample>(row[0]) : beside[-1];
            const Sample behind = isAtEnd ? sampleOf<Sample>(row[end - 1]) : beside[kPointSide];
            const bool hasBehind = y > apron.begin[1], hasAhead = y + 1 < apron.end[1];
            const bool hasBelow = z > apron.begin[2], hasOver = z + 1 < apron.end[2];
            const auto scaleY = hn::Set(d, hasBehind && hasAhead ? 0.5f : 1.0f),
                       scaleZ = hn::Set(d, hasBelow && hasOver ? 0.5f : 1.0f);
            for (std::size_t i = 0; i < end; i += lanes) {
                const auto place = hn::Iota(d, static_cast<float>(i));
                const auto difference = [&](auto upper, auto lower, auto scale, float inverse) HWY_ATTR {
                    return hn::Mul(hn::Sub(hn::Mul(upper, scale), hn::Mul(lower, scale)), hn::Set(d, inverse));
                };
                const auto rowAt = [&](int atY, int atZ) HWY_ATTR {
                    const bool isOwn = atY >= 0 && atY < kPointSide && atZ >= 0 && atZ < kPointSide;
                    return isOwn ? loadStored<Sample>(d, samples + closedPoint(0, atY, atZ).index() + i)
                                 : loadFloats(d, apron.samples.data() + Block::offset(0, atY, atZ) + i);
                };
                const auto smaller = hn::IfThenElse(hn::Eq(place, hn::Zero(d)), hn::Set(d, static_cast<float>(before)),
                                                    loadStored<Sample>(d, rowBefore + i));
                const auto larger =
                    hn::IfThenElse(hn::Eq(place, hn::Set(d, static_cast<float>(end - 1))),
                                   hn::Set(d, static_cast<float>(behind)), loadStored<Sample>(d, row + 1 + i));
                const auto gx = difference(larger, smaller, hn::Load(d, scaleX + i), inverseSpacing.x);
                const auto gy = difference(rowAt(hasAhead ? y + 1 : y, z), rowAt(hasBehind ? y - 1 : y, z), scaleY,
                                           inverseSpacing.y);
                const auto gz =
                    difference(rowAt(y, hasOver ? z + 1 : z), rowAt(y, hasBelow ? z - 1 : z), scaleZ, inverseSpacing.z);
                hn::Mask<decltype(d)> isPlain;
                const auto code = codesOf(d, gx, gy, gz, isPlain);
                const hn::Rebind<NormalCode, decltype(d)> narrow;
                const std::size_t points = std::min(lanes, end - i);
                hn::BlendedStore(hn::DemoteTo(narrow, code), hn::FirstN(narrow, points), narrow, out + i);
                const auto isPoint = hn::FirstN(d, points); // behind them stands anything
                if (HWY_UNLIKELY(!hn::AllFalse(d, hn::AndNot(isPlain, isPoint)))) {
                    alignas(64) float xs[16], ys[16], zs[16];
                    hn::Store(gx, d, xs);
                    hn::Store(gy, d, ys);
                    hn::Store(gz, d, zs);
                    for (std::size_t k = 0; k < points; ++k)
                        out[i + k] = normalOfGradient({xs[k], ys[k], zs[k]});
                }
            }
        }
}

#define ISO_NORMALS(Name, Sample) \
    void Name(const StoredSample<Sample>* s, const SampleBlock<Sample>& a, const PointRows& r, const glm::vec3& i, \
              NormalCode* c) { \
        findNormalsHere<Sample>(s, a, r, i, c); \
    }
ISO_NORMALS(normalsU8, std::uint8_t)
ISO_NORMALS(normalsI8, std::int8_t)
ISO_NORMALS(normalsU16, std::uint16_t)
ISO_NORMALS(normalsI16, std::int16_t)
ISO_NORMALS(normalsF32, float)
#undef ISO_NORMALS

} // namespace isoslider::extract::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::extract {

#define ISO_CLASSIFY(Stored, Name) \
    HWY_EXPORT(classify##Name); \
    template <> \
    void classify(const Stored* s, Stored t, const BrickMasks& m, const BitString* b, ClassifiedBrick<Stored>& out) { \
        HWY_DYNAMIC_DISPATCH(classify##Name)(s, t, m, b, out); \
    }
ISO_FOR_EACH_STORED_TYPE(ISO_CLASSIFY)
#undef ISO_CLASSIFY

HWY_EXPORT(numberEdgesHere);
std::uint32_t numberEdges(const ActiveBits& active, VertexCode* codes, VertexTable& vertices) {
    return HWY_DYNAMIC_DISPATCH(numberEdgesHere)(active, codes, vertices);
}

#define ISO_NORMALS(Name, Sample) \
    HWY_EXPORT(Name); \
    template <> \
    void findNormals<Sample>(const StoredSample<Sample>* s, const SampleBlock<Sample>& a, const PointRows& r, \
                             const glm::vec3& i, NormalCode* c) { \
        HWY_DYNAMIC_DISPATCH(Name)(s, a, r, i, c); \
    }
ISO_NORMALS(normalsU8, std::uint8_t)
ISO_NORMALS(normalsI8, std::int8_t)
ISO_NORMALS(normalsU16, std::uint16_t)
ISO_NORMALS(normalsI16, std::int16_t)
ISO_NORMALS(normalsF32, float)
#undef ISO_NORMALS

template <class Sample>
void findNormalsReference(const SampleBlock<Sample>& block, const PointRows& rows, const glm::vec3& inverseSpacing,
                          NormalCode* codes) {
    for (int z = 0; z < kPointSide; ++z)
        for (unsigned left = rows[static_cast<std::size_t>(z)]; left != 0; left &= left - 1) {
            const int y = std::countr_zero(left);
            for (int x = 0; x < kPointSide; ++x)
                if (block.isInside(x, y, z))
                    codes[closedPoint(x, y, z).index()] = normalOfGradient(block.gradient(x, y, z, inverseSpacing));
        }
}
#define ISO_INSTANTIATE(Sample, Name) \
    template void findNormalsReference(const SampleBlock<Sample>&, const PointRows&, const glm::vec3&, NormalCode*);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

template <class Stored>
void classifyReference(const Stored* samples, Stored threshold, const BrickMasks& masks, const BitString* before,
                       ClassifiedBrick<Stored>& out) {
    out.above = {};
    out.up = std::numeric_limits<Stored>::max();
    out.down = std::numeric_limits<Stored>::lowest();
    for (unsigned p = 0; p < kPaddedPoints; ++p) {
        if (samples[p] >= threshold) {
            out.above.set(ClosedPoint(p));
            out.up = std::min(out.up, samples[p]);
        } else {
            out.down = std::max(out.down, samples[p]);
        }
    }
    finishClassification(masks, before, out);
}
#define ISO_INSTANTIATE(Stored, Name) \
    template void classifyReference(const Stored*, Stored, const BrickMasks&, const BitString*, \
                                    ClassifiedBrick<Stored>&);
ISO_FOR_EACH_STORED_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

namespace {
std::vector<std::int64_t> supportedTargets() {
    std::vector<std::int64_t> targets;
    for (auto rest = static_cast<std::uint64_t>(hwy::SupportedTargets() & HWY_TARGETS); rest != 0; rest &= rest - 1)
        targets.push_back(static_cast<std::int64_t>(std::uint64_t{1} << std::countr_zero(rest)));
    return targets; // better ones have lower bits
}
} // namespace

std::vector<std::string> kernelTargets() {
    std::vector<std::string> names;
    for (const std::int64_t target : supportedTargets())
        names.emplace_back(hwy::TargetName(target));
    return names;
}

void useKernelTarget(std::size_t number) {
    hwy::SetSupportedTargetsForTest(0);
    const auto targets = supportedTargets();
    if (number > 0)
        hwy::SetSupportedTargetsForTest(targets.at(number));
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

} // namespace isoslider::extract
#endif
