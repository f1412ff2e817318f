#include "core/topology/event_assembly.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <tuple>
#include <utility>

#include "core/topology/analysis/isovalue_order.h"
#include "core/topology/event_coder.h"

namespace isoslider::topology {
namespace {

// Takes changes of one kind in the order of isovalues that rise.
template <class Change>
class Ascending {
public:
    explicit Ascending(std::vector<Change>& changes) : changes_(changes) {
        const auto isLess = [](const Change& a, const Change& b) { return a.isovalue < b.isovalue; };
        if (!std::is_sorted(changes_.begin(), changes_.end(), isLess))
            IsovalueOrder().sort(changes_);
    }
    double isovalue() const {
        return at_ < changes_.size() ? changes_[at_].isovalue : std::numeric_limits<double>::infinity();
    }
    template <class Function>
    void takeAt(double isovalue, const Function& function) {
        for (; at_ < changes_.size() && changes_[at_].isovalue == isovalue; ++at_)
            function(changes_[at_]);
    }

private:
    std::vector<Change>& changes_;
    std::size_t at_ = 0;
};

// The place that an event is shown at: of a grid point rather than of a saddle, where most lasts, where most changes.
class Place {
public:
    void offer(Cause cause, double persistence, int changes) {
        const auto rank = std::tuple(cause.isVertex(), persistence, std::abs(changes));
        if (hasOne_ && rank <= rank_)
            return;
        hasOne_ = true;
        rank_ = rank;
        cause_ = cause;
    }
    void describe(const GridDims& dims, TopologyEvent& event) const {
        event.kind = cause_.isVertex()   ? EventKind::Vertex
                     : cause_.isInside() ? EventKind::BodySaddle
                                         : EventKind::FaceSaddle;
        const auto point = static_cast<std::int64_t>(cause_.point());
        const std::array<std::int64_t, 3> at{point % dims[0], point / dims[0] % dims[1], point / (dims[0] * dims[1])};
        for (std::size_t a = 0; a < 3; ++a)
            event.position[a] = static_cast<float>(at[a]) + (cause_.isVertex() ? 0.0f : 0.5f);
        if (event.kind == EventKind::FaceSaddle)
            event.position[static_cast<std::size_t>(cause_.face() / 2)] += cause_.face() % 2 == 0 ? -0.5f : 0.5f;
    }

private:
    bool hasOne_ = false;
    std::tuple<bool, double, int> rank_;
    Cause cause_;
};

struct EulerSum {
    std::int64_t euler = 0;
    EulerChange largest{};
    void add(const EulerChange& change) {
        if (euler == 0 || std::abs(change.euler()) > std::abs(largest.euler()))
            largest = change;
        euler += change.euler();
    }
};

class Assembly {
public:
    explicit Assembly(EventParts& parts)
        : euler_(parts.euler),
          above_(parts.above),
          below_(parts.below),
          reached_(parts.below.reached),
          aboveOuter_(parts.aboveOnBoundary),
          belowOuter_(parts.belowOnBoundary) {}

    /// Calls `take(event, place)` for all events, ascending. Once.
    template <class Take>
    void walk(const Take& take) {
        // Below all isovalues everything is above. Each component of the cells, and of their boundary, counts as above,
        // as below, or twice where the surface parts it.
        SurfaceCounts counts;
        for (double next = nextIsovalue(); next < std::numeric_limits<double>::infinity(); next = nextIsovalue()) {
            TopologyEvent event;
            event.isovalue = next;
            event.below = counts;
            Place place;
            takeEuler(event, counts, place);
            takePieces(event, counts, place);
            reached_.takeAt(next, [&](const ClosedChange& change) { counts.voids -= change.count; });
            takeLoops(event, counts, place);
            event.above = counts;
            if (!(event.above == event.below && event.pieces == PieceChanges()))
                take(event, place);
        }
    }

private:
    struct OneSide {
        explicit OneSide(ComponentHistory& history) : births(history.births), joins(history.joins) {}
        Ascending<ComponentChange> births, joins;
        double isovalue() const { return std::min(births.isovalue(), joins.isovalue()); }
    };

    double nextIsovalue() const {
        return std::min({euler_.isovalue(), above_.isovalue(), below_.isovalue(), reached_.isovalue(),
                         aboveOuter_.isovalue(), belowOuter_.isovalue()});
    }

    void takeEuler(const TopologyEvent& event, SurfaceCounts& counts, Place& place) {
        std::array<EulerSum, 2> sums; // at grid points, at saddles
        euler_.takeAt(event.isovalue,
                      [&](const EulerChange& change) { sums[change.cause().isVertex() ? 0 : 1].add(change); });
        for (const EulerSum& sum : sums) {
            counts.euler += sum.euler;
            if (sum.euler != 0)
                place.offer(sum.largest.cause(), 0.0, static_cast<int>(sum.largest.euler()));
        }
    }

    // What is above shrinks: its components go where they come when the isovalue falls, and are parted where they join.
    void takePieces(TopologyEvent& event, SurfaceCounts& counts, Place& place) {
        const auto takeAt = [&](Ascending<ComponentChange>& changes, std::uint32_t& pieces, int components,
                                const auto& countVoids) {
            changes.takeAt(event.isovalue, [&](const ComponentChange& change) {
                pieces += change.count;
                counts.components += components * static_cast<std::int64_t>(change.count);
                event.persistence = std::max(event.persistence, change.persistence);
                countVoids(change);
                place.offer(change.cause, change.persistence, 1);
            });
        };
        const auto noVoids = [](const ComponentChange&) {};
        takeAt(above_.joins, event.pieces.splits, 1, noVoids);
        takeAt(above_.births, event.pieces.deaths, -1, noVoids);
        // A component below is a void until it reaches the boundary, itself or as a part of one that does.
        takeAt(below_.joins, event.pieces.joins, -1,
               [&](const ComponentChange& change) { counts.voids -= change.closed; });
        takeAt(below_.births, event.pieces.births, 1,
               [&](const ComponentChange& change) { counts.voids += change.count; });
    }

    void takeLoops(const TopologyEvent& event, SurfaceCounts& counts, Place& place) {
        const auto takeAt = [&](Ascending<ComponentChange>& changes, int loops) {
            changes.takeAt(event.isovalue, [&](const ComponentChange& change) {
                counts.loops += loops * static_cast<std::int64_t>(change.count);
                place.offer(change.cause, 0.0, 1);
            });
        };
        takeAt(aboveOuter_.joins, 1);
        takeAt(aboveOuter_.births, -1);
        takeAt(belowOuter_.joins, -1);
        takeAt(belowOuter_.births, 1);
    }

    Ascending<EulerChange> euler_;
    OneSide above_, below_;
    Ascending<ClosedChange> reached_;
    OneSide aboveOuter_, belowOuter_;
};

} // namespace

EventPages assembleEvents(EventParts parts, const GridDims& dims) {
    EventCoder coder;
    Assembly(parts).walk([&](TopologyEvent& event, const Place& place) {
        place.describe(dims, event);
        coder.add(event);
    });
    return coder.take();
}

} // namespace isoslider::topology
