#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/topology/analysis/boundary_part.h"
#include "core/topology/analysis/component_graph.h"

namespace isoslider::topology {

/// Puts one side of the boundary into a graph a few rows at a time. Each grid point is a node at first; a link waits
/// until both of its ends are there. What no waiting link leads to is settled at once, so that what is kept is as large
/// as the rim of a plane.
///
/// Of the graph:
///  Node addNode(Point, double scalar)
///  void addLink(double isovalue, const Cause&, Node a, Node b)
///  Node nodes()                                     they are numbered from 0 on
///  std::vector<Node> settle(std::vector<double>& opens)    by node: the earliest isovalue at which later links may
///                                                   come to it; NaN: never. What each node is then; of those that are
///                                                   not open, whatever
template <class Graph>
class BoundaryRows {
public:
    using Node = std::uint32_t;

    /// `pointsAtOnce`: those that are settled together.
    BoundaryRows(Side side, std::size_t pointsAtOnce, Graph graph)
        : graph_(std::move(graph)), side_(side), pointsAtOnce_(pointsAtOnce) {}

    /// In the order of layers.
    void add(const BoundaryPart& part) {
        joins_ = side_ == Side::Above ? part.above : part.below;
        std::sort(joins_.begin(), joins_.end(), [](const BoundaryJoin& a, const BoundaryJoin& b) {
            return std::min(a.points[0], a.points[1]) < std::min(b.points[0], b.points[1]);
        });
        nextEdge_ = nextJoin_ = 0;
        // The first and the last layer have a whole plane of it.
        for (std::size_t begin = 0; begin < part.points.size(); begin += pointsAtOnce_)
            addPoints(part, begin, std::min(part.points.size(), begin + pointsAtOnce_));
        for (; nextJoin_ < joins_.size(); ++nextJoin_)
            waiting_.push_back({joins_[nextJoin_].points, joins_[nextJoin_].isovalue, joins_[nextJoin_].cause, false});
    }

    Graph& graph() { return graph_; }
    const Graph& graph() const { return graph_; }

private:
    struct Place {
        Point point;
        double scalar;
        Node node;
    };
    struct Waiting { // a link, to a grid point that is not there yet
        std::array<Point, 2> points;
        double isovalue;
        Cause cause;
        bool isEdge; ///< of the grid: from the later of both scalars on
    };

    void addPoints(const BoundaryPart& part, std::size_t begin, std::size_t end) {
        const std::size_t firstPlace = places_.size();
        for (std::size_t i = begin; i < end; ++i)
            places_.push_back({part.points[i], part.scalars[i], graph_.addNode(part.points[i], part.scalars[i])});
        const Point last = part.points[end - 1];
        for (; nextJoin_ < joins_.size(); ++nextJoin_) {
            const BoundaryJoin& join = joins_[nextJoin_];
            if (std::min(join.points[0], join.points[1]) > last)
                break;
            waiting_.push_back({join.points, join.isovalue, join.cause, false});
        }
        std::erase_if(waiting_, [&](const Waiting& link) {
            if (std::max(link.points[0], link.points[1]) > last)
                return false;
            addLink(link, *find(link.points[0]), *find(link.points[1]));
            return true;
        });
        addEdges(part, firstPlace);
        settle();
    }

    // Edges come in the order of their first points; so do those along one axis in that of their second ones.
    void addEdges(const BoundaryPart& part, std::size_t firstPlace) {
        const Point last = places_.back().point;
        std::size_t first = firstPlace;
        std::array<std::size_t, 3> second{firstPlace, firstPlace, firstPlace};
        const auto advance = [this](std::size_t& at, Point to) {
            while (places_[at].point < to)
                ++at;
            return places_[at];
        };
        for (; nextEdge_ < part.edges.size() && part.edges[nextEdge_].start() <= last; ++nextEdge_) {
            const BoundaryPart::Edge edge = part.edges[nextEdge_];
            const Waiting link{{edge.start(), edge.start() + part.steps[edge.axis()]}, 0.0, Cause(), true};
            if (link.points[1] <= last)
                addLink(link, advance(first, link.points[0]), advance(second[edge.axis()], link.points[1]));
            else
                waiting_.push_back(link);
        }
    }

    void addLink(const Waiting& link, const Place& a, const Place& b) {
        const Place& later = comesEarlier(side_, a.scalar, b.scalar) ? b : a;
        if (link.isEdge)
            graph_.addLink(later.scalar, Cause::vertex(later.point), a.node, b.node);
        else
            graph_.addLink(link.isovalue, link.cause, a.node, b.node);
    }

    const Place* find(Point point) const {
        const auto at = std::lower_bound(places_.begin(), places_.end(), point,
                                         [](const Place& place, Point to) { return place.point < to; });
        return at != places_.end() && at->point == point ? &*at : nullptr;
    }

    void settle() {
        std::vector<double> opens(graph_.nodes(), std::numeric_limits<double>::quiet_NaN());
        std::vector<char> isOpen(places_.size(), 0);
        for (const Waiting& link : waiting_)
            for (const Point point : link.points)
                if (const Place* const place = find(point)) {
                    isOpen[static_cast<std::size_t>(place - places_.data())] = 1;
                    opens[place->node] = earlier(side_, opens[place->node], place->scalar);
                }
        const std::vector<Node> numbers = graph_.settle(opens);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < places_.size(); ++i)
            if (isOpen[i] != 0)
                places_[kept++] = {places_[i].point, places_[i].scalar, numbers[places_[i].node]};
        places_.resize(kept);
    }

    Graph graph_;
    Side side_;
    std::size_t pointsAtOnce_;
    std::vector<Place> places_; ///< with links that wait, and those that have just come; ascending
    std::vector<Waiting> waiting_;
    std::vector<BoundaryJoin> joins_; ///< of the part that comes, by their first points
    std::size_t nextEdge_ = 0, nextJoin_ = 0; ///< of the part
};

} // namespace isoslider::topology
