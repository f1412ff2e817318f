#include "core/extract/merged/leaf_levels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

#include "core/cell/merged_cell.h"
#include "core/extract/merged/merged_interpolant.h"
#include "core/extract/merged/merged_polygon.h"
#include "core/grid/classification.h"
#include "core/grid/scalar_type.h"

namespace isoslider::extract {
namespace {

using Place = std::array<std::int64_t, 3>;

enum Use : std::uint8_t { kUnusable, kUsable, kAllBelow, kAllAbove }; // the last two are usable, too

template <class Sample>
class Finder {
public:
    Finder(const SampleView<Sample>& view, double isovalue, const MergeBound& bound)
        : view_(view), isovalue_(isovalue), bound_(bound) {}

    /// Of a cell of the grid, which always is a leaf or part of one.
    Use useOfCell(const Place& at) const {
        int above = 0;
        for (int c = 0; c < 8; ++c) {
            const Sample sample = sampleAt({at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2)});
            if (isMissing(sample))
                return kUnusable; // no larger cell may hold it
            above += isAbove(sample, isovalue_);
        }
        return above == 0 ? kAllBelow : above == 8 ? kAllAbove : kUsable;
    }

    Use useOfMerged(const Place& origin, int level, const std::array<Use, 8>& halves) const {
        if (std::find(halves.begin(), halves.end(), kUnusable) != halves.end())
            return kUnusable;
        if (halves[0] != kUsable && std::all_of(halves.begin(), halves.end(), [&](Use u) { return u == halves[0]; }))
            return halves[0];
        return cell::keepsTopology(signsOf(origin, level)) && isWithinBound(origin, level) ? kUsable : kUnusable;
    }

private:
    Sample sampleAt(const Place& at) const { return view_.samples[view_.offset(at[0], at[1], at[2])]; }

    cell::MergedSigns signsOf(const Place& origin, int level) const {
        const std::int64_t half = std::int64_t{1} << (level - 1);
        cell::MergedSigns signs = 0;
        for (int p = 0; p < 27; ++p) {
            const Place at{origin[0] + half * (p % 3), origin[1] + half * (p / 3 % 3), origin[2] + half * (p / 9)};
            signs |= cell::MergedSigns{isAbove(sampleAt(at), isovalue_)} << p;
        }
        return signs;
    }

    bool isWithinBound(const Place& origin, int level) const {
        const int side = 1 << level;
        cell::CornerScalars corners;
        for (std::size_t c = 0; c < 8; ++c)
            corners[c] = static_cast<double>(sampleAt(
                {origin[0] + (c & 1 ? side : 0), origin[1] + (c & 2 ? side : 0), origin[2] + (c & 4 ? side : 0)}));
        const MergedInterpolant interpolant(corners, side);
        for (int z = 0; z <= side; ++z)
            for (int y = 0; y <= side; ++y)
                for (int x = 0; x <= side; ++x) {
                    const std::array<int, 3> from{x, y, z};
                    for (std::size_t axis = 0; axis < 3; ++axis)
                        if (from[axis] < side && !isEdgeWithinBound(interpolant, origin, from, axis))
                            return false;
                }
        return true;
    }

    bool isEdgeWithinBound(const MergedInterpolant& interpolant, const Place& origin, const std::array<int, 3>& from,
                           std::size_t axis) const {
        Place at{origin[0] + from[0], origin[1] + from[1], origin[2] + from[2]};
        const Sample a = sampleAt(at);
        ++at[axis];
        const Sample b = sampleAt(at);
        return isAbove(a, isovalue_) == isAbove(b, isovalue_) ||
               interpolant.keepsWithin(bound_, from, axis, static_cast<double>(a), static_cast<double>(b));
    }

    SampleView<Sample> view_;
    double isovalue_;
    MergeBound bound_;
};

} // namespace

template <class Sample>
LeafLevels LeafLevels::find(const SampleView<Sample>& view, double isovalue, const MergeBound& bound, int maxLevel,
                            const JobControl& job) {
    LeafLevels found;
    for (std::size_t a = 0; a < 3; ++a)
        found.cells_[a] = view.dims[a] - 1;
    found.levels_.assign(static_cast<std::size_t>(found.stride(2) * (found.cells_[2] + 2)), kNoLevel);
    found.raise({0, 0, 0}, found.cells_, 0);
    if (!(bound.limit > 0.0))
        return found;
    const Finder<Sample> finder(view, isovalue, bound);
    GridDims below = found.cells_;
    std::vector<Use> uses(static_cast<std::size_t>(pointCount(below)));
    tbb::parallel_for(std::int64_t{0}, below[2], [&](std::int64_t z) {
        if (job.isStopRequested())
            return;
        for (std::int64_t y = 0; y < below[1]; ++y)
            for (std::int64_t x = 0; x < below[0]; ++x)
                uses[static_cast<std::size_t>(x + below[0] * (y + below[1] * z))] = finder.useOfCell({x, y, z});
    });
    for (int level = 1; level <= maxLevel; ++level) {
        const GridDims dims{below[0] / 2, below[1] / 2, below[2] / 2};
        std::vector<Use> next(static_cast<std::size_t>(pointCount(dims)));
        tbb::parallel_for(std::int64_t{0}, dims[2], [&](std::int64_t z) {
            if (job.isStopRequested())
                return;
            for (std::int64_t y = 0; y < dims[1]; ++y)
                for (std::int64_t x = 0; x < dims[0]; ++x) {
                    std::array<Use, 8> halves;
                    for (int c = 0; c < 8; ++c)
                        halves[static_cast<std::size_t>(c)] = uses[static_cast<std::size_t>(
                            2 * x + (c & 1) + below[0] * (2 * y + (c >> 1 & 1) + below[1] * (2 * z + (c >> 2))))];
                    const Place origin{x << level, y << level, z << level};
                    const Use use = finder.useOfMerged(origin, level, halves);
                    next[static_cast<std::size_t>(x + dims[0] * (y + dims[1] * z))] = use;
                    if (use != kUnusable)
                        found.raise(origin, {1 << level, 1 << level, 1 << level}, level);
                }
        });
        uses = std::move(next);
        below = dims;
    }
    return found;
}

void LeafLevels::raise(const std::array<std::int64_t, 3>& origin, const GridDims& sides, int level) {
    for (std::int64_t z = 0; z < sides[2]; ++z)
        for (std::int64_t y = 0; y < sides[1]; ++y)
            std::fill_n(levels_.begin() + placeOf(origin[0], origin[1] + y, origin[2] + z), sides[0],
                        static_cast<std::int8_t>(level));
}

#define ISO_INSTANTIATE(Sample, Name) \
    template LeafLevels LeafLevels::find(const SampleView<Sample>&, double, const MergeBound&, int, const JobControl&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
