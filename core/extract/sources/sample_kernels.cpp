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

// Puts the brick's own samples into the block, in whole vectors: what of the apron these write over is put back.
template <class Sample>
HWY_INLINE void fillIn(const StoredSample<Sample>* HWY_RESTRICT samples, SampleBlock<float>& block) {
    using Block = SampleBlock<float>;
    const hn::CappedTag<float, 16> d;
    for (int z = 0; z < kPointSide; ++z)
        for (int y = 0; y < kPointSide; ++y) {
            float* const out = block.samples.data() + Block::offset(0, y, z);
            const auto* const row = samples + closedPoint(0, y, z).index();
            const float behind = out[kPointSide], next = out[Block::kRow - 1];
            for (std::size_t i = 0; i < static_cast<std::size_t>(kPointSide); i += hn::Lanes(d))
                hn::StoreU(loadStored<Sample>(d, row + i), d, out + i);
            out[kPointSide] = behind;
            out[Block::kRow - 1] = next;
        }
}

// Beside the box a one-sided difference is that of the point and its only neighbour: the point stands in for the
// missing one, and the difference is not halved.
template <class D, class V>
HWY_INLINE V differenceOf(D d, V upper, V lower, V scale, float inverse) {
    return hn::Mul(hn::Sub(hn::Mul(upper, scale), hn::Mul(lower, scale)), hn::Set(d, inverse));
}

// Codes of the first `count` lanes, each where `put` puts it.
template <class D, class V, class Put>
HWY_INLINE void writeCodes(D d, V gx, V gy, V gz, std::size_t count, const Put& put) {
    const hn::RebindToSigned<D> ints;
    alignas(64) std::int32_t codes[16];
    hn::Mask<D> isPlain;
    hn::Store(codesOf(d, gx, gy, gz, isPlain), ints, codes);
    for (std::size_t i = 0; i < count; ++i)
        put(i, static_cast<NormalCode>(codes[i]));
    if (HWY_UNLIKELY(!hn::AllTrue(d, isPlain))) { // what stands behind the last may be the reason; no matter
        alignas(64) float xs[16], ys[16], zs[16];
        hn::Store(gx, d, xs);
        hn::Store(gy, d, ys);
        hn::Store(gz, d, zs);
        for (std::size_t i = 0; i < count; ++i)
            put(i, normalOfGradient({xs[i], ys[i], zs[i]}));
    }
}

// Points in lanes, their neighbours gathered.
void findNormalsOfPoints(const BitString& points, const SampleBlock<float>& block, const glm::vec3& inverseSpacing,
                         NormalCode* HWY_RESTRICT codes) {
    using Block = SampleBlock<float>;
    const hn::CappedTag<float, 16> d;
    const hn::RebindToSigned<decltype(d)> ints;
    const std::size_t lanes = hn::Lanes(d);
    alignas(64) std::array<std::uint16_t, kPaddedPoints + 64> list;
    const auto count = static_cast<std::size_t>(listBits<1>(points, 0, list.data()) - list.data());
    std::fill_n(list.data() + count, lanes, std::uint16_t{0});
    const hn::Rebind<std::uint16_t, decltype(ints)> narrow;
    const float* const origin = block.samples.data() + Block::offset(0, 0, 0);
    for (std::size_t k = 0; k < count; k += lanes) {
        const auto p = hn::PromoteTo(ints, hn::LoadU(narrow, list.data() + k));
        // Quotients by 9 and 81 as products: see vertex_kernels.cpp.
        const auto ninth = hn::ShiftRight<16>(hn::Mul(p, hn::Set(ints, 7282)));
        const auto z = hn::ShiftRight<16>(hn::Mul(p, hn::Set(ints, 810)));
        const auto y = hn::Sub(ninth, hn::Mul(z, hn::Set(ints, 9)));
        const auto x = hn::Sub(p, hn::Mul(ninth, hn::Set(ints, 9)));
        const auto at = hn::Add(hn::Add(x, hn::ShiftLeft<4>(y)), hn::Mul(z, hn::Set(ints, Block::kPlane)));
        static_assert(Block::kRow == 16);
        const auto derivative = [&](auto along, int stride, std::size_t axis, float inverse) HWY_ATTR {
            const auto hasLower = hn::Gt(along, hn::Set(ints, block.begin[axis]));
            const auto hasUpper = hn::Lt(along, hn::Set(ints, block.end[axis] - 1));
            const auto step = hn::Set(ints, stride);
            const auto lower = hn::GatherIndex(d, origin, hn::Sub(at, hn::IfThenElseZero(hasLower, step)));
            const auto upper = hn::GatherIndex(d, origin, hn::Add(at, hn::IfThenElseZero(hasUpper, step)));
            const auto isBetween = hn::RebindMask(d, hn::And(hasLower, hasUpper));
            const auto scale = hn::IfThenElse(isBetween, hn::Set(d, 0.5f), hn::Set(d, 1.0f));
            return differenceOf(d, upper, lower, scale, inverse);
        };
        writeCodes(d, derivative(x, 1, 0, inverseSpacing.x), derivative(y, Block::kRow, 1, inverseSpacing.y),
                   derivative(z, Block::kPlane, 2, inverseSpacing.z), std::min(lanes, count - k),
                   [&](std::size_t i, NormalCode code) { codes[list[k + i]] = code; });
    }
}

template <class Sample>
void findNormalsAtHere(const BitString& points, const StoredSample<Sample>* HWY_RESTRICT samples,
                       SampleBlock<float>& block, const glm::vec3& inverseSpacing, NormalCode* HWY_RESTRICT codes) {
    fillIn<Sample>(samples, block);
    findNormalsOfPoints(points, block, inverseSpacing, codes);
}

// Eight points of a row at a time; the ninth of all rows are then points by themselves.
template <class Sample>
void findNormalsHere(const StoredSample<Sample>* HWY_RESTRICT samples, SampleBlock<float>& block, const PointRows& rows,
                     const glm::vec3& inverseSpacing, NormalCode* HWY_RESTRICT codes) {
    using Block = SampleBlock<float>;
    const hn::CappedTag<float, 8> d;
    const std::size_t lanes = hn::Lanes(d);
    fillIn<Sample>(samples, block);
    const bool isAtBegin = block.begin[0] == 0;
    const auto inRow = static_cast<std::size_t>(std::min(kBrickSide, block.end[0]));
    // Where the box begins or ends in the row.
    alignas(64) float scaleX[8];
    std::fill_n(scaleX, 8, 0.5f);
    if (isAtBegin)
        scaleX[0] = 1.0f;
    if (block.end[0] <= kBrickSide)
        scaleX[block.end[0] - 1] = 1.0f;
    BitString lasts;
    for (int z = 0; z < std::min(kPointSide, block.end[2]); ++z)
        for (unsigned left = rows[static_cast<std::size_t>(z)]; left != 0; left &= left - 1) {
            const int y = std::countr_zero(left);
            if (y >= block.end[1])
                break;
            if (block.end[0] >= kPointSide)
                lasts.set(closedPoint(kPointSide - 1, y, z));
            const int below = y > block.begin[1] ? Block::kRow : 0, above = y + 1 < block.end[1] ? Block::kRow : 0;
            const int under = z > block.begin[2] ? Block::kPlane : 0, over = z + 1 < block.end[2] ? Block::kPlane : 0;
            const auto scaleY = hn::Set(d, below != 0 && above != 0 ? 0.5f : 1.0f),
                       scaleZ = hn::Set(d, under != 0 && over != 0 ? 0.5f : 1.0f);
            for (std::size_t i = 0; i < inRow; i += lanes) {
                const float* const at = block.samples.data() + Block::offset(0, y, z) + i;
                const auto own = hn::LoadU(d, at), place = hn::Iota(d, static_cast<float>(i));
                auto lowerX = hn::LoadU(d, at - 1), upperX = hn::LoadU(d, at + 1);
                if (isAtBegin)
                    lowerX = hn::IfThenElse(hn::Eq(place, hn::Zero(d)), own, lowerX);
                if (block.end[0] <= kBrickSide)
                    upperX =
                        hn::IfThenElse(hn::Eq(place, hn::Set(d, static_cast<float>(block.end[0] - 1))), own, upperX);
                NormalCode* const out = codes + closedPoint(0, y, z).index() + i;
                writeCodes(
                    d, differenceOf(d, upperX, lowerX, hn::Load(d, scaleX + i), inverseSpacing.x),
                    differenceOf(d, hn::LoadU(d, at + above), hn::LoadU(d, at - below), scaleY, inverseSpacing.y),
                    differenceOf(d, hn::LoadU(d, at + over), hn::LoadU(d, at - under), scaleZ, inverseSpacing.z),
                    std::min(lanes, inRow - i), [&](std::size_t k, NormalCode code) { out[k] = code; });
            }
        }
    findNormalsOfPoints(lasts, block, inverseSpacing, codes);
}

#define ISO_NORMALS(Name, Sample) \
    void Name(const StoredSample<Sample>* s, SampleBlock<float>& a, const PointRows& r, const glm::vec3& i, \
              NormalCode* c) { \
        findNormalsHere<Sample>(s, a, r, i, c); \
    } \
    void Name##At(const BitString& p, const StoredSample<Sample>* s, SampleBlock<float>& a, const glm::vec3& i, \
                  NormalCode* c) { \
        findNormalsAtHere<Sample>(p, s, a, i, c); \
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
    void findNormals<Sample>(const StoredSample<Sample>* s, SampleBlock<float>& a, const PointRows& r, \
                             const glm::vec3& i, NormalCode* c) { \
        HWY_DYNAMIC_DISPATCH(Name)(s, a, r, i, c); \
    } \
    HWY_EXPORT(Name##At); \
    template <> \
    void findNormalsAt<Sample>(const BitString& p, const StoredSample<Sample>* s, SampleBlock<float>& a, \
                               const glm::vec3& i, NormalCode* c) { \
        HWY_DYNAMIC_DISPATCH(Name##At)(p, s, a, i, c); \
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
