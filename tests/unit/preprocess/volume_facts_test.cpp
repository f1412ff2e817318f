#include "preprocess/volume_facts.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/grid/volume_statistics.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"

namespace isoslider::preprocess {
namespace {

template <class Sample, class Make>
std::shared_ptr<const ScalarGrid> volumeOf(ScalarType type, GridDims dims, const Make& make) {
    GridGeometry geometry;
    geometry.dims = dims;
    return test::makeVolume<Sample>(type, geometry, [&](std::int64_t, std::int64_t, std::int64_t) { return make(); });
}

void expectFactsOf(const std::shared_ptr<const ScalarGrid>& grid, std::uint64_t memoryBytes) {
    const auto wanted = computeStatistics(*grid);
    ASSERT_THAT(wanted, test::IsOk());
    const auto source = io::makeMemorySource(grid);
    const auto found = findFacts(*source, memoryBytes);
    ASSERT_THAT(found, test::IsOk());
    EXPECT_EQ(found.value().min, wanted.value().min);
    EXPECT_EQ(found.value().max, wanted.value().max);
    EXPECT_EQ(found.value().distinctValues, wanted.value().distinctValues);
    EXPECT_EQ(found.value().missingSamples, wanted.value().nanCount);
}

TEST(VolumeFacts, AreThoseOfTheWholeGrid) {
    std::mt19937_64 random(3);
    expectFactsOf(
        volumeOf<std::uint8_t>(ScalarType::U8, {70, 61, 53}, [&] { return static_cast<std::uint8_t>(random()); }),
        1 << 20);
    expectFactsOf(
        volumeOf<std::int16_t>(ScalarType::I16, {70, 61, 53}, [&] { return static_cast<std::int16_t>(random()); }),
        1 << 20);
    expectFactsOf(
        volumeOf<std::int32_t>(ScalarType::I32, {70, 61, 53}, [&] { return static_cast<std::int32_t>(random()); }),
        64 << 20);
    const auto real = [&] {
        const auto bits = random();
        return bits % 97 == 0   ? std::numeric_limits<double>::infinity()
               : bits % 89 == 0 ? std::nan("")
               : bits % 83 == 0 ? (bits & 1024 ? 0.0 : -0.0)
                                : std::ldexp(static_cast<double>(bits >> 11), -60);
    };
    expectFactsOf(volumeOf<float>(ScalarType::F32, {70, 61, 53}, [&] { return static_cast<float>(real()); }), 1 << 20);
    // 226 thousand doubles do not fit into 1 MB: further passes.
    expectFactsOf(volumeOf<double>(ScalarType::F64, {70, 61, 53}, real), 1 << 20);
    expectFactsOf(volumeOf<double>(ScalarType::F64, {1, 1, 1}, [] { return -3.5; }), 1 << 20);
}

TEST(VolumeFacts, OfNothingFiniteHaveNoRange) {
    const auto source = io::makeMemorySource(volumeOf<float>(ScalarType::F32, {3, 3, 3}, [] { return std::nanf(""); }));
    const auto found = findFacts(*source, 1 << 20);
    ASSERT_THAT(found, test::IsOk());
    EXPECT_TRUE(std::isnan(found.value().min));
    EXPECT_EQ(found.value().missingSamples, 27u);
    EXPECT_EQ(found.value().distinctValues, 0u);
}

TEST(VolumeFacts, CanBeCancelled) {
    const auto source = io::makeMemorySource(volumeOf<float>(ScalarType::F32, {3, 3, 3}, [] { return 1.0f; }));
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_TRUE(findFacts(*source, 1 << 20, job).isCancelled());
}

} // namespace
} // namespace isoslider::preprocess
