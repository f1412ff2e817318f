#include "core/cell/undecided_cells.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/cell/cell_numbering.h"
#include "core/cell/cell_polynomials.h"
#include "core/cell/cell_states.h"
#include "core/cell/plain_decisions.h"

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/cell/undecided_cells.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace isoslider::cell::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// What plain_decisions and saddleOfFace() decide, operation by operation, for as many cells as a vector holds.
class Lanes {
public:
    using D = hn::CappedTag<double, 8>;
    using V = hn::Vec<D>;
    using M = hn::Mask<D>;

    HWY_INLINE Lanes(const UndecidedCells& cells, std::size_t first, double isovalue)
        : isovalue_(hn::Set(d_, isovalue)), isovalueSize_(hn::Abs(isovalue_)) {
        for (std::size_t c = 0; c < 8; ++c) {
            v_[c] = hn::Load(d_, cells.scalars[c].data() + first);
            g_[c] = hn::Sub(v_[c], isovalue_);
            size_[c] = hn::Abs(g_[c]);
        }
        signs_ = hn::Load(bits_, cells.signs.data() + first);
        alignas(64) std::array<std::uint64_t, 8> faces;
        for (std::size_t i = 0; i < hn::Lanes(d_); ++i)
            faces[i] = ambiguousFaces(static_cast<std::uint8_t>(cells.signs[first + i]));
        ambiguous_ = hn::Load(bits_, faces.data());
    }

    HWY_INLINE std::uint64_t finiteCells() const {
        const V infinity = hn::Set(d_, std::numeric_limits<double>::infinity());
        M finite = hn::Eq(isovalue_, isovalue_);
        for (const V& v : v_)
            finite = hn::And(finite, hn::Lt(hn::Abs(v), infinity));
        return bitsOf(finite);
    }

    // Which ambiguous faces are joined, as bits; returns the cells that are certain.
    HWY_INLINE std::uint64_t joinFaces(std::uint64_t* joined) {
        below_ = hn::Set(d_, -std::numeric_limits<double>::infinity());
        above_ = hn::Set(d_, std::numeric_limits<double>::infinity());
        joined_ = hn::Zero(bits_);
        doubtful_ = hn::MaskFromVec(hn::Zero(d_));
        joinFace<0>();
        joinFace<1>();
        joinFace<2>();
        joinFace<3>();
        joinFace<4>();
        joinFace<5>();
        hn::Store(joined_, bits_, joined);
        return ~bitsOf(doubtful_);
    }

    HWY_INLINE void storeInterval(double* below, double* above) const {
        hn::Store(below_, d_, below);
        hn::Store(above_, d_, above);
    }

    // The cells that certainly have no tunnel; the interval is narrowed to where that lasts.
    HWY_INLINE std::uint64_t excludeTunnels() {
        findLeading();
        const M isOdd = hn::Xor(hn::Xor(isPositive_[0], isPositive_[1]), isPositive_[2]);
        const M never = hn::Or(isZero_, hn::And(isKnown_, isOdd)); // product of signs 0 or 1
        const M asked = hn::AndNot(never, isKnown_);
        if (hn::AllFalse(d_, asked))
            return bitsOf(never);
        M settled = findRootOutside(asked);
        const M left = hn::AndNot(settled, asked);
        if (!hn::AllFalse(d_, left))
            settled = hn::Or(settled, findNoHexagon(left));
        return bitsOf(hn::Or(never, settled));
    }

private:
    // The corner at place k of the lower slice across an axis, and the one of the upper slice.
    static constexpr std::size_t corner(std::size_t axis, std::size_t k, std::size_t side = 0) {
        return static_cast<std::size_t>(CellPolynomials<double>::kSlice[axis][k]) + (side << axis);
    }

    HWY_INLINE std::uint64_t bitsOf(M mask) const {
        std::uint8_t bits = 0;
        hn::StoreMaskBits(d_, mask, &bits);
        return bits & ((1u << hn::Lanes(d_)) - 1u);
    }
    HWY_INLINE M hasBit(hn::Vec<hn::RebindToUnsigned<D>> bits, unsigned bit) const {
        return hn::RebindMask(d_, hn::TestBit(bits, hn::Set(bits_, std::uint64_t{1} << bit)));
    }

    // saddleOfFace().
    template <std::size_t kFace>
    HWY_INLINE void joinFace() {
        constexpr auto c = kFaceCorners[kFace];
        const M isAmbiguous = hasBit(ambiguous_, kFace), isFirstAbove = hasBit(signs_, c[0]);
        const V p = hn::Mul(size_[c[0]], size_[c[2]]), q = hn::Mul(size_[c[1]], size_[c[3]]), size = hn::Add(p, q);
        const V difference = hn::IfThenElse(isFirstAbove, hn::Sub(p, q), hn::Sub(q, p));
        const V rate = hn::Add(hn::Add(size_[c[0]], size_[c[2]]), hn::Add(size_[c[1]], size_[c[3]]));
        const M isCertain =
            hn::And(isPlain(size), hn::Gt(hn::Abs(difference), hn::Mul(hn::Set(d_, kFaceCertain), size)));
        doubtful_ = hn::Or(doubtful_, hn::AndNot(isCertain, isAmbiguous));
        const M isJoined = hn::And(isAmbiguous, hn::Gt(difference, hn::Zero(d_)));
        joined_ = hn::Or(
            joined_, hn::IfThenElseZero(hn::RebindMask(bits_, isJoined), hn::Set(bits_, std::uint64_t{1} << kFace)));
        narrowTo(isAmbiguous, hn::Add(isovalue_, hn::Div(difference, rate)),
                 hn::Mul(hn::Set(d_, kSaddleError), hn::Add(rate, isovalueSize_)));
    }

    HWY_INLINE M isPlain(V size) const {
        return hn::And(hn::Gt(size, hn::Set(d_, kLeastSize)), hn::Lt(size, hn::Set(d_, kMostSize)));
    }

    HWY_INLINE void narrowTo(M where, V critical, V margin) {
        const V from = hn::Sub(critical, margin), to = hn::Add(critical, margin);
        const M isUp = hn::Gt(from, isovalue_), isDown = hn::AndNot(isUp, hn::Lt(to, isovalue_));
        above_ = hn::IfThenElse(hn::And(where, isUp), hn::Min(above_, from), above_);
        below_ = hn::IfThenElse(hn::And(where, isDown), hn::Max(below_, to), below_);
        const M isNear = hn::AndNot(hn::Or(isUp, isDown), where);
        const V infinity = hn::Set(d_, std::numeric_limits<double>::infinity());
        below_ = hn::IfThenElse(isNear, infinity, below_);
        above_ = hn::IfThenElse(isNear, hn::Neg(infinity), above_);
    }

    HWY_INLINE void narrowWhile(M where, V slack, V rate, V rateSize) {
        const V error = hn::Mul(hn::Set(d_, kRateError), rateSize);
        const V distance = hn::Div(hn::Mul(hn::Set(d_, kLessOfLine), slack), hn::Add(hn::Abs(rate), error));
        const V margin = marginOf(distance);
        narrowTo(hn::And(where, hn::Gt(rate, hn::Neg(error))), hn::Add(isovalue_, distance), margin);
        narrowTo(hn::And(where, hn::Lt(rate, error)), hn::Sub(isovalue_, distance), margin);
    }
    HWY_INLINE V marginOf(V distance) const {
        return hn::Mul(hn::Set(d_, kIntervalError), hn::Add(isovalueSize_, distance));
    }

    HWY_INLINE void findLeading() {
        const V zero = hn::Zero(d_);
        isZero_ = hn::MaskFromVec(zero);
        isKnown_ = hn::Eq(zero, zero);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            V s[4];
            for (std::size_t k = 0; k < 4; ++k)
                s[k] = hn::Sub(v_[corner(axis, k, 1)], v_[corner(axis, k)]);
            const V joining = hn::Mul(s[0], s[3]), parting = hn::Mul(s[1], s[2]);
            leading_[axis] = hn::Sub(joining, parting);
            leadingSize_[axis] = hn::Add(hn::Abs(joining), hn::Abs(parting));
            isPositive_[axis] = hn::Gt(leading_[axis], zero);
            const M isCertain =
                hn::And(isPlain(leadingSize_[axis]),
                        hn::Gt(hn::Abs(leading_[axis]), hn::Mul(hn::Set(d_, kLeadingCertain), leadingSize_[axis])));
            isKnown_ = hn::And(isKnown_, isCertain);
            const M isEqual = hn::Eq(joining, parting);
            if (hn::AllFalse(d_, isEqual))
                continue;
            const M isFlat =
                hn::And(hn::Or(hn::Eq(s[0], zero), hn::Eq(s[3], zero)), hn::Or(hn::Eq(s[1], zero), hn::Eq(s[2], zero)));
            isZero_ = hn::Or(isZero_, hn::And(isEqual, hn::Or(isFlat, areSmallIntegers())));
        }
    }

    HWY_INLINE M areSmallIntegers() const {
        M are = hn::Eq(isovalue_, isovalue_);
        for (const V& v : v_)
            are = hn::And(are, hn::And(hn::Le(hn::Abs(v), hn::Set(d_, kMostInteger)), hn::Eq(hn::Round(v), v)));
        return are;
    }

    // hasRootOutside().
    HWY_INLINE M findRootOutside(M asked) {
        const V certain = hn::Set(d_, kCertain);
        V slack = hn::Zero(d_), rate = slack, rateSize = slack;
        M found = hn::MaskFromVec(slack), open = asked; // no reason yet, and nothing against further ones
        const auto take = [&](M where, V itsSlack, V itsRate, V itsRateSize) HWY_ATTR {
            slack = hn::IfThenElse(where, itsSlack, slack);
            rate = hn::IfThenElse(where, itsRate, rate);
            rateSize = hn::IfThenElse(where, itsRateSize, rateSize);
            found = hn::Or(found, where);
            open = hn::AndNot(where, open);
        };
        for (std::size_t axis = 0; axis < 3; ++axis) {
            V q[2], size[2], rates[2], rateSizes[2];
            for (std::size_t side = 0; side < 2; ++side) {
                const std::size_t a = corner(axis, 0, side), b = corner(axis, 1, side), e = corner(axis, 2, side),
                                  c = corner(axis, 3, side);
                const V joining = hn::Mul(g_[a], g_[c]), parting = hn::Mul(g_[b], g_[e]);
                q[side] = hn::Sub(joining, parting);
                size[side] = hn::Add(hn::Abs(joining), hn::Abs(parting));
                rates[side] = hn::Sub(hn::Add(g_[a], g_[c]), hn::Add(g_[b], g_[e]));
                rateSizes[side] = hn::Add(hn::Add(hn::Add(size_[a], size_[b]), size_[c]), size_[e]);
                open = hn::And(open, isPlain(size[side]));
                const V wrong = hn::IfThenElse(isPositive_[axis], hn::Neg(q[side]), q[side]);
                take(hn::And(open, hn::Gt(wrong, hn::Mul(certain, size[side]))), wrong,
                     hn::IfThenElse(isPositive_[axis], hn::Neg(rates[side]), rates[side]), rateSizes[side]);
            }
            const V difference = hn::Sub(q[1], q[0]);
            const V beyond = hn::Sub(hn::Abs(difference), hn::Abs(leading_[axis]));
            const V change = hn::Sub(rates[1], rates[0]);
            take(
                hn::And(open, hn::Gt(beyond, hn::Mul(certain, hn::Add(hn::Add(size[0], size[1]), leadingSize_[axis])))),
                beyond, hn::IfThenElse(hn::Gt(difference, hn::Zero(d_)), change, hn::Neg(change)),
                hn::Add(rateSizes[0], rateSizes[1]));
        }
        narrowWhile(found, slack, rate, rateSize);
        return found;
    }

    // hasNoHexagon().
    HWY_INLINE M findNoHexagon(M asked) {
        const auto times = [&](double factor, V x) HWY_ATTR { return hn::Mul(hn::Set(d_, factor), x); };
        const V s0 = hn::Sub(v_[4], v_[0]), s1 = hn::Sub(v_[5], v_[1]), s2 = hn::Sub(v_[6], v_[2]),
                s3 = hn::Sub(v_[7], v_[3]);
        const V a = leading_[2], sizeA = leadingSize_[2];
        const V b0 = hn::Mul(g_[0], s3), b1 = hn::Mul(s0, g_[3]), b2 = hn::Mul(g_[1], s2), b3 = hn::Mul(s1, g_[2]);
        const V b = hn::Sub(hn::Add(b0, b1), hn::Add(b2, b3));
        const V sizeB = hn::Add(hn::Add(hn::Add(hn::Abs(b0), hn::Abs(b1)), hn::Abs(b2)), hn::Abs(b3));
        const V c0 = hn::Mul(g_[0], g_[3]), c1 = hn::Mul(g_[1], g_[2]), c = hn::Sub(c0, c1);
        const V sizeC = hn::Add(hn::Abs(c0), hn::Abs(c1));
        const V value = hn::Sub(hn::Mul(b, b), hn::Mul(times(4.0, a), c));
        const V size = hn::Add(hn::Mul(sizeB, sizeB), hn::Mul(times(4.0, sizeA), sizeC));
        const V depth = hn::Neg(value);
        const M found = hn::And(asked, hn::And(isPlain(size), hn::Gt(depth, times(kCertain, size))));
        const V rate = hn::Sub(hn::Add(g_[0], g_[3]), hn::Add(g_[1], g_[2]));
        const V square = hn::Sub(hn::Add(s0, s3), hn::Add(s1, s2));
        const V rateSize = hn::Add(hn::Add(hn::Add(size_[0], size_[3]), size_[1]), size_[2]);
        const V squareSize = hn::Add(hn::Add(hn::Add(hn::Abs(s0), hn::Abs(s3)), hn::Abs(s1)), hn::Abs(s2));
        const V slope = hn::Sub(hn::Mul(times(4.0, a), rate), hn::Mul(times(2.0, b), square));
        const V slopeError =
            times(kRateError, hn::Add(hn::Mul(times(4.0, sizeA), rateSize), hn::Mul(times(2.0, sizeB), squareSize)));
        const V bend = hn::Add(hn::Abs(square), times(kRateError, squareSize)), bend2 = hn::Mul(bend, bend);
        const V lift = hn::Mul(times(4.0, bend2), depth);
        const auto distance = [&](V rise) HWY_ATTR {
            const V root2 = hn::Add(hn::Mul(rise, rise), lift), root = hn::Sqrt(root2);
            const M rises = hn::Gt(rise, hn::Zero(d_));
            const V far = hn::Div(hn::IfThenElse(rises, times(-2.0, value), hn::Sub(root, rise)),
                                  hn::IfThenElse(rises, hn::Add(rise, root), times(2.0, bend2)));
            const M isSound = hn::And(hn::Gt(root2, hn::Set(d_, kLeastSquare)), hn::Lt(root2, hn::Set(d_, kMostSize)));
            return hn::IfThenElseZero(isSound, hn::Min(hn::Set(d_, kFarthest), times(kLessOfParabola, far)));
        };
        const V up = distance(hn::Add(slope, slopeError)), down = distance(hn::Sub(slopeError, slope));
        narrowTo(found, hn::Add(isovalue_, up), marginOf(up));
        narrowTo(found, hn::Sub(isovalue_, down), marginOf(down));
        return found;
    }

    D d_;
    hn::RebindToUnsigned<D> bits_;
    V isovalue_, isovalueSize_;
    V v_[8], g_[8], size_[8]; // scalars, their differences from the isovalue, and those without signs
    hn::Vec<hn::RebindToUnsigned<D>> signs_, ambiguous_, joined_;
    M doubtful_;
    V below_, above_;
    V leading_[3], leadingSize_[3];
    M isPositive_[3];
    M isKnown_, isZero_;
};

void resolveCellsHere(const UndecidedCells& cells, double isovalue, ResolvedCell* HWY_RESTRICT resolved) {
    const std::size_t together = hn::Lanes(Lanes::D());
    const FacesStates& faces = facesStates();
    for (std::size_t first = 0; first < cells.count; first += together) {
        Lanes lanes(cells, first, isovalue);
        const std::uint64_t finite = lanes.finiteCells();
        alignas(64) std::array<std::uint64_t, 8> joined;
        std::uint64_t plain = finite & lanes.joinFaces(joined.data());
        alignas(64) std::array<double, 8> below, above;
        lanes.storeInterval(below.data(), above.data());
        std::uint64_t asked = 0; // cells whose faces leave room for a tunnel
        const std::size_t count = std::min(together, cells.count - first);
        for (std::size_t i = 0; i < count; ++i) {
            const auto signs = static_cast<std::uint8_t>(cells.signs[first + i]);
            const FacesState& state = faces.of(signs, static_cast<std::uint8_t>(joined[i]));
            resolved[first + i] = {state.state, {below[i], above[i]}};
            if (state.tunnels != 0)
                asked |= std::uint64_t{1} << i;
        }
        if ((asked & plain) != 0) {
            const std::uint64_t settled = lanes.excludeTunnels();
            lanes.storeInterval(below.data(), above.data());
            for (std::uint64_t rest = asked & settled; rest != 0; rest &= rest - 1) {
                const auto i = static_cast<std::size_t>(std::countr_zero(rest));
                resolved[first + i].interval = {below[i], above[i]};
            }
            plain &= ~(asked & ~settled);
        }
        for (std::uint64_t rest = ~plain & ((std::uint64_t{1} << count) - 1); rest != 0; rest &= rest - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(rest));
            const auto signs = static_cast<std::uint8_t>(cells.signs[first + i]);
            resolved[first + i] = (finite >> i & 1) != 0 ? resolveCell(signs, cells.scalarsOf(first + i), isovalue)
                                                         : ResolvedCell{signs, {}};
        }
    }
}

} // namespace isoslider::cell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::cell {

HWY_EXPORT(resolveCellsHere);

void resolveCells(const UndecidedCells& cells, double isovalue, ResolvedCell* resolved) {
    HWY_DYNAMIC_DISPATCH(resolveCellsHere)(cells, isovalue, resolved);
}

} // namespace isoslider::cell
#endif
