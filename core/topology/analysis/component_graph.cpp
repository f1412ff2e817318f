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

// Places of links in the order in which they are met.
std::span<const std::uint32_t> meetingOrder(Side side, const std::vector<Link>& links, IsovalueOrder& order) {
    const std::span<std::uint32_t> places = order.of(links, side == Side::Above);
    const auto isBefore = [&](std::uint32_t a, std::uint32_t b) {
        return isMetFirst(side, links[a].cause, links[b].cause);
    };
    for (auto begin = places.begin(); begin != places.end();) {
        const double isovalue = links[*begin].isovalue;
        auto end = begin + 1;
        bool ascend = true;
        for (; end != places.end() && links[*end].isovalue == isovalue; ++end)
            ascend = ascend && !isBefore(*end, end[-1]);
        if (!ascend)
            std::sort(begin, end, isBefore);
        begin = end;
    }
    return places;
}

} // namespace

// Kruskal's algorithm.
void keepForest(Side side, std::size_t seeds, std::vector<Link>& links, IsovalueOrder& order) {
    DisjointSets<> sets(seeds);
    std::vector<char> isKept(links.size(), 0);
    for (const std::uint32_t place : meetingOrder(side, links, order)) {
        const auto a = sets.rootOf(links[place].a), b = sets.rootOf(links[place].b);
        if (a == b)
            continue;
        sets.attach(std::max(a, b), std::min(a, b));
        isKept[place] = 1;
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < links.size(); ++i)
        if (isKept[i] != 0)
            links[count++] = links[i];
    links.resize(count);
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
        // Of equal samples in the order in which one leads to the other within a strip.
        return seeds[a].isovalue != seeds[b].isovalue ? comesEarlier(side, seeds[a].isovalue, seeds[b].isovalue)
               : side == Side::Above                  ? seeds[a].point > seeds[b].point
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
    const std::span<const std::uint32_t> places = meetingOrder(side, links, order);
    constexpr std::size_t kAhead = 12;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (i + kAhead < places.size())
            __builtin_prefetch(&links[places[i + kAhead]]);
        meet(places[i]);
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
