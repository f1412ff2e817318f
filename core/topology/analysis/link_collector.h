#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/topology/analysis/component_graph.h"

namespace isoslider::topology {

/// Gathers links. The boundary between two seeds' points is long in smooth data, and only its earliest link matters, of
/// equal isovalues the one met first: of links between the same seeds that come one after the other, nearly all
/// are dropped at once. What is left of noise is many times the links that matter: these are sorted out while they
/// come, where the number of seeds is known.
class LinkCollector {
public:
    explicit LinkCollector(Side side) : side_(side), recent_(kRecent) {}

    void add(double isovalue, Cause cause, std::uint32_t a, std::uint32_t b) {
        if (a == b)
            return;
        if (a > b)
            std::swap(a, b);
        Link& recent = recent_[(a * 0x9e3779b1u ^ b * 0x85ebca6bu) >> (32 - kRecentBits)];
        if (recent.a == a && recent.b == b) {
            if (comesEarlier(side_, isovalue, recent.isovalue) ||
                (isovalue == recent.isovalue && isMetFirst(side_, cause, recent.cause)))
                recent = {isovalue, cause, a, b};
            return;
        }
        if (recent.a != recent.b) {
            if (links_.size() >= most_)
                keepForest(side_, seeds_, links_, order_); // a sixth of them at most
            links_.push_back(recent);
        }
        recent = {isovalue, cause, a, b};
    }
    /// From now on all links are between so many seeds.
    void setSeeds(std::size_t seeds) {
        seeds_ = seeds;
        most_ = kMostPerSeed * seeds + kRecent;
        links_.reserve(kUsualPerSeed * seeds);
    }
    std::size_t count() const { return links_.size(); }
    /// Gives away all links, and begins again without any.
    std::vector<Link> take() {
        for (Link& link : recent_)
            if (link.a != link.b)
                links_.push_back(std::exchange(link, Link{}));
        most_ = std::numeric_limits<std::size_t>::max();
        return std::exchange(links_, {});
    }
    /// Memory of links that are done with serves those to come. REQUIRES: none came since take().
    void giveMemory(std::vector<Link>& links) {
        links.clear();
        links_.swap(links);
    }
    IsovalueOrder& order() { return order_; }

private:
    static constexpr unsigned kRecentBits = 12;
    static constexpr std::size_t kRecent = std::size_t{1} << kRecentBits;
    static constexpr std::size_t kUsualPerSeed = 4, kMostPerSeed = 6; // the latter: hardly any noise has as many
    Side side_;
    std::size_t seeds_ = 0, most_ = std::numeric_limits<std::size_t>::max();
    std::vector<Link> recent_; ///< by a hash of both seeds
    std::vector<Link> links_;
    IsovalueOrder order_;
};

} // namespace isoslider::topology
