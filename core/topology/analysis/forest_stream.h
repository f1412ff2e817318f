#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/topology/analysis/component_graph.h"

namespace isoslider::topology {

/// How many components one side has at given isovalues, of a graph that comes in parts. What later parts cannot change
/// is counted and dropped: what is left are components that later parts may link, each with a node.
class ForestStream {
public:
    using Node = std::uint32_t;
    static constexpr Node kNone = ~Node{0};

    /// `isovalues` ascend, and outlive it.
    ForestStream(Side side, const std::vector<double>& isovalues) : side_(side), isovalues_(isovalues) {
        changes_.resize(isovalues.size() + 1);
    }

    /// A component that comes at an isovalue.
    Node addNode(double isovalue);
    /// A node that is no component: what it is linked to no longer counts.
    Node addUncounted() { return nodes_++; }
    void addLink(double isovalue, Node a, Node b) { links_.push_back({isovalue, a, b}); }
    /// By node: the earliest isovalue at which later links may come to it; NaN: never. All in between is settled.
    /// Returns each node's new number; kNone where none comes again.
    /// O(n log n) in nodes and links.
    std::vector<Node> settle(std::span<const double> opens);

    Node nodes() const { return nodes_; }
    std::uint64_t sizeBytes() const { return links_.capacity() * sizeof(links_[0]) + nodes_ * sizeof(double); }
    /// Of all that is settled: components at each isovalue; and in the end.
    std::vector<std::int64_t> counts() const;
    std::int64_t lasting() const;

private:
    struct OpenLink {
        double isovalue;
        Node a, b;
    };
    void count(double isovalue, std::int64_t change);

    Side side_;
    const std::vector<double>& isovalues_;
    Node nodes_ = 0;
    std::vector<OpenLink> links_;
    std::vector<std::int64_t> changes_; ///< [k]: where the isovalue passes the first k isovalues, not the next
};

} // namespace isoslider::topology
