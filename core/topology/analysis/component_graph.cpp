#include "core/topology/analysis/component_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include <tbb/parallel_sort.h>

#include "core/base/disjoint_sets.h"

namespace isoslider::topology {

void keepForest(Side side, std::size_t seeds, std::vector<Link>& links) {
    using Element = DisjointSets<>::Element;
    struct Left { // a link that may still be kept, by the sets of its ends
        double order; // the greater the earlier
        Element a, b;
        std::uint32_t link;
    };
    struct Best { // of a set, by its root
        double order;
        std::uint32_t left;
    };
    constexpr Best kNone{-std::numeric_limits<double>::infinity(), std::numeric_limits<std::uint32_t>::max()};
    DisjointSets<> sets(seeds);
    std::vector<Left> left(links.size());
    for (std::size_t i = 0; i < links.size(); ++i)
        left[i] = {side == Side::Above ? links[i].isovalue : -links[i].isovalue, links[i].a, links[i].b,
                   static_cast<std::uint32_t>(i)};
    std::vector<char> isKept(links.size(), 0);
    std::vector<Best> best(seeds, kNone);
    while (!left.empty()) {
        // Links have an order of their isovalues, then of their places: so no ring of bests can come about.
        std::uint32_t count = 0;
        for (Left each : left) {
            each.a = sets.rootOf(each.a);
            each.b = sets.rootOf(each.b);
            if (each.a == each.b)
                continue;
            left[count] = each;
            for (const Element end : {each.a, each.b})
                if (each.order > best[end].order)
                    best[end] = {each.order, count};
            ++count;
        }
        left.resize(count);
        for (const Left& each : left)
            for (const Element end : {each.a, each.b}) {
                const Best chosen = std::exchange(best[end], kNone);
                if (chosen.left == kNone.left)
                    continue;
                const Element a = sets.rootOf(left[chosen.left].a), b = sets.rootOf(left[chosen.left].b);
                if (a == b)
                    continue;
                sets.attach(std::max(a, b), std::min(a, b));
                isKept[left[chosen.left].link] = 1;
            }
    }
    // In their order, so that the same ones are left when only some of them are looked at first.
    std::size_t count = 0;
    for (std::size_t i = 0; i < links.size(); ++i)
        if (isKept[i] != 0)
            links[count++] = links[i];
    links.resize(count);
}

namespace {

// Steps of one kind, in the order of isovalues met. REQUIRES: a total order, or each run would give something else.
template <class Step, class Earlier>
void order(std::vector<Step>& steps, const Earlier& isEarlier) {
    tbb::parallel_sort(steps.begin(), steps.end(), isEarlier);
}

class Follower {
public:
    Follower(ComponentGraph& graph, double span) : graph_(graph), span_(span), sets_(graph.seeds.size()) {
        if (graph.side == Side::Below)
            isClosed_.assign(graph.seeds.size(), true);
    }

    ComponentHistory run() {
        const Side side = graph_.side;
        const auto& seeds = graph_.seeds;
        order(graph_.links, [side](const Link& a, const Link& b) {
            if (a.isovalue != b.isovalue)
                return comesEarlier(side, a.isovalue, b.isovalue);
            return std::tie(a.cause, a.a, a.b) < std::tie(b.cause, b.a, b.b);
        });
        if (side == Side::Above) {
            for (const Link& link : graph_.links)
                join(link);
        } else {
            followClosed();
        }
        for (std::uint32_t seed = 0; seed < seeds.size(); ++seed)
            if (sets_.rootOf(seed) == seed) {
                if (span_ > 0.0) // else all samples are equal
                    addBirth(seed, span_);
                ++history_.lasting;
            }
        return std::move(history_);
    }

private:
    void addBirth(std::uint32_t seed, double persistence) {
        const Seed& of = graph_.seeds[seed];
        history_.births.push_back({of.isovalue, persistence, Cause::vertex(of.point)});
    }

    // Whether two sets have become one; whether one of them, or the whole, was closed.
    bool join(const Link& link) {
        std::uint32_t elder = sets_.rootOf(link.a), younger = sets_.rootOf(link.b);
        if (elder == younger)
            return false;
        const auto& seeds = graph_.seeds;
        const auto isElder = [&](std::uint32_t a, std::uint32_t b) {
            return seeds[a].isovalue != seeds[b].isovalue
                       ? comesEarlier(graph_.side, seeds[a].isovalue, seeds[b].isovalue)
                       : seeds[a].point < seeds[b].point;
        };
        if (isElder(younger, elder))
            std::swap(elder, younger);
        sets_.attach(younger, elder);
        const double persistence = std::min(std::abs(seeds[younger].isovalue - link.isovalue),
                                            std::numeric_limits<double>::max()); // of doubles from end to end
        if (persistence > 0.0) {
            addBirth(younger, persistence);
            history_.joins.push_back({link.isovalue, persistence, link.cause});
        }
        if (!isClosed_.empty()) {
            if (isClosed_[elder] || isClosed_[younger])
                --closed_; // two closed ones are one, or a closed one is open
            isClosed_[elder] = isClosed_[elder] && isClosed_[younger];
        }
        return true;
    }

    // Seeds come, components reach the boundary and join: all in one order.
    void followClosed() {
        const auto& seeds = graph_.seeds;
        std::vector<std::uint32_t> coming(seeds.size()), reaching;
        std::iota(coming.begin(), coming.end(), 0u);
        order(coming, [&](std::uint32_t a, std::uint32_t b) {
            return std::tie(seeds[a].isovalue, a) < std::tie(seeds[b].isovalue, b);
        });
        for (std::uint32_t seed = 0; seed < seeds.size(); ++seed)
            if (!std::isnan(seeds[seed].reachesBoundary))
                reaching.push_back(seed);
        order(reaching, [&](std::uint32_t a, std::uint32_t b) {
            return std::tie(seeds[a].reachesBoundary, a) < std::tie(seeds[b].reachesBoundary, b);
        });
        const auto& links = graph_.links;
        std::size_t c = 0, r = 0, l = 0;
        constexpr double kAfterAll = std::numeric_limits<double>::infinity();
        while (c < coming.size() || r < reaching.size() || l < links.size()) {
            const double now = std::min({c < coming.size() ? seeds[coming[c]].isovalue : kAfterAll,
                                         r < reaching.size() ? seeds[reaching[r]].reachesBoundary : kAfterAll,
                                         l < links.size() ? links[l].isovalue : kAfterAll});
            const std::int64_t before = closed_;
            Cause cause;
            for (; c < coming.size() && seeds[coming[c]].isovalue == now; ++c) {
                ++closed_;
                cause = Cause::vertex(seeds[coming[c]].point);
            }
            for (; r < reaching.size() && seeds[reaching[r]].reachesBoundary == now; ++r) {
                const std::uint32_t root = sets_.rootOf(reaching[r]);
                if (isClosed_[root])
                    --closed_;
                isClosed_[root] = false;
                cause = Cause::vertex(seeds[reaching[r]].point);
            }
            for (; l < links.size() && links[l].isovalue == now; ++l) {
                join(links[l]);
                cause = links[l].cause;
            }
            if (closed_ != before)
                history_.closed.push_back({now, closed_ - before, cause});
        }
    }

    ComponentGraph& graph_;
    double span_;
    DisjointSets<> sets_;
    std::vector<bool> isClosed_; ///< of roots; the side below only
    std::int64_t closed_ = 0;
    ComponentHistory history_;
};

} // namespace

ComponentHistory followComponents(ComponentGraph& graph, double span) { return Follower(graph, span).run(); }

} // namespace isoslider::topology
