#include "core/topology/analysis/strip_cut.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace isoslider::topology {
namespace {

constexpr Findings kNoise{1.25, 0.8, 0.4, 1.6, 0.0};

// Strips follow each other without a gap, and places in them fit into 31 bits: one bit is a mark.
void expectCutsRows(const StripCut& cut, const GridDims& dims) {
    std::int64_t next = 0, longest = 0;
    for (std::int64_t i = 0; i < cut.stripCount(); ++i) {
        const Strip strip = cut.stripAt(i);
        ASSERT_EQ(strip.yBegin, next);
        ASSERT_GT(strip.yEnd, strip.yBegin) << "it has cells";
        next = strip.yEnd;
        longest = std::max(longest, strip.rows());
    }
    EXPECT_EQ(next, dims[1] - 1);
    EXPECT_GE(cut.planes(), 3);
    EXPECT_LT(dims[0] * longest * (cut.planes() + 2), std::int64_t{1} << 31);
}

TEST(StripCut, CutsVolumesOfEveryShape) {
    const std::int64_t most = (std::int64_t{1} << 27) - 1;
    for (const GridDims& dims : {GridDims{2, 2, 2},
                                 {512, 512, 275},
                                 {7, 40'000, 9},
                                 {1 << 20, 100, 50},
                                 {most / 2, 2, 300},
                                 {2, most / 2, 300},
                                 {11'585, 11'585, 300}})
        for (const bool isWhole : {false, true})
            for (const std::int64_t planes : {0, 3, 16, 1000})
                for (const std::int64_t rows : {std::int64_t{0}, std::int64_t{1}, dims[1]}) {
                    SCOPED_TRACE(testing::Message() << dims[0] << " x " << dims[1] << ", " << planes << ", " << rows);
                    if (rows == 1 && dims[1] > 100'000)
                        continue; // tens of millions of strips
                    expectCutsRows(StripCut(dims, {planes, rows, isWhole}), dims);
                }
}

TEST(StripCut, TakesLessAndLessUntilItCannot) {
    for (const GridDims& dims : {GridDims{256, 256, 256}, {2048, 2048, 100}, {60'000, 50, 50}}) {
        StripCut cut(dims, {});
        const double first = cut.bytes(2.0, 4, kNoise);
        int steps = 0;
        while (cut.shrink(2.0, 4, kNoise)) {
            expectCutsRows(cut, dims);
            ASSERT_LT(++steps, 100);
        }
        EXPECT_EQ(cut.planes(), 3);
        EXPECT_LE(cut.bytes(2.0, 4, kNoise), first);
        EXPECT_LT(cut.bytes(1.0, 4, kNoise), cut.bytes(2.0, 4, kNoise));
    }
    StripCut asked({256, 256, 256}, {5, 7, false});
    EXPECT_FALSE(asked.shrink(2.0, 4, kNoise)) << "what is asked for stays";
}

} // namespace
} // namespace isoslider::topology
