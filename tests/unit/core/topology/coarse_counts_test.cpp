// Counts without events, against those of the events that memory had no room for.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/topology/topology_analysis.h"
#include "core/topology/topology_queries.h"
#include "tests/support/result_matchers.h"

namespace isoslider::topology {
namespace {

using test::HasError;
using test::IsOk;

// Too little for events, enough for layers of seven planes.
constexpr std::uint64_t kLittleMemory = 7 << 20;

template <class Sample, class Draw>
ScalarGrid gridOf(const GridDims& dims, ScalarType type, const Draw& draw) {
    GridGeometry geometry;
    geometry.dims = dims;
    std::vector<Sample> samples;
    for (std::int64_t z = 0; z < dims[2]; ++z)
        for (std::int64_t y = 0; y < dims[1]; ++y)
            for (std::int64_t x = 0; x < dims[0]; ++x)
                samples.push_back(static_cast<Sample>(draw(x, y, z)));
    return ScalarGrid::fromValues<Sample>(geometry, type, samples);
}

void expectTheCountsOfEvents(const ScalarGrid& grid, bool areExact, std::uint64_t littleMemory = kLittleMemory) {
    AnalysisOptions options;
    options.measures = planMeasures(grid);
    for (double& share : options.measures.shares)
        share = std::min(share, 0.01); // areas are not what this is about
    const auto whole = analyseTopology(planesOf(grid), options);
    ASSERT_THAT(whole, IsOk());
    ASSERT_TRUE(whole.value().hasEvents());
    ASSERT_EQ(whole.value().areCountsExact(), areExact);
    for (const std::int64_t planes : {0, 3, 7}) {
        options.memoryBytes = littleMemory;
        options.planesAtOnce = planes;
        options.boundaryPointsAtOnce =
            planes > 0 ? static_cast<std::size_t>(planes) : AnalysisOptions().boundaryPointsAtOnce;
        const auto counts = analyseTopology(planesOf(grid), options);
        ASSERT_THAT(counts, IsOk());
        ASSERT_FALSE(counts.value().hasEvents());
        EXPECT_EQ(counts.value().areCountsExact(), areExact);
        EXPECT_EQ(counts.value().curves().measures.size(), whole.value().curves().measures.size());
        EXPECT_GT(counts.value().eventCount(), 8u);
        for (const TopologyEvent& step : counts.value().events()) {
            ASSERT_EQ(step.below, whole.value().countsAt(step.isovalue)) << step.isovalue;
            ASSERT_EQ(counts.value().countsAt(step.isovalue), step.below);
        }
        EXPECT_TRUE(counts.value().mostNotable(10).value().empty()) << "steps are no events";
        const auto suggestions = suggestIsovalues(counts.value());
        ASSERT_THAT(suggestions, IsOk());
        for (const Suggestion& suggestion : suggestions.value())
            EXPECT_TRUE(suggestion.reason == SuggestionReason::StrongestGradient ||
                        suggestion.reason == SuggestionReason::HalfVolume);
    }
}

TEST(CoarseCounts, AreThoseOfNoise) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    expectTheCountsOfEvents(
        gridOf<float>({40, 37, 90}, ScalarType::F32, [&](auto, auto, auto) { return unit(random); }), true);
}

// The boundary's planes are put together a few rows at a time.
TEST(CoarseCounts, AreThoseOfNoiseInLargePlanes) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    constexpr std::uint64_t kMemoryOfLayers = 40 << 20;
    expectTheCountsOfEvents(
        gridOf<float>({130, 110, 60}, ScalarType::F32, [&](auto, auto, auto) { return unit(random); }), true,
        kMemoryOfLayers);
}

TEST(CoarseCounts, AreThoseOfFewValues) {
    std::mt19937 random(2);
    std::uniform_int_distribution<int> integers(0, 29);
    expectTheCountsOfEvents(
        gridOf<std::uint8_t>({50, 41, 150}, ScalarType::U8, [&](auto, auto, auto) { return integers(random); }), true,
        5 << 20);
}

// Pieces that are seen to be one only many layers later, and shells around voids.
TEST(CoarseCounts, AreThoseOfNoiseOnLongShapes) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-0.6, 0.6);
    expectTheCountsOfEvents(gridOf<float>({40, 40, 120}, ScalarType::F32,
                                          [&](auto x, auto y, auto z) {
                                              const double bend = std::abs(static_cast<double>(z) - 60.0) / 5.0;
                                              const double tubes = std::cos(static_cast<double>(x) / 2.0 + bend);
                                              return tubes + std::cos(static_cast<double>(y) / 3.0) + unit(random);
                                          }),
                            true);
}

TEST(CoarseCounts, AreThoseWhereSamplesAreMissing) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    const auto grid = [&](bool hasTunnel) {
        return gridOf<float>({40, 40, 80}, ScalarType::F32, [&](auto x, auto y, auto z) {
            const bool isCut = x + y < 20, isHollow = std::hypot(x - 25, y - 25, z - 40) < 8;
            const bool isTunnel = hasTunnel && std::abs(x - 30) < 3 && std::abs(y - 20) < 3;
            return isCut || isHollow || isTunnel ? std::numeric_limits<float>::quiet_NaN() : unit(random);
        });
    };
    expectTheCountsOfEvents(grid(false), true);
    expectTheCountsOfEvents(grid(true), false);
}

TEST(CoarseCounts, AreRefusedWhereMemoryIsTooLittleForPlanes) {
    const auto grid =
        gridOf<float>({300, 300, 12}, ScalarType::F32, [](auto x, auto y, auto z) { return x * 7 % 5 + y % 3 + z; });
    AnalysisOptions options;
    options.measures = planMeasures(grid);
    options.memoryBytes = 1 << 20;
    EXPECT_THAT(analyseTopology(planesOf(grid), options), HasError(ErrorCode::OutOfSpace));
}

} // namespace
} // namespace isoslider::topology
