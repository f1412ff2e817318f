#include "core/topology/analysis/isovalue_sums.h"

#include <array>
#include <cstdint>
#include <utility>

namespace isoslider::topology {

void sumUp(std::vector<ComponentChange>& changes) {
    std::size_t kept = 0;
    for (std::size_t first = 0, next = 0; first < changes.size(); first = next) {
        std::array<ComponentChange, 2> sums{};
        for (; next < changes.size() && changes[next].isovalue == changes[first].isovalue; ++next) {
            const ComponentChange& change = changes[next];
            ComponentChange& sum = sums[change.cause.isVertex() ? 1 : 0];
            const bool isLonger =
                change.persistence != sum.persistence ? change.persistence > sum.persistence : change.cause < sum.cause;
            if (sum.count == 0 || isLonger) {
                sum.isovalue = change.isovalue;
                sum.persistence = change.persistence;
                sum.cause = change.cause;
            }
            sum.count += change.count;
            sum.closed += change.closed;
        }
        for (const ComponentChange& sum : sums)
            if (sum.count > 0)
                changes[kept++] = sum;
    }
    changes.resize(kept);
}

void sumUp(std::vector<EulerChange>& changes) {
    struct Sum {
        std::int64_t euler = 0;
        Cause cause;
        bool isThere = false;
    };
    std::size_t kept = 0;
    for (std::size_t first = 0, next = 0; first < changes.size(); first = next) {
        std::array<Sum, 2> sums{}; // of saddles, of grid points
        const double isovalue = changes[first].isovalue;
        for (; next < changes.size() && changes[next].isovalue == isovalue; ++next) {
            const Cause cause = changes[next].cause();
            Sum& sum = sums[cause.isVertex() ? 1 : 0];
            if (!std::exchange(sum.isThere, true) || cause < sum.cause)
                sum.cause = cause;
            sum.euler += changes[next].euler();
        }
        // Parts of a large one are as many at most as came: none of these was larger than a part.
        for (Sum& sum : sums)
            while (sum.isThere) {
                const std::int64_t part = std::clamp(sum.euler, -EulerChange::kMost, EulerChange::kMost);
                changes[kept++] = {isovalue, sum.cause, part};
                sum.euler -= part;
                sum.isThere = sum.euler != 0;
            }
    }
    changes.resize(kept);
}

void sumUp(std::vector<ClosedChange>& changes) {
    std::size_t kept = 0;
    for (std::size_t next = 0; next < changes.size(); ++next)
        if (kept > 0 && changes[kept - 1].isovalue == changes[next].isovalue)
            changes[kept - 1].count += changes[next].count;
        else
            changes[kept++] = changes[next];
    changes.resize(kept);
}

Status HistorySums::add(const ComponentHistory& history) {
    lasting += history.lasting;
    ISO_TRY(births.add(history.births));
    ISO_TRY(joins.add(history.joins));
    return reached.add(history.reached);
}

std::size_t HistorySums::sizeBytes() const {
    return (births.count() + joins.count()) * sizeof(ComponentChange) + reached.count() * sizeof(ClosedChange);
}

} // namespace isoslider::topology
