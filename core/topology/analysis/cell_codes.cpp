#include "core/topology/analysis/cell_codes.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>

#include "core/cell/cell_polynomials.h"
#include "core/grid/scalar_type.h"

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/topology/analysis/cell_codes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace isoslider::topology::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// ---- from the edges

template <class D>
HWY_INLINE hn::Vec<D> codesAt(D d, const std::uint8_t* HWY_RESTRICT edges, std::int64_t row, std::int64_t plane) {
    using V = hn::Vec<D>;
    // Bits: the next point along an axis is higher.
    const auto x = [](V v) HWY_ATTR { return hn::ShiftRight<1>(v); };
    const auto y = [](V v) HWY_ATTR { return hn::ShiftRight<3>(v); };
    const auto z = [](V v) HWY_ATTR { return hn::ShiftRight<5>(v); };
    const auto p = hn::LoadU(d, edges), px = hn::LoadU(d, edges + 1), py = hn::LoadU(d, edges + row),
               pz = hn::LoadU(d, edges + plane), pxy = hn::LoadU(d, edges + row + 1),
               pxz = hn::LoadU(d, edges + plane + 1), pyz = hn::LoadU(d, edges + plane + row);
    const auto one = hn::Set(d, 1);
    // Opposite edges of a face point against each other, both pairs from the same corner.
    const auto isSaddle = [&](V a0, V a1, V b0, V b1) HWY_ATTR {
        return hn::AndNot(hn::Xor(a0, b0), hn::And(one, hn::And(hn::Xor(a0, a1), hn::Xor(b0, b1))));
    };
    const auto low =
        hn::Or(isSaddle(y(p), y(pz), z(p), z(py)), hn::Or(hn::ShiftLeft<1>(isSaddle(y(px), y(pxz), z(px), z(pxy))),
                                                          hn::ShiftLeft<2>(isSaddle(x(p), x(pz), z(p), z(px)))));
    const auto high = hn::Or(hn::ShiftLeft<3>(isSaddle(x(py), x(pyz), z(py), z(pxy))),
                             hn::Or(hn::ShiftLeft<4>(isSaddle(x(p), x(py), y(p), y(px))),
                                    hn::ShiftLeft<5>(isSaddle(x(pz), x(pyz), y(pz), y(pxz)))));
    const auto differs = [&](V a, V b, V c)
                             HWY_ATTR { return hn::Or(hn::Xor(p, a), hn::Or(hn::Xor(p, b), hn::Xor(p, c))); };
    const auto inner =
        hn::And(one, hn::And(x(differs(py, pz, pyz)), hn::And(y(differs(px, pz, pxz)), z(differs(px, py, pxy)))));
    return hn::Or(hn::Or(low, high), hn::ShiftLeft<6>(inner));
}

void findFromEdges(const std::uint8_t* HWY_RESTRICT edges, std::int64_t row, std::int64_t plane, std::int64_t count,
                   CellCode* HWY_RESTRICT codes) {
    const hn::ScalableTag<std::uint8_t> d;
    const hn::CappedTag<std::uint8_t, 1> single;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
    if (count < lanes) {
        for (std::int64_t at = 0; at < count; ++at)
            hn::StoreU(codesAt(single, edges + at, row, plane), single, codes + at);
        return;
    }
    for (std::int64_t next = 0; next < count; next += lanes) {
        const std::int64_t at = std::min(next, count - lanes); // the last ones twice
        hn::StoreU(codesAt(d, edges + at, row, plane), d, codes + at);
    }
}

// ---- from the scalars

// Samples of up to 16 bits, and floats, in single precision: what that leaves open is more, but little.
template <class Sample>
using Number = std::conditional_t<sizeof(Sample) <= 2 || std::is_same_v<Sample, float>, float, double>;

template <class D, class Sample>
HWY_INLINE hn::Vec<D> scalarsFrom(D d, const Sample* HWY_RESTRICT samples) {
    const hn::Rebind<Sample, D> of;
    const auto some = hn::LoadU(of, samples);
    if constexpr (std::is_same_v<Sample, hn::TFromD<D>>)
        return some;
    else if constexpr (sizeof(Sample) <= 2)
        return hn::ConvertTo(d, hn::PromoteTo(hn::Rebind<std::int32_t, D>(), some));
    else
        return hn::PromoteTo(d, some);
}

// Cells in which a critical point may lie, see CellSaddles::findInner(): the words are those of body_saddles.cpp.
template <class D, class Sample>
HWY_INLINE hn::Mask<D> mayHaveInner(D d, const Sample* HWY_RESTRICT samples, std::int64_t row, std::int64_t plane) {
    using V = hn::Vec<D>;
    using T = hn::TFromD<D>;
    using Slices = cell::CellPolynomials<T>;
    constexpr T kUnit = std::numeric_limits<T>::epsilon(), kRoundings = 8 * kUnit;
    constexpr T kLeastSize = sizeof(T) == 4 ? T(1e-30) : T(1e-280), kMostSize = 1 / kLeastSize;
    V corner[8];
    for (std::int64_t c = 0; c < 8; ++c)
        corner[c] = scalarsFrom(d, samples + (c & 1) + row * (c >> 1 & 1) + plane * (c >> 2));
    const auto at = [&](int axis, int side, int k)
                        HWY_ATTR { return corner[Slices::kSlice[axis][k] + side * Slices::step(axis)]; };
    V leading[3], length[3], leadingSize[3], low[3], high[3], rateSize[3];
    // Of smaller products digits are lost, without a trace where they are multiplied by large ones; NaN is no size.
    const auto isPlainSize = [&](V size) HWY_ATTR {
        return hn::And(hn::Gt(size, hn::Set(d, kLeastSize)), hn::Lt(size, hn::Set(d, kMostSize)));
    };
    auto isCertain = hn::Eq(corner[0], corner[0]);
    auto error = hn::Set(d, 8 * kUnit);
    for (int axis = 0; axis < 3; ++axis) {
        const auto slope = [&](int k) HWY_ATTR { return hn::Sub(at(axis, 1, k), at(axis, 0, k)); };
        const auto joining = hn::Mul(slope(0), slope(3)), parting = hn::Mul(slope(1), slope(2));
        leading[axis] = hn::Sub(joining, parting);
        leadingSize[axis] = hn::Add(hn::Abs(joining), hn::Abs(parting));
        length[axis] = hn::Abs(leading[axis]);
        isCertain = hn::And(isCertain, isPlainSize(leadingSize[axis]));
        isCertain = hn::And(isCertain, hn::Gt(length[axis], hn::Mul(hn::Set(d, kRoundings), leadingSize[axis])));
        V rate[2], size[2];
        for (int side = 0; side < 2; ++side) {
            const auto first = hn::Sub(at(axis, side, 0), at(axis, side, 1)),
                       second = hn::Sub(at(axis, side, 3), at(axis, side, 2));
            rate[side] = hn::Add(first, second);
            size[side] = hn::Add(hn::Abs(first), hn::Abs(second));
        }
        low[axis] = hn::Min(rate[0], rate[1]);
        high[axis] = hn::Max(rate[0], rate[1]);
        rateSize[axis] = hn::Max(size[0], size[1]);
    }
    const auto ofTwo = hn::Mul(leading[0], leading[1]), product = hn::Neg(hn::Mul(ofTwo, leading[2]));
    isCertain = hn::And(isCertain, hn::And(isPlainSize(hn::Abs(ofTwo)), isPlainSize(hn::Abs(product))));
    const auto mayBe = hn::Gt(product, hn::Zero(d)); // else no isovalue has a tunnel
    if (hn::AllTrue(d, hn::And(isCertain, hn::Not(mayBe))))
        return hn::MaskFromVec(hn::Zero(d));
    // Without a term in xyz there is one critical point at most, found otherwise.
    isCertain = hn::And(isCertain, hn::Gt(hn::Sub(high[0], low[0]), hn::Mul(hn::Set(d, 64 * kUnit), rateSize[0])));
    const auto root = hn::Sqrt(hn::Max(product, hn::Zero(d)));
    V mixed[3];
    for (int axis = 0; axis < 3; ++axis) {
        const auto per = hn::Div(hn::Set(d, T(1)), length[axis]);
        mixed[axis] = hn::Mul(root, per);
        error = hn::Add(error, hn::Mul(hn::Set(d, 4 * kUnit), hn::Mul(leadingSize[axis], per)));
    }
    // The product of any two is the leading coefficient of the third, less its sign.
    const auto negatedLike = [&](V value, V sign)
                                 HWY_ATTR { return hn::IfThenElse(hn::Lt(sign, hn::Zero(d)), value, hn::Neg(value)); };
    mixed[1] = negatedLike(mixed[1], leading[2]);
    mixed[2] = negatedLike(mixed[2], leading[1]);
    auto isOutside = hn::MaskFromVec(hn::Zero(d)), isOtherOutside = isOutside; // the one and the other critical point
    for (int axis = 0; axis < 3; ++axis) {
        const auto here = hn::Abs(mixed[axis]);
        const auto margin = hn::Add(hn::Mul(hn::Add(here, here), hn::Add(error, error)),
                                    hn::Mul(hn::Set(d, 16 * kUnit), hn::Add(here, rateSize[axis])));
        const auto from = hn::Sub(low[axis], margin), to = hn::Add(high[axis], margin);
        const auto other = hn::Neg(mixed[axis]);
        isOutside = hn::Or(isOutside, hn::Or(hn::Lt(mixed[axis], from), hn::Gt(mixed[axis], to)));
        isOtherOutside = hn::Or(isOtherOutside, hn::Or(hn::Lt(other, from), hn::Gt(other, to)));
    }
    const auto isNone = hn::Or(hn::Not(mayBe), hn::And(isOutside, isOtherOutside));
    return hn::Not(hn::And(isCertain, isNone));
}

template <class Sample>
void findCodes(const Sample* HWY_RESTRICT samples, const std::uint8_t* HWY_RESTRICT edges, std::int64_t row,
               std::int64_t plane, std::int64_t count, CellCode* HWY_RESTRICT codes) {
    findFromEdges(edges, row, plane, count, codes);
    const hn::CappedTag<Number<Sample>, 16> d;
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
    if (count < lanes)
        return;
    for (std::int64_t next = 0; next < count; next += lanes) {
        const std::int64_t at = std::min(next, count - lanes); // the last ones twice
        const auto here = hn::LoadU(bytes, codes + at);
        if (hn::AllFalse(bytes, hn::TestBit(here, hn::Set(bytes, kMayHaveInner))))
            continue;
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, mayHaveInner(d, samples + at, row, plane), bits);
        const auto keeps = hn::Or(hn::VecFromMask(bytes, hn::LoadMaskBits(bytes, bits)),
                                  hn::Set(bytes, static_cast<std::uint8_t>(~kMayHaveInner)));
        hn::StoreU(hn::And(here, keeps), bytes, codes + at);
    }
}

#define ISO_KERNEL(Sample, Name) \
    void findCodes##Name(const Sample* s, const std::uint8_t* e, std::int64_t row, std::int64_t plane, std::int64_t n, \
                         CellCode* c) { \
        findCodes(s, e, row, plane, n, c); \
    }
ISO_FOR_EACH_SAMPLE_TYPE(ISO_KERNEL)
#undef ISO_KERNEL

} // namespace isoslider::topology::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::topology {

#define ISO_EXPORT(Sample, Name) \
    HWY_EXPORT(findCodes##Name); \
    template <> \
    void findCellCodes(const Sample* s, const std::uint8_t* e, std::int64_t row, std::int64_t plane, std::int64_t n, \
                       CellCode* c) { \
        HWY_DYNAMIC_DISPATCH(findCodes##Name)(s, e, row, plane, n, c); \
    }
ISO_FOR_EACH_SAMPLE_TYPE(ISO_EXPORT)
#undef ISO_EXPORT

} // namespace isoslider::topology
#endif
