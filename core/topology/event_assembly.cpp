#include "core/topology/event_assembly.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "core/topology/event_coder.h"

namespace isoslider::topology {
namespace {

// The place that an event is shown at: of a grid point rather than of a saddle, where most lasts, where most changes;
// the first of equal ones.
class Place {
public:
    void offer(Cause cause, double persistence, std::int64_t changes) {
        const auto rank = std::tuple(cause.isVertex(), persistence, changes);
        if (hasOne_ && (rank < rank_ || (rank == rank_ && !(cause < cause_))))
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
    std::tuple<bool, double, std::int64_t> rank_;
    Cause cause_;
};

struct EulerSum {
    std::int64_t euler = 0;
    std::optional<Cause> first;
    void add(const EulerChange& change) {
        first = std::min(change.cause(), first.value_or(change.cause()));
        euler += change.euler();
    }
};

class Assembly {
public:
    explicit Assembly(EventParts parts) : parts_(std::move(parts)) {}

    /// Calls `take(event, place)` for all events, ascending. Once. Errors: those of reading changes.
    template <class Take>
    Status walk(const Take& take) {
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
            parts_.below.reached.takeAt(next, [&](const ClosedChange& change) { counts.voids -= change.count; });
            takeLoops(event, counts, place);
            event.above = counts;
            if (!(event.above == event.below && event.pieces == PieceChanges()))
                take(event, place);
        }
        ISO_TRY(parts_.euler.status());
        for (const SideChanges* side : {&parts_.above, &parts_.below, &parts_.aboveOnBoundary, &parts_.belowOnBoundary})
            for (const Status& status : {side->births.status(), side->joins.status(), side->reached.status()})
                ISO_TRY(status);
        return {};
    }

private:
    static double isovalueOf(const SideChanges& side) {
        return std::min(side.births.isovalue(), side.joins.isovalue());
    }
    double nextIsovalue() const {
        return std::min({parts_.euler.isovalue(), isovalueOf(parts_.above), isovalueOf(parts_.below),
                         parts_.below.reached.isovalue(), isovalueOf(parts_.aboveOnBoundary),
                         isovalueOf(parts_.belowOnBoundary)});
    }

    void takeEuler(const TopologyEvent& event, SurfaceCounts& counts, Place& place) {
        std::array<EulerSum, 2> sums; // at grid points, at saddles
        parts_.euler.takeAt(event.isovalue,
                            [&](const EulerChange& change) { sums[change.cause().isVertex() ? 0 : 1].add(change); });
        for (const EulerSum& sum : sums) {
            counts.euler += sum.euler;
            if (sum.euler != 0)
                place.offer(*sum.first, 0.0, std::abs(sum.euler));
        }
    }

    // What is above shrinks: its components go where they come when the isovalue falls, and are parted where they join.
    void takePieces(TopologyEvent& event, SurfaceCounts& counts, Place& place) {
        const auto takeAt = [&](SortedChanges<ComponentChange>& changes, std::uint32_t& pieces, int components,
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
        takeAt(parts_.above.joins, event.pieces.splits, 1, noVoids);
        takeAt(parts_.above.births, event.pieces.deaths, -1, noVoids);
        // A component below is a void until it reaches the boundary, itself or as a part of one that does.
        takeAt(parts_.below.joins, event.pieces.joins, -1,
               [&](const ComponentChange& change) { counts.voids -= change.closed; });
        takeAt(parts_.below.births, event.pieces.births, 1,
               [&](const ComponentChange& change) { counts.voids += change.count; });
    }

    void takeLoops(const TopologyEvent& event, SurfaceCounts& counts, Place& place) {
        const auto takeAt = [&](SortedChanges<ComponentChange>& changes, int loops) {
            changes.takeAt(event.isovalue, [&](const ComponentChange& change) {
                counts.loops += loops * static_cast<std::int64_t>(change.count);
                place.offer(change.cause, 0.0, 1);
            });
        };
        takeAt(parts_.aboveOnBoundary.joins, 1);
        takeAt(parts_.aboveOnBoundary.births, -1);
        takeAt(parts_.belowOnBoundary.joins, -1);
        takeAt(parts_.belowOnBoundary.births, 1);
    }

    EventParts parts_;
};

} // namespace

Result<EventPages> assembleEvents(EventParts parts, const GridDims& dims, EventCoder& coder) {
    ISO_TRY(Assembly(std::move(parts)).walk([&](TopologyEvent& event, const Place& place) {
        place.describe(dims, event);
        coder.add(event);
    }));
    return coder.take();
}

} // namespace isoslider::topology
