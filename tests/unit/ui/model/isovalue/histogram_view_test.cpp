#include "ui/model/isovalue/histogram_view.h"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "ui/model/isovalue/histogram_model.h"
#include "ui/model/isovalue/isovalue_words.h"

namespace isoslider::model {
namespace {

template <class T>
HistogramView viewOf(ScalarType type, const std::vector<T>& values) {
    GridGeometry geometry;
    geometry.dims = {static_cast<std::int64_t>(values.size()), 1, 1};
    const auto [min, max] = std::minmax_element(values.begin(), values.end());
    auto found = distributionOf(ScalarGrid::fromValues<T>(geometry, type, values), static_cast<double>(*min),
                                static_cast<double>(*max));
    EXPECT_THAT(found, test::IsOk());
    return HistogramView(std::make_shared<ValueDistribution>(std::move(found).value()));
}

HistogramView smallIntegers() {
    std::vector<std::uint8_t> values;
    for (int value = 10; value < 60; ++value)
        values.insert(values.end(), static_cast<std::size_t>(value), static_cast<std::uint8_t>(value));
    return viewOf(ScalarType::U8, values);
}

std::vector<float> noiseWithOutliers() {
    std::mt19937 random(11);
    std::normal_distribution<float> normal(50.0f, 5.0f);
    std::vector<float> values(50'000);
    for (float& value : values)
        value = normal(random);
    values[0] = 3e38f;
    values[1] = 2e38f;
    values[2] = -1e30f;
    return values;
}

double sum(const std::vector<double>& counts) { return std::accumulate(counts.begin(), counts.end(), 0.0); }

TEST(HistogramView, TheUsualRangeLeavesOutliersOutAndCountsThem) {
    const auto view = viewOf(ScalarType::F32, noiseWithOutliers());
    EXPECT_TRUE(view.hasOutliers());
    const auto usual = view.usualRange();
    EXPECT_GT(usual.lower, 20.0);
    EXPECT_LT(usual.upper, 80.0);
    const auto beyond = view.beyond(usual);
    EXPECT_EQ(beyond.below, 1u);
    EXPECT_EQ(beyond.above, 2u);
    EXPECT_EQ(view.wholeRange().upper, static_cast<double>(3e38f));
    EXPECT_EQ(view.beyond(view.wholeRange()).above, 0u);
}

TEST(HistogramView, TheOutlineHoldsEverySampleInView) {
    const auto noise = viewOf(ScalarType::F32, noiseWithOutliers());
    const auto integers = smallIntegers();
    const auto usual = noise.usualRange();
    EXPECT_NEAR(sum(noise.outline(ValueScale(), usual.lower, usual.upper, 500).counts), 49'997.0, 0.5);
    for (const ScaleKind kind : {ScaleKind::Linear, ScaleKind::Symlog}) {
        const auto scale = ValueScale::fitting(kind, noise.values());
        const auto whole = noise.wholeRange();
        const double low = scale.placeOf(whole.lower), high = scale.placeOf(whole.upper);
        EXPECT_NEAR(sum(noise.outline(scale, low - 0.01 * (high - low), high + 0.01 * (high - low), 500).counts),
                    50'000.0, 1.0);
    }
    const auto log = ValueScale::fitting(ScaleKind::Log, integers.values());
    ASSERT_EQ(log.kind(), ScaleKind::Log);
    EXPECT_NEAR(sum(integers.outline(log, log.placeOf(9.0), log.placeOf(61.0), 400).counts),
                static_cast<double>(integers.values().counted()), 1.0);
}

TEST(HistogramView, ColumnsOfWholeNumbersHoldEquallyMany) {
    const auto view = smallIntegers();
    const auto wide = view.outline(ValueScale(), 9.5, 59.5, 400);
    ASSERT_EQ(wide.counts.size(), 50u) << "no column is narrower than a number";
    for (std::size_t i = 0; i < 50; ++i)
        EXPECT_EQ(wide.counts[i], static_cast<double>(10 + i));
    const auto narrow = view.outline(ValueScale(), 9.5, 59.5, 20);
    ASSERT_EQ(narrow.places.size(), narrow.counts.size() + 1);
    for (std::size_t i = 0; i + 2 < narrow.counts.size(); ++i)
        EXPECT_EQ(narrow.places[i + 1] - narrow.places[i], 3.0);
}

TEST(HistogramView, AReadoutIsOfTheValueBelowThePointer) {
    const auto view = smallIntegers();
    const auto readout = view.readout(12.3);
    ASSERT_TRUE(readout);
    EXPECT_EQ(readout->lower, 12.0);
    EXPECT_EQ(readout->upper, 12.0);
    EXPECT_EQ(readout->count, 12u);
    const auto all = static_cast<double>(view.values().counted());
    EXPECT_NEAR(readout->shareBelow, (10.0 + 11.0 + 12.0) / all, 1e-12) << "samples at 12 are below 12.3";
    EXPECT_NEAR(view.readout(12.0)->shareBelow, (10.0 + 11.0) / all, 1e-12) << "but not below 12";
    EXPECT_FALSE(view.readout(200.0));
    const auto noise = viewOf(ScalarType::F32, noiseWithOutliers());
    EXPECT_NEAR(noise.readout(50.0)->shareBelow, 0.5, 0.02);
    EXPECT_NEAR(noise.readout(1e20)->shareBelow, 1.0 - 2.0 / 50'000.0, 1e-9);
}

TEST(HistogramView, AReadoutOfTheOutlineIsOfTheStepThatIsDrawn) {
    const auto noise = viewOf(ScalarType::F32, noiseWithOutliers());
    const ValueScale even;
    const auto usual = noise.usualRange();
    const auto outline = noise.outline(even, usual.lower, usual.upper, 100);
    for (const double value : {41.0, 50.0, 63.5}) {
        const auto drawn = noise.readout(outline, even, value);
        ASSERT_TRUE(drawn);
        EXPECT_LE(drawn->lower, value);
        EXPECT_GT(drawn->upper, value);
        const auto column = std::find(outline.places.begin(), outline.places.end(), drawn->lower);
        ASSERT_NE(column, outline.places.end()) << "where the step begins";
        EXPECT_EQ(static_cast<double>(drawn->count),
                  outline.counts[static_cast<std::size_t>(column - outline.places.begin())]);
        EXPECT_EQ(drawn->shareBelow, noise.readout(value)->shareBelow);
        EXPECT_TRUE(drawn->isExact);
    }
    const auto integers = smallIntegers();
    const auto narrow = integers.outline(even, 9.5, 59.5, 20); // three numbers to a step, from 9.5 on
    const auto three = integers.readout(narrow, even, 11.2);
    EXPECT_EQ(three->lower, 10.0);
    EXPECT_EQ(three->upper, 12.0);
    EXPECT_EQ(three->count, 10u + 11u + 12u);
    const auto wide = integers.outline(even, 9.5, 59.5, 400);
    EXPECT_EQ(integers.readout(wide, even, 12.3)->count, 12u);
    EXPECT_EQ(integers.readout(wide, even, 12.3)->upper, 12.0);
    const auto log = ValueScale::fitting(ScaleKind::Log, integers.values());
    const auto shared = integers.outline(log, log.placeOf(9.0), log.placeOf(61.0), 10);
    const auto about = integers.readout(shared, log, log.placeOf(40.0));
    EXPECT_FALSE(about->isExact) << "a number may belong to two steps";
    EXPECT_LT(about->lower, 40.0);
    EXPECT_GT(about->upper, 40.0);
    EXPECT_GT(about->count, 100u);
}

TEST(HistogramView, CountsOfSomeSamplesStandForAll) {
    auto values = smallIntegers().values();
    values.weight = 100.0;
    const HistogramView view(std::make_shared<ValueDistribution>(values));
    EXPECT_EQ(view.readout(12.0)->count, 1200u);
    EXPECT_FALSE(view.readout(12.0)->isExact);
}

TEST(HistogramView, FewTowersDoNotSetTheHeight) {
    HistogramView::Outline outline;
    outline.counts.assign(200, 100.0);
    outline.counts[0] = 5e6;
    const auto clipped = HistogramView::topOf(outline, true);
    EXPECT_TRUE(clipped.isClipped);
    EXPECT_LT(clipped.height, 200.0);
    EXPECT_GT(clipped.height, 100.0);
    EXPECT_GT(HistogramView::topOf(outline, false).height, 5e6);
    outline.counts[0] = 250.0;
    EXPECT_FALSE(HistogramView::topOf(outline, true).isClipped);
}

TEST(HistogramView, FindsSamplesToSnapTo) {
    const auto view = viewOf<float>(ScalarType::F32, {0.0f, 1.5f, 4.0f, 4.0f, 9.0f});
    EXPECT_EQ(view.nearestSample(2.0), 1.5);
    EXPECT_EQ(view.nearestSample(100.0), 9.0);
    EXPECT_EQ(view.nextSample(1.5, true), 4.0);
    EXPECT_EQ(view.nextSample(1.5, false), 0.0);
    EXPECT_EQ(view.nextSample(9.0, true), 9.0);
    EXPECT_FALSE(viewOf(ScalarType::F32, noiseWithOutliers()).nearestSample(50.0)) << "of so many none is worth it";
}

// The axis cannot show so little, and keeps what it has.
TEST(HistogramView, ValuesNextToZeroAreOneColumn) {
    for (const double scale : {1e-300, 1e-306, 1e-310}) {
        std::vector<double> values;
        for (int i = 0; i < 5000; ++i)
            values.push_back(scale * std::sin(0.37 * i));
        const auto outline = viewOf(ScalarType::F64, values).outline(ValueScale(), 0.0, 5.0, 400);
        EXPECT_GT(sum(outline.counts), 0.0) << scale;
    }
    const auto widest = viewOf(ScalarType::F64, std::vector<double>{-1e308, 0.0, 0.5e308, 1e308});
    EXPECT_EQ(widest.outline(ValueScale(), -1.0, 1.0, 100).counts.size(), 100u);
}

TEST(HistogramView, OfNothingShowsNothing) {
    const HistogramView view;
    EXPECT_TRUE(view.outline(ValueScale(), 0.0, 1.0, 100).counts.empty());
    EXPECT_FALSE(view.readout(0.0));
    EXPECT_FALSE(view.hasOutliers());
}

TEST(FirstIsovalue, IsARoundNumberAmongTheUsualValues) {
    auto values = noiseWithOutliers();
    for (std::size_t i = 3; i < values.size(); i += 2)
        values[i] += 100.0f;
    const auto view = viewOf(ScalarType::F32, values);
    const double isovalue = firstIsovalue(view.values());
    EXPECT_GT(isovalue, 60.0);
    EXPECT_LT(isovalue, 140.0);
    EXPECT_NEAR(isovalue * 2.0, std::round(isovalue * 2.0), 1e-12);
}

TEST(ClampedText, NamesWhatWasAskedAndWhatWasTaken) {
    EXPECT_EQ(isovalueText(101325.0002, 101324.997, 101325.003), "101325.0002");
    EXPECT_EQ(isovalueText(101324.997, 101324.997, 101325.003, 6), "101324.997");
    EXPECT_EQ(isovalueText(1016.53127, 950.0, 1050.0), "1016.531") << "as before";
    EXPECT_EQ(isovalueText(1.0 / 3.0, -1024.0, 3071.0), "0.3333333");
    EXPECT_EQ(isovalueText(5.0, 5.0, 5.0), "5");
    EXPECT_EQ(isovalueText(1.0, -1.7e308, 1.7e308), "1");
    EXPECT_EQ(clampedText(1e9, 0.0, 255.0), "1000000000 is above all samples; the greatest, 255, was taken");
    EXPECT_EQ(clampedText(-1.5, 0.0, 255.0), "-1.5 is below all samples; the least, 0, was taken");
    EXPECT_EQ(clampedText(7.0, 0.0, 255.0), "");
}

TEST(EmptySurfaceText, SaysWhatToDo) {
    EXPECT_EQ(emptySurfaceText(0.0, 0.0, 255.0), "No surface at 0: no sample is below; choose a higher isovalue");
    EXPECT_EQ(emptySurfaceText(3.0, 3.0, 3.0), "No surface at 3: every sample has this value");
    EXPECT_NE(emptySurfaceText(7.0, 0.0, 255.0).find("crosses no cell"), std::string::npos);
    EXPECT_NE(emptySurfaceText(7.0, 0.0, 255.0, false).find("one sample thick"), std::string::npos);
}

} // namespace
} // namespace isoslider::model
