#include "core/topology/topology_curve.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "core/grid/classification.h"
#include "core/grid/gradient.h"
#include "core/topology/cell_saddles.h"
#include "core/topology/disjoint_sets.h"

namespace isoslider::topology {
namespace {

using Point = std::uint32_t;

/// Two grid points joined without an edge of the grid between them.
struct Join {
    double isovalue;
    Point a, b;
    bool isOnBoundary;
};
struct Saddle {
    double isovalue;
    std::int32_t euler;
    Point cell;
    std::int8_t face;
};
/// What one kind of sweep finds to change when the isovalue rises beyond `isovalue`.
struct Change {
    double isovalue = 0.0;
    std::int64_t components = 0, boundary = 0, voids = 0, euler = 0;
    bool isAtSample = false;
    Point place = 0;
    std::int8_t face = -1;
    double persistence = 0.0;

    bool isNone() const { return components == 0 && boundary == 0 && voids == 0 && euler == 0; }
};

template <class Sample>
class Analysis {
public:
    Analysis(const ScalarGrid& grid, const JobControl& job)
        : view_{grid.values<Sample>().data(), grid.dims()}, job_(job) {
        for (int a = 0; a < 3; ++a)
            stride_[static_cast<std::size_t>(a)] =
                a == 0 ? 1 : stride_[static_cast<std::size_t>(a - 1)] * view_.dims[a - 1];
        count_ = static_cast<std::size_t>(stride_[2] * view_.dims[2]);
    }

    Result<std::vector<TopologyEvent>> run() {
        if (std::min({view_.dims[0], view_.dims[1], view_.dims[2]}) < 2)
            return std::vector<TopologyEvent>(); // no cells, no surface
        for (std::size_t i = 0; i < count_; ++i)
            if (isMissing(view_.samples[i]))
                return makeError(ErrorCode::InvalidArgument, "topology of volumes with missing values is not analysed");
        findLocal();
        if (job_.isStopRequested())
            return cancelledError();
        job_.report(0.4, "sorting");
        sort();
        job_.report(0.6, "joining");
        const std::vector<Change> rising = sweepUp(), falling = sweepDown();
        if (job_.isStopRequested())
            return cancelledError();
        return assemble(rising, falling);
    }

private:
    double scalarAt(Point p) const { return static_cast<double>(view_.samples[p]); }
    std::array<std::int64_t, 3> coordsOf(Point p) const {
        return {p % view_.dims[0], p / stride_[1] % view_.dims[1], p / stride_[2]};
    }
    bool isOnBoundary(Point p) const {
        const auto c = coordsOf(p);
        for (std::size_t a = 0; a < 3; ++a)
            if (c[a] == 0 || c[a] + 1 == view_.dims[static_cast<int>(a)])
                return true;
        return false;
    }
    // Whether an edge of the grid lies in the boundary.
    bool isBoundaryEdge(const std::array<std::int64_t, 3>& start, std::size_t axis) const {
        for (std::size_t a = 0; a < 3; ++a)
            if (a != axis && (start[a] == 0 || start[a] + 1 == view_.dims[static_cast<int>(a)]))
                return true;
        return false;
    }

    // ---- what is local: the Euler number, joins, saddles

    struct Layer {
        std::vector<Join> above, below;
        std::vector<Saddle> saddles;
    };

    void findLocal() {
        euler_.assign(count_, 0);
        std::vector<Layer> layers(static_cast<std::size_t>(view_.dims[2]));
        // Layers of cells touch two planes: every other one at a time.
        for (std::int64_t parity = 0; parity < 2; ++parity)
            tbb::parallel_for(std::int64_t{0}, (view_.dims[2] + 1 - parity) / 2, [&](std::int64_t half) {
                const std::int64_t z = 2 * half + parity;
                if (!job_.isStopRequested())
                    findInLayer(z, layers[static_cast<std::size_t>(z)]);
            });
        for (Layer& layer : layers) {
            above_.insert(above_.end(), layer.above.begin(), layer.above.end());
            below_.insert(below_.end(), layer.below.begin(), layer.below.end());
            saddles_.insert(saddles_.end(), layer.saddles.begin(), layer.saddles.end());
            layer = {};
        }
    }

    void findInLayer(std::int64_t z, Layer& layer) {
        CellHistory history;
        std::array<std::int64_t, 3> at{0, 0, z};
        for (at[1] = 0; at[1] < view_.dims[1]; ++at[1])
            for (at[0] = 0; at[0] < view_.dims[0]; ++at[0]) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    addEdge(at, axis);
                    addFace(at, axis);
                }
                if (at[0] + 1 < view_.dims[0] && at[1] + 1 < view_.dims[1] && z + 1 < view_.dims[2])
                    addCell(at, history, layer);
            }
    }

    Point pointAt(const std::array<std::int64_t, 3>& at) const {
        return static_cast<Point>(at[0] + stride_[1] * at[1] + stride_[2] * at[2]);
    }

    // A vertex of the surface while just one end is above.
    void addEdge(const std::array<std::int64_t, 3>& at, std::size_t axis) {
        if (at[axis] + 1 >= view_.dims[static_cast<int>(axis)])
            return;
        const Point a = pointAt(at), b = a + static_cast<Point>(stride_[axis]);
        const bool isRising = view_.samples[a] < view_.samples[b];
        euler_[isRising ? a : b] += 1;
        euler_[isRising ? b : a] -= 1;
    }

    // Half as many segments as there are changes of sign round the face, however its corners are joined.
    void addFace(const std::array<std::int64_t, 3>& at, std::size_t axis) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        if (at[u] + 1 >= view_.dims[static_cast<int>(u)] || at[v] + 1 >= view_.dims[static_cast<int>(v)])
            return;
        const Point a = pointAt(at), du = static_cast<Point>(stride_[u]), dv = static_cast<Point>(stride_[v]);
        const std::array<Point, 4> round{a, a + du, a + du + dv, a + dv};
        std::array<std::uint8_t, 4> order{0, 1, 2, 3};
        std::sort(order.begin(), order.end(),
                  [&](std::uint8_t i, std::uint8_t j) { return view_.samples[round[i]] < view_.samples[round[j]]; });
        unsigned signs = 15;
        int segments = 0;
        for (const std::uint8_t i : order) {
            signs &= ~(1u << i);
            const unsigned turned = (signs << 1 | signs >> 3) & 15;
            const int now = std::popcount(signs ^ turned) / 2;
            euler_[round[i]] -= static_cast<std::int32_t>(now - segments);
            segments = now;
        }
    }

    void addCell(const std::array<std::int64_t, 3>& at, CellHistory& history, Layer& layer) {
        const Point first = pointAt(at);
        std::array<Point, 8> corners{};
        cell::CornerScalars scalars{};
        for (std::size_t c = 0; c < 8; ++c) {
            corners[c] = first + static_cast<Point>((c & 1) + (c >> 1 & 1) * static_cast<std::size_t>(stride_[1]) +
                                                    (c >> 2) * static_cast<std::size_t>(stride_[2]));
            scalars[c] = scalarAt(corners[c]);
        }
        history.find(scalars);
        for (std::size_t c = 0; c < 8; ++c)
            euler_[corners[c]] += history.eulerAtCorners()[c];
        for (const CellSaddle& saddle : history.saddles())
            layer.saddles.push_back({saddle.isovalue, saddle.euler, first, saddle.face});
        for (const CellJoin& join : history.joins())
            (join.isOfAbove ? layer.above : layer.below)
                .push_back({join.isovalue, corners[join.corners[0]], corners[join.corners[1]],
                            join.face >= 0 && isBoundaryFace(at, join.face)});
    }

    bool isBoundaryFace(const std::array<std::int64_t, 3>& cell, std::int8_t face) const {
        const auto axis = static_cast<std::size_t>(face / 2);
        return face % 2 == 0 ? cell[axis] == 0 : cell[axis] + 2 == view_.dims[static_cast<int>(axis)];
    }

    void sort() {
        order_.resize(count_);
        std::iota(order_.begin(), order_.end(), Point{0});
        tbb::parallel_sort(order_.begin(), order_.end(), [this](Point a, Point b) {
            return view_.samples[a] < view_.samples[b] || (view_.samples[a] == view_.samples[b] && a < b);
        });
        const auto earlier = [](const auto& a, const auto& b) { return a.isovalue < b.isovalue; };
        tbb::parallel_sort(above_.begin(), above_.end(), earlier);
        tbb::parallel_sort(below_.begin(), below_.end(), earlier);
        tbb::parallel_sort(saddles_.begin(), saddles_.end(), earlier);
    }

    // ---- sweeps

    // One side of the surface while it grows: its components in the box, on the boundary, and off it.
    class Side {
    public:
        explicit Side(const Analysis& of) : of_(of), inside_(of.count_), boundary_(of.count_) {}

        void add(Point p) {
            const auto at = of_.coordsOf(p);
            const bool isOuter = of_.isOnBoundary(p);
            inside_.add(p, isOuter);
            if (isOuter)
                boundary_.add(p, true);
            for (std::size_t axis = 0; axis < 3; ++axis)
                for (const int step : {-1, 1}) {
                    if (at[axis] + step < 0 || at[axis] + step >= of_.view_.dims[static_cast<int>(axis)])
                        continue;
                    const auto q = static_cast<Point>(p + step * of_.stride_[axis]);
                    if (!inside_.has(q))
                        continue;
                    note(inside_.join(p, q));
                    auto start = at;
                    start[axis] += std::min(step, 0);
                    if (of_.isBoundaryEdge(start, axis))
                        boundary_.join(p, q);
                }
        }
        void add(const Join& join) {
            note(inside_.join(join.a, join.b));
            if (join.isOnBoundary)
                boundary_.join(join.a, join.b);
        }
        std::int64_t components() const { return inside_.sets(); }
        std::int64_t closed() const { return inside_.unmarkedSets(); }
        std::int64_t onBoundary() const { return boundary_.sets(); }
        /// First points of the components that have become parts of elder ones since the last call.
        std::span<const Point> takeJoined() {
            taken_.swap(joined_);
            joined_.clear();
            return taken_;
        }

    private:
        void note(std::optional<Point> younger) {
            if (younger)
                joined_.push_back(*younger);
        }

        const Analysis& of_;
        DisjointSets inside_, boundary_;
        std::vector<Point> joined_, taken_;
    };

    /// Where a component comes, and how long it lasts.
    struct Life {
        double birth, persistence;
    };
    void addJoined(Side& side, double now, Change& change, std::vector<Life>& lives) const {
        for (const Point first : side.takeJoined()) {
            const Life life{scalarAt(first), std::abs(scalarAt(first) - now)};
            change.persistence = std::max(change.persistence, life.persistence);
            if (life.persistence > 0.0)
                lives.push_back(life);
        }
    }
    // `changes` ascend. The first component of all lasts through all values.
    void addLives(std::vector<Change>& changes, const std::vector<Life>& lives, double first) const {
        const auto note = [&](double isovalue, double persistence) {
            const auto at = std::lower_bound(changes.begin(), changes.end(), isovalue,
                                             [](const Change& c, double v) { return c.isovalue < v; });
            if (at != changes.end() && at->isovalue == isovalue)
                at->persistence = std::max(at->persistence, persistence);
        };
        for (const Life& life : lives)
            note(life.birth, life.persistence);
        note(first, scalarAt(order_.back()) - scalarAt(order_.front()));
    }

    // Isovalues rise: what is below grows, at each beyond it.
    std::vector<Change> sweepUp() const {
        std::vector<Change> changes;
        std::vector<Life> lives;
        Side side(*this);
        std::size_t point = 0, join = 0, saddle = 0;
        while (point < count_ || join < below_.size() || saddle < saddles_.size()) {
            constexpr double kNone = std::numeric_limits<double>::infinity();
            const double now = std::min({point < count_ ? scalarAt(order_[point]) : kNone,
                                         join < below_.size() ? below_[join].isovalue : kNone,
                                         saddle < saddles_.size() ? saddles_[saddle].isovalue : kNone});
            Change change;
            change.isovalue = now;
            const std::int64_t components = side.components(), boundary = side.onBoundary(), voids = side.closed();
            std::int32_t largest = 0;
            for (; saddle < saddles_.size() && saddles_[saddle].isovalue == now; ++saddle) {
                change.euler += saddles_[saddle].euler;
                change.place = saddles_[saddle].cell;
                change.face = saddles_[saddle].face;
            }
            for (; point < count_ && scalarAt(order_[point]) == now; ++point) {
                const Point p = order_[point];
                change.euler += euler_[p];
                if (!change.isAtSample || std::abs(euler_[p]) > largest) { // the place that most is due to
                    change.place = p;
                    largest = std::abs(euler_[p]);
                }
                change.isAtSample = true;
                side.add(p);
            }
            for (; join < below_.size() && below_[join].isovalue == now; ++join)
                side.add(below_[join]);
            addJoined(side, now, change, lives);
            change.components = side.components() - components;
            change.boundary = side.onBoundary() - boundary;
            change.voids = side.closed() - voids;
            if (!change.isNone())
                changes.push_back(change);
        }
        addLives(changes, lives, scalarAt(order_.front()));
        return changes;
    }

    // Isovalues fall: what is above grows, at each of them.
    std::vector<Change> sweepDown() const {
        std::vector<Change> changes;
        std::vector<Life> lives;
        Side side(*this);
        std::size_t point = count_, join = above_.size();
        while (point > 0 || join > 0) {
            constexpr double kNone = -std::numeric_limits<double>::infinity();
            const double now =
                std::max(point > 0 ? scalarAt(order_[point - 1]) : kNone, join > 0 ? above_[join - 1].isovalue : kNone);
            Change change;
            change.isovalue = now;
            const std::int64_t components = side.components(), boundary = side.onBoundary();
            for (; point > 0 && scalarAt(order_[point - 1]) == now; --point) {
                change.place = order_[point - 1];
                change.isAtSample = true;
                side.add(order_[point - 1]);
            }
            for (; join > 0 && above_[join - 1].isovalue == now; --join) {
                if (!change.isAtSample)
                    change.place = above_[join - 1].a;
                side.add(above_[join - 1]);
            }
            addJoined(side, now, change, lives);
            change.components = components - side.components(); // as it rises
            change.boundary = boundary - side.onBoundary();
            if (!change.isNone())
                changes.push_back(change);
        }
        std::reverse(changes.begin(), changes.end());
        addLives(changes, lives, scalarAt(order_.back()));
        return changes;
    }

    std::vector<TopologyEvent> assemble(const std::vector<Change>& rising, const std::vector<Change>& falling) const {
        std::vector<TopologyEvent> events;
        // Below all values, everything is above: one component, with one on the boundary.
        std::int64_t above = 1, aboveOnBoundary = 1, below = 0, belowOnBoundary = 0, voids = 0, euler = 0;
        const auto counts = [&] {
            SurfaceCounts now;
            if (above > 0 && below > 0)
                now.components = above + below - 1;
            if (aboveOnBoundary > 0 && belowOnBoundary > 0)
                now.loops = aboveOnBoundary + belowOnBoundary - 1;
            now.euler = euler;
            now.voids = voids;
            return now;
        };
        std::size_t up = 0, down = 0;
        while (up < rising.size() || down < falling.size()) {
            TopologyEvent event;
            event.below = counts();
            const bool isUp =
                up < rising.size() && (down == falling.size() || rising[up].isovalue <= falling[down].isovalue);
            const Change& change = isUp ? rising[up] : falling[down];
            event.isovalue = change.isovalue;
            describe(change, event);
            event.persistence = change.persistence;
            if (isUp) {
                below += change.components;
                belowOnBoundary += change.boundary;
                voids += change.voids;
                euler += change.euler;
                ++up;
            }
            if (down < falling.size() && falling[down].isovalue == event.isovalue) {
                event.persistence = std::max(event.persistence, falling[down].persistence);
                above += falling[down].components;
                aboveOnBoundary += falling[down].boundary;
                ++down;
            }
            event.above = counts();
            if (!(event.above == event.below))
                events.push_back(event);
        }
        return events;
    }

    void describe(const Change& change, TopologyEvent& event) const {
        const auto at = coordsOf(change.place);
        event.kind = change.isAtSample  ? EventKind::Vertex
                     : change.face >= 0 ? EventKind::FaceSaddle
                                        : EventKind::BodySaddle;
        for (std::size_t a = 0; a < 3; ++a)
            event.position[a] = static_cast<float>(at[a]) + (change.isAtSample ? 0.0f : 0.5f);
        if (event.kind == EventKind::FaceSaddle)
            event.position[static_cast<std::size_t>(change.face / 2)] += change.face % 2 == 0 ? -0.5f : 0.5f;
    }

    SampleView<Sample> view_;
    const JobControl& job_;
    std::array<std::int64_t, 3> stride_{};
    std::size_t count_ = 0;
    std::vector<std::int32_t> euler_; ///< by sample: what changes when the isovalue rises beyond it
    std::vector<Join> above_, below_;
    std::vector<Saddle> saddles_;
    std::vector<Point> order_;
};

} // namespace

Result<TopologyCurve> TopologyCurve::analyse(const ScalarGrid& grid, const JobControl& job) {
    if (static_cast<std::uint64_t>(pointCount(grid.dims())) >= std::numeric_limits<Point>::max())
        return makeError(ErrorCode::InvalidArgument, "topology of 2^32 samples or more is not analysed");
    return visitScalarType(grid.type(), [&](auto sample) -> Result<TopologyCurve> {
        auto events = Analysis<decltype(sample)>(grid, job).run();
        if (!events.isOk())
            return std::move(events).error();
        return TopologyCurve(std::move(events).value(), {});
    });
}

SurfaceCounts TopologyCurve::countsAt(double isovalue) const {
    const auto next = std::lower_bound(events_.begin(), events_.end(), isovalue,
                                       [](const TopologyEvent& event, double at) { return event.isovalue < at; });
    if (next != events_.end())
        return next->below;
    return events_.empty() ? SurfaceCounts() : events_.back().above;
}

Status TopologyCurve::visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const {
    for (const TopologyEvent& event : events_)
        if (!visit(event))
            break;
    return {};
}

} // namespace isoslider::topology
