#include "core/topology/analysis/forest_stream.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/base/disjoint_sets.h"

namespace isoslider::topology {

void ForestStream::count(double isovalue, std::int64_t change) {
    const auto next = std::upper_bound(isovalues_.begin(), isovalues_.end(), isovalue);
    changes_[static_cast<std::size_t>(next - isovalues_.begin())] += change;
}

ForestStream::Node ForestStream::addNode(double isovalue) {
    count(isovalue, 1);
    return nodes_++;
}

// Kruskal's algorithm: a link of two components belongs to the forest of the whole graph, too, if one of them cannot be
// linked to anything before it. Other links may yet close a ring of earlier ones.
std::vector<ForestStream::Node> ForestStream::settle(std::span<const double> opens) {
    const double sign = side_ == Side::Above ? 1.0 : -1.0;
    constexpr double kNever = -std::numeric_limits<double>::infinity();
    std::vector<double> order(nodes_); // the greater the earlier
    for (Node node = 0; node < nodes_; ++node)
        order[node] = std::isnan(opens[node]) ? kNever : sign * opens[node];
    std::sort(links_.begin(), links_.end(), [this](const OpenLink& a, const OpenLink& b) {
        return a.isovalue != b.isovalue ? comesEarlier(side_, a.isovalue, b.isovalue)
                                        : std::tie(a.a, a.b) < std::tie(b.a, b.b);
    });
    DisjointSets<Node> joined(nodes_), settled(nodes_);
    std::size_t left = 0;
    for (const OpenLink link : links_) {
        const Node a = joined.rootOf(link.a), b = joined.rootOf(link.b);
        if (a == b)
            continue;
        const bool isSettled = std::min(order[a], order[b]) < sign * link.isovalue;
        const double earliest = std::max(order[a], order[b]);
        joined.unite(a, b);
        order[std::min(a, b)] = earliest;
        if (isSettled) {
            count(link.isovalue, -1);
            settled.unite(link.a, link.b);
        } else {
            links_[left++] = link;
        }
    }
    links_.resize(left);
    std::vector<Node> numbers(nodes_, kNone), found(nodes_, kNone);
    Node next = 0;
    const auto numberOf = [&](Node node) {
        Node& number = numbers[settled.rootOf(node)];
        if (number == kNone)
            number = next++;
        return number;
    };
    for (Node node = 0; node < nodes_; ++node)
        if (!std::isnan(opens[node]))
            found[node] = numberOf(node);
    for (OpenLink& link : links_) {
        link.a = numberOf(link.a);
        link.b = numberOf(link.b);
    }
    nodes_ = next;
    return found;
}

// A component that comes where the first k isovalues are passed is above those, or below the others.
std::vector<std::int64_t> ForestStream::counts() const {
    std::vector<std::int64_t> counts(isovalues_.size());
    if (side_ == Side::Above)
        std::partial_sum(changes_.rbegin(), changes_.rend() - 1, counts.rbegin());
    else
        std::partial_sum(changes_.begin(), changes_.end() - 1, counts.begin());
    return counts;
}

std::int64_t ForestStream::lasting() const {
    return std::accumulate(changes_.begin(), changes_.end(), std::int64_t{0});
}

} // namespace isoslider::topology
