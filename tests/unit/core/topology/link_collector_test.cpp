// Links that are sorted out while they come, against those sorted out in the end.

#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "core/topology/analysis/link_collector.h"

namespace isoslider::topology {
namespace {

std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> linksOf(const std::vector<Link>& links) {
    std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> all;
    for (const Link& link : links)
        all.emplace_back(link.isovalue, link.a, link.b);
    return all;
}

TEST(LinkCollector, KeepsTheSameForestWhileLinksCome) {
    constexpr std::uint32_t kSeeds = 3000, kLinks = 200'000;
    for (const Side side : {Side::Above, Side::Below})
        for (const std::uint32_t values : {7u, 100'000u}) { // with many ties, and with few
            std::mt19937 random(values);
            LinkCollector all(side), fewer(side);
            fewer.setSeeds(kSeeds);
            for (std::uint32_t i = 0; i < kLinks; ++i) {
                const std::uint32_t a = random() % kSeeds, b = random() % kSeeds;
                const double isovalue = random() % values;
                all.add(isovalue, Cause::vertex(i), a, b);
                fewer.add(isovalue, Cause::vertex(i), a, b);
            }
            std::vector<Link> links = all.take(), kept = fewer.take();
            IsovalueOrder order;
            EXPECT_GT(links.size(), kLinks / 2);
            EXPECT_LT(kept.size(), 7 * kSeeds + 2 * 4096) << "six a seed, and those looked at last";
            keepForest(side, kSeeds, links, order);
            keepForest(side, kSeeds, kept, order);
            EXPECT_EQ(links.size(), kSeeds - 1) << "so many links make one tree of it";
            EXPECT_EQ(linksOf(kept), linksOf(links));
        }
}

} // namespace
} // namespace isoslider::topology
