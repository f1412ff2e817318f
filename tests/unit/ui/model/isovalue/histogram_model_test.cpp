#include "ui/model/isovalue/histogram_model.h"

#include <numeric>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

Histogram histogramOf(double min, double max, std::vector<std::uint64_t> counts) {
    return {min, max, std::move(counts)};
}

/// A peak of `count` samples around a bin.
void addPeak(std::vector<std::uint64_t>& counts, std::size_t centre, std::uint64_t count) {
    for (std::size_t bin = centre - 4; bin <= centre + 4; ++bin)
        counts[bin] += count;
}

TEST(SuggestIsovalue, PartsTwoPeaks) {
    std::vector<std::uint64_t> counts(100, 0);
    addPeak(counts, 20, 1000);
    addPeak(counts, 80, 1000);
    EXPECT_NEAR(suggestIsovalue(histogramOf(0.0, 100.0, counts)), 50.0, 1.0);
}

TEST(SuggestIsovalue, LeavesAHugeBackgroundPeak) {
    std::vector<std::uint64_t> counts(256, 0);
    counts[0] = 10'000'000;
    for (std::size_t bin = 1; bin < 200; ++bin)
        counts[bin] = 500;
    const double isovalue = suggestIsovalue(histogramOf(0.0, 255.0, counts));
    EXPECT_GT(isovalue, 5.0);
    EXPECT_LT(isovalue, 150.0);
}

TEST(SuggestIsovalue, OfATomographyShowsSkinOrBoneAndNotAir) {
    // Air at -1000, soft tissue near 40, a tail of bone up to 2000.
    std::vector<std::uint64_t> counts(512, 0);
    const auto binOf = [](double hounsfield) {
        return static_cast<std::size_t>((hounsfield + 1024.0) / 4010.0 * 512.0);
    };
    counts[binOf(-1000.0)] = 6'000'000;
    addPeak(counts, binOf(40.0), 300'000);
    for (std::size_t bin = binOf(150.0); bin < binOf(2000.0); ++bin)
        counts[bin] = 900;
    const double isovalue = suggestIsovalue(histogramOf(-1024.0, 2986.0, counts));
    EXPECT_GT(isovalue, -700.0);
    EXPECT_LT(isovalue, 1200.0);
}

TEST(SuggestIsovalue, StaysInARangeOfOneValue) {
    EXPECT_EQ(suggestIsovalue(histogramOf(7.0, 7.0, {12})), 7.0);
    EXPECT_EQ(suggestIsovalue(histogramOf(7.0, 7.0, std::vector<std::uint64_t>(512, 0))), 7.0);
}

TEST(SuggestIsovalue, OfNothingIsTheMiddle) { EXPECT_EQ(suggestIsovalue(histogramOf(2.0, 4.0, {})), 3.0); }

TEST(OutlineOf, MergesBinsAndKeepsTheSum) {
    std::vector<std::uint64_t> counts(1000, 3);
    const auto outline = outlineOf(histogramOf(0.0, 10.0, counts), 256);
    EXPECT_LE(outline.values.size(), 256u);
    EXPECT_EQ(std::accumulate(outline.counts.begin(), outline.counts.end(), 0.0), 3000.0);
    EXPECT_EQ(outline.values.front(), 0.0);
}

TEST(DrawableBins, AreNoFinerThanWholeNumbers) {
    const std::vector<std::uint64_t> counts(512, 1);
    EXPECT_EQ(drawableBins(histogramOf(0.0, 255.0, counts), ScalarType::U8), 256u);
    EXPECT_EQ(drawableBins(histogramOf(-1024.0, 3071.0, counts), ScalarType::I16), 512u);
    EXPECT_EQ(drawableBins(histogramOf(0.0, 1.0, counts), ScalarType::F32), 512u);
    EXPECT_EQ(drawableBins(histogramOf(7.0, 7.0, counts), ScalarType::U8), 1u);
}

TEST(OutlineOf, OfNothingIsEmpty) { EXPECT_TRUE(outlineOf({}, 256).values.empty()); }

} // namespace
} // namespace isoslider::model
