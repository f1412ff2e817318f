#include "core/extract/sources/leaf_finding.h"

#include <bit>
#include <cstring>

#include "core/cell/merged_cell.h"
#include "core/extract/merged/merged_interpolant.h"
#include "core/grid/scalar_type.h"

namespace isoslider::extract {
namespace {

// At least 56 bits from a place on.
std::uint64_t bitsFrom(const BitString& bits, ClosedPoint first) {
    std::uint64_t found;
    std::memcpy(&found, reinterpret_cast<const std::byte*>(bits.words.data()) + first.index() / 8, sizeof found);
    return found >> (first.number() % 8);
}

cell::MergedSigns signsOf(const BitString& above, const LeafCell& cell) {
    const int half = cell.side() / 2;
    cell::MergedSigns signs = 0;
    for (int z = 0; z < 3; ++z)
        for (int y = 0; y < 3; ++y) {
            const std::uint64_t row =
                bitsFrom(above, closedPoint(cell.origin[0], cell.origin[1] + half * y, cell.origin[2] + half * z));
            const auto three =
                static_cast<cell::MergedSigns>((row & 1) | (row >> half & 1) << 1 | (row >> 2 * half & 1) << 2);
            signs |= three << (3 * y + 9 * z);
        }
    return signs;
}

// Cells of side 2 by their first cell: whether all of their eight cells are in the string, or any.
void reduceCells(const BitString& valid, const BitString& active, UnsetBits& allValid, UnsetBits& anyActive) {
    UnsetBits validX, validXy, activeX, activeXy;
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        validX.words[w] = valid.words[w] & shiftedDown<1>(valid, i);
        activeX.words[w] = active.words[w] | shiftedDown<1>(active, i);
    }
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        validXy.words[w] = validX.words[w] & shiftedDown<9>(validX, i);
        activeXy.words[w] = activeX.words[w] | shiftedDown<9>(activeX, i);
    }
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        allValid.words[w] = validXy.words[w] & shiftedDown<81>(validXy, i);
        anyActive.words[w] = activeXy.words[w] | shiftedDown<81>(activeXy, i);
    }
}

template <class Sample>
class Finder {
public:
    Finder(const StoredSample<Sample>* samples, const BitString& above, const ActiveBits& active,
           const MergeBound& bound)
        : samples_(samples), above_(above), active_(active), bound_(bound) {}

    // REQUIRES: the halves are usable, and not all on one side.
    bool isUsable(const LeafCell& cell) const {
        return cell::keepsTopology(signsOf(above_, cell)) && isWithinBound(cell);
    }

private:
    double sampleAt(int x, int y, int z) const {
        return static_cast<double>(sampleOf<Sample>(samples_[closedPoint(x, y, z).index()]));
    }

    bool isWithinBound(const LeafCell& cell) const {
        const int side = cell.side();
        const auto [x0, y0, z0] = cell.origin;
        cell::CornerScalars corners;
        for (std::size_t c = 0; c < 8; ++c)
            corners[c] = sampleAt(x0 + (c & 1 ? side : 0), y0 + (c & 2 ? side : 0), z0 + (c & 4 ? side : 0));
        const MergedInterpolant interpolant(corners, side);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int endX = axis == 0 ? side : side + 1, endY = axis == 1 ? side : side + 1,
                      endZ = axis == 2 ? side : side + 1;
            for (int z = 0; z < endZ; ++z)
                for (int y = 0; y < endY; ++y) {
                    std::uint64_t row = bitsFrom(active_.edges[axis], closedPoint(x0, y0 + y, z0 + z)) &
                                        ((std::uint64_t{1} << endX) - 1);
                    for (; row != 0; row &= row - 1) {
                        const int x = std::countr_zero(row);
                        const double a = sampleAt(x0 + x, y0 + y, z0 + z),
                                     b = sampleAt(x0 + x + (axis == 0), y0 + y + (axis == 1), z0 + z + (axis == 2));
                        if (!interpolant.keepsWithin(bound_, {x, y, z}, axis, a, b))
                            return false;
                    }
                }
        }
        return true;
    }

    const StoredSample<Sample>* samples_;
    const BitString& above_;
    const ActiveBits& active_;
    const MergeBound& bound_;
};

} // namespace

template <class Sample>
BrickLeaves findBrickLeaves(const StoredSample<Sample>* samples, const BitString& above, const ActiveBits& active,
                            const BitString& validCells, const MergeBound& bound) {
    UnsetBits allValid, anyActive;
    reduceCells(validCells, active.cells, allValid, anyActive);
    const Finder<Sample> finder(samples, above, active, bound);
    const auto testAt = [](const UnsetBits& bits, ClosedPoint p) {
        return bits.words[p.index() >> 6] >> (p.number() & 63) & 1;
    };
    BrickLeaves leaves;
    std::uint64_t crossed = 0; // cells of side 2 with both signs
    for (int i = 0; i < 64; ++i) {
        const LeafCell cell{{2 * (i % 4), 2 * (i / 4 % 4), 2 * (i / 16)}, 1};
        const ClosedPoint first = closedPoint(cell.origin[0], cell.origin[1], cell.origin[2]);
        const bool isCrossed = testAt(anyActive, first) != 0;
        crossed |= std::uint64_t{isCrossed} << i;
        if (testAt(allValid, first) && (!isCrossed || finder.isUsable(cell)))
            leaves.level1 |= std::uint64_t{1} << i;
    }
    // Bits x + 4 y + 16 z of a half's eight parts.
    constexpr std::uint64_t kParts = 0x330033;
    for (int i = 0; i < 8; ++i) {
        const std::uint64_t parts = kParts << (2 * (i & 1) + 8 * (i >> 1 & 1) + 32 * (i >> 2));
        if ((leaves.level1 & parts) != parts)
            continue;
        const LeafCell cell{{4 * (i & 1), 4 * (i >> 1 & 1), 4 * (i >> 2)}, 2};
        if ((crossed & parts) == 0 || finder.isUsable(cell))
            leaves.level2 = static_cast<std::uint8_t>(leaves.level2 | 1u << i);
    }
    leaves.level3 = leaves.level2 == 0xff && (crossed == 0 || finder.isUsable({{0, 0, 0}, 3}));
    return leaves;
}

#define ISO_INSTANTIATE(Sample, Name) \
    template BrickLeaves findBrickLeaves<Sample>(const StoredSample<Sample>*, const BitString&, const ActiveBits&, \
                                                 const BitString&, const MergeBound&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
