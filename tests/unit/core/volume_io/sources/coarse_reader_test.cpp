#include "core/volume_io/sources/coarse_reader.h"

#include <numeric>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"

namespace isoslider::io {
namespace {

using test::HasError;
using test::IsOk;

/// Ascending 16-bit samples; notes which planes were asked for, and fails at one of them.
class NotingSource final : public VolumeSource {
public:
    explicit NotingSource(GridDims dims) {
        GridGeometry geometry;
        geometry.dims = dims;
        geometry.spacing = {0.5, 1.0, 2.0};
        geometry.origin = {-3.0, 4.0, 5.0};
        std::vector<std::uint16_t> values(static_cast<std::size_t>(pointCount(dims)));
        std::iota(values.begin(), values.end(), std::uint16_t{0});
        whole = std::make_shared<const ScalarGrid>(
            ScalarGrid::fromValues<std::uint16_t>(geometry, ScalarType::U16, values));
        memory_ = makeMemorySource(whole);
    }
    const VolumeInfo& info() const override { return memory_->info(); }
    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) override {
        asked.emplace_back(zBegin, zEnd);
        if (zBegin == badPlane)
            return makeError(ErrorCode::IoError, "the disk is gone");
        if (asked.size() == stopAfter)
            stop.request_stop();
        return memory_->readSlab(zBegin, zEnd, out);
    }
    std::shared_ptr<const ScalarGrid> whole;
    std::vector<std::pair<std::int64_t, std::int64_t>> asked;
    std::int64_t badPlane = -1;
    std::size_t stopAfter = 0;
    std::stop_source stop;

private:
    std::unique_ptr<VolumeSource> memory_;
};

TEST(CoarseReader, TakesTheSmallestStepThatFits) {
    EXPECT_EQ(coarseStep({256, 256, 256}, std::uint64_t{1} << 24), 2); // 1 would fit, but is no preview
    EXPECT_EQ(coarseStep({1024, 1024, 1024}, 24'000'000), 4);
    EXPECT_EQ(coarseStep({1024, 1024, 1024}, std::uint64_t{1} << 24), 4);
    EXPECT_EQ(coarseStep({1024, 1024, 1024}, (std::uint64_t{1} << 24) - 1), 8);
    EXPECT_EQ(coarseStep({9, 9, 9}, 27), 4);
    EXPECT_EQ(coarseStep({9, 9, 9}, 26), 8);
}

TEST(CoarseReader, LeavesTwoSamplesOnEveryAxis) {
    EXPECT_EQ(coarseStep({9, 9, 9}, 7), std::nullopt);
    EXPECT_EQ(coarseStep({100, 100, 3}, 5000), 2);
    EXPECT_EQ(coarseStep({100, 100, 3}, 4999), std::nullopt);
    EXPECT_EQ(coarseStep({100, 100, 2}, 100'000), std::nullopt);
    EXPECT_EQ(coarseStep({100, 100, 1}, 625), 4); // nothing to leave
}

TEST(CoarseReader, KeepsTheSamplesAndTheirPlaces) {
    for (const GridDims dims : {GridDims{8, 8, 8}, GridDims{9, 6, 7}, GridDims{5, 13, 4}})
        for (const std::int64_t step : {1, 2, 4}) {
            NotingSource source(dims);
            const auto read = readCoarse(source, step);
            ASSERT_THAT(read, IsOk());
            const ScalarGrid& coarse = *read.value();
            EXPECT_EQ(coarse.type(), ScalarType::U16);
            const auto& geometry = coarse.geometry();
            const auto coarseToWorld = geometry.indexToWorld();
            const auto fineToWorld = source.whole->geometry().indexToWorld();
            for (std::int64_t z = 0; z < geometry.dims[2]; ++z)
                for (std::int64_t y = 0; y < geometry.dims[1]; ++y)
                    for (std::int64_t x = 0; x < geometry.dims[0]; ++x) {
                        const glm::dvec4 fine(glm::dvec3(x * step, y * step, z * step), 1.0);
                        EXPECT_EQ(coarse.valueAt(x, y, z), source.whole->valueAt(x * step, y * step, z * step));
                        EXPECT_EQ(coarseToWorld * glm::dvec4(x, y, z, 1.0), fineToWorld * fine);
                    }
            for (std::size_t axis = 0; axis < 3; ++axis) // none is left out
                EXPECT_GE(geometry.dims[axis] * step, dims[axis]);
        }
}

TEST(CoarseReader, AsksForOnePlaneInStep) {
    NotingSource source({6, 6, 9});
    std::vector<double> fractions;
    JobControl job;
    job.progress = [&](double fraction, std::string_view) { fractions.push_back(fraction); };
    ASSERT_THAT(readCoarse(source, 4, job), IsOk());
    const std::vector<std::pair<std::int64_t, std::int64_t>> expected{{0, 1}, {4, 5}, {8, 9}};
    EXPECT_EQ(source.asked, expected);
    EXPECT_EQ(fractions, (std::vector<double>{4.0 / 9.0, 8.0 / 9.0, 1.0}));
}

TEST(CoarseReader, StopsWhenItIsTold) {
    NotingSource source({6, 6, 9});
    source.stopAfter = 2;
    JobControl job;
    job.stop = source.stop.get_token();
    EXPECT_THAT(readCoarse(source, 2, job), HasError(ErrorCode::Cancelled));
    EXPECT_EQ(source.asked.size(), 2u);
}

TEST(CoarseReader, PassesOnWhatTheSourceReports) {
    NotingSource source({6, 6, 9});
    source.badPlane = 4;
    EXPECT_THAT(readCoarse(source, 2), HasError(ErrorCode::IoError));
}

} // namespace
} // namespace isoslider::io
