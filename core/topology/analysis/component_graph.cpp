#include "core/topology/analysis/component_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/base/disjoint_sets.h"
#include "core/topology/analysis/isovalue_sums.h"

namespace isoslider::topology {
namespace {

constexpr double kNoIsovalue = std::numeric_limits<double>::quiet_NaN();

bool hasCome(Side side, double isovalue, double now) {
    return !std::isnan(isovalue) && !comesEarlier(side, now, isovalue);
}

} // namespace

// Kruskal's algorithm.
void keepForest(Side side, std::size_t seeds, std::vector<Link>& links, IsovalueOrder& order) {
    if (side == Side::Above)
        std::reverse(links.begin(), links.end()); // of equal isovalues the first is met first
    const std::span<const std::uint32_t> places = order.of(links);
    DisjointSets<> sets(seeds);
    std::vector<char> isKept(links.size(), 0);
    const auto meet = [&](std::uint32_t place) {
        const auto a = sets.rootOf(links[place].a), b = sets.rootOf(links[place].b);
        if (a == b)
            return;
        sets.attach(std::max(a, b), std::min(a, b));
        isKept[place] = 1;
    };
    if (side == Side::Above)
        std::for_each(places.rbegin(), places.rend(), meet);
    else
        std::for_each(places.begin(), places.end(), meet);
    std::size_t count = 0;
    for (std::size_t i = 0; i < links.size(); ++i)
        if (isKept[i] != 0)
            links[count++] = links[i];
    links.resize(count);
    if (side == Side::Above)
        std::reverse(links.begin(), links.end());
}

void ComponentHistory::add(const ComponentHistory& other) {
    births.insert(births.end(), other.births.begin(), other.births.end());
    joins.insert(joins.end(), other.joins.begin(), other.joins.end());
    reached.insert(reached.end(), other.reached.begin(), other.reached.end());
    lasting += other.lasting;
}

std::vector<std::uint32_t> settleComponents(ComponentGraph& graph, std::vector<double>& opens,
                                            ComponentHistory& history, IsovalueOrder& order) {
    const Side side = graph.side;
    auto& seeds = graph.seeds;
    auto& links = graph.links;
    const auto isElder = [&](std::uint32_t a, std::uint32_t b) {
        return seeds[a].isovalue != seeds[b].isovalue ? comesEarlier(side, seeds[a].isovalue, seeds[b].isovalue)
                                                      : seeds[a].point < seeds[b].point;
    };
    ComponentHistory found;
    // `younger` has come and gone.
    const auto settle = [&](const Link& link, std::uint32_t younger, std::uint32_t elder) {
        const Seed& of = seeds[younger];
        const double persistence = std::min(std::abs(of.isovalue - link.isovalue),
                                            std::numeric_limits<double>::max()); // of doubles from end to end
        const bool isClosed = !hasCome(side, of.reachesBoundary, link.isovalue);
        if (persistence > 0.0) {
            found.births.push_back({of.isovalue, persistence, Cause::vertex(of.point), 1, 0});
            found.joins.push_back({link.isovalue, persistence, link.cause, 1, isClosed ? 1u : 0u});
            if (!isClosed)
                found.reached.push_back({of.reachesBoundary, 1});
        }
        seeds[elder].reachesBoundary =
            earlier(side, seeds[elder].reachesBoundary, isClosed ? of.reachesBoundary : link.isovalue);
    };

    DisjointSets<> sets(seeds.size()); // the root is the eldest
    constexpr std::uint32_t kStays = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> into(seeds.size(), kStays);
    std::vector<Link> left;
    const auto meet = [&](std::uint32_t place) {
        const Link& link = links[place];
        std::uint32_t elder = sets.rootOf(link.a), younger = sets.rootOf(link.b);
        if (elder == younger)
            return;
        if (isElder(younger, elder))
            std::swap(elder, younger);
        sets.attach(younger, elder);
        if (hasCome(side, opens[younger], link.isovalue)) { // an elder one may be in it
            left.push_back({link.isovalue, link.cause, elder, younger});
        } else {
            settle(link, younger, elder);
            into[younger] = elder;
        }
        opens[elder] = earlier(side, opens[elder], opens[younger]);
    };
    // Links lie far apart in this order.
    const std::span<const std::uint32_t> places = order.of(links);
    constexpr std::size_t kAhead = 12;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto at = [&](std::size_t k) { return side == Side::Above ? places[places.size() - 1 - k] : places[k]; };
        if (i + kAhead < places.size())
            __builtin_prefetch(&links[at(i + kAhead)]);
        meet(at(i));
    }
    links.assign(left.begin(), left.end());

    // Seeds that stay are numbered again. A seed that is settled became part of an elder one.
    std::vector<std::uint32_t> numbers(seeds.size());
    std::uint32_t count = 0;
    for (std::uint32_t seed = 0; seed < seeds.size(); ++seed)
        if (into[seed] == kStays)
            numbers[seed] = count++;
    const auto staying = [&](std::uint32_t seed) {
        while (into[seed] != kStays) {
            if (into[into[seed]] != kStays)
                into[seed] = into[into[seed]];
            seed = into[seed];
        }
        return seed;
    };
    for (std::uint32_t seed = 0; seed < seeds.size(); ++seed)
        if (into[seed] != kStays)
            numbers[seed] = numbers[staying(seed)];
    for (Link& link : links) {
        link.a = numbers[link.a];
        link.b = numbers[link.b];
    }
    for (std::uint32_t seed = 0; seed < seeds.size(); ++seed)
        if (into[seed] == kStays) {
            seeds[numbers[seed]] = seeds[seed];
            opens[numbers[seed]] = opens[seed];
        }
    seeds.resize(count);
    opens.resize(count);

    order.sort(found.births);
    sumUp(found.births);
    sumUp(found.joins);
    history.add(found);
    return numbers;
}

void finishComponents(ComponentGraph graph, double span, ComponentHistory& history) {
    std::vector<double> opens(graph.seeds.size(), kNoIsovalue);
    IsovalueOrder order;
    settleComponents(graph, opens, history, order);
    for (const Seed& seed : graph.seeds) {
        ++history.lasting;
        if (!(span > 0.0))
            continue; // all samples are equal
        history.births.push_back({seed.isovalue, span, Cause::vertex(seed.point), 1, 0});
        if (!std::isnan(seed.reachesBoundary))
            history.reached.push_back({seed.reachesBoundary, 1});
    }
    order.sort(history.births);
}

} // namespace isoslider::topology
