// Moves between sample values, where only the decisions of ambiguous cells change.

#include <algorithm>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using test::IsOk;

// Samples 0 but for one ambiguous face between two cells, across x, at the middle of the box: its saddle lies at
// (10 * 8 - 0) / (10 + 8) = 4.44.
std::shared_ptr<const ScalarGrid> oneSaddle(std::int64_t side) {
    const std::int64_t m = side / 2;
    return test::makeVolume<float>(ScalarType::F32, test::cubeGeometry(side),
                                   [m](std::int64_t x, std::int64_t y, std::int64_t z) {
                                       if (x != m)
                                           return 0.0;
                                       return y == m && z == m ? 10.0 : y == m + 1 && z == m + 1 ? 8.0 : 0.0;
                                   });
}

TEST(SaddleCrossing, ChangesBothCellsOfTheFaceInOneMoveAndNothingElse) {
    for (const std::int64_t side : {12, 40, 96}) { // the same work whatever the box
        SCOPED_TRACE(side);
        const auto grid = oneSaddle(side);
        const test::TemporaryFolder folder;
        ASSERT_THAT(test::buildIndexOf(grid, folder / "a.isx"), IsOk());
        const auto engine = SlideEngine::open(folder / "a.isx");
        ASSERT_THAT(engine, IsOk());
        ASSERT_THAT(engine.value()->slideTo(4.0), IsOk());
        for (const double isovalue : {5.0, 4.0}) {
            const auto moved = engine.value()->slideTo(isovalue);
            ASSERT_THAT(moved, IsOk());
            EXPECT_EQ(moved.value().edgesAdded + moved.value().edgesRemoved, 0u);
            EXPECT_EQ(moved.value().bytesRead, 0u);
            EXPECT_FALSE(moved.value().hasRebuilt);
            EXPECT_EQ(moved.value().cellsResolved, 2u);
            EXPECT_EQ(moved.value().cellsRetriangulated, 2u);
            EXPECT_EQ(moved.value().ambiguousCells, 2u);
            const auto fresh = extractFull(*grid, isovalue);
            ASSERT_THAT(fresh, IsOk());
            EXPECT_TRUE(test::isSameSurface(engine.value()->mesh().value(), fresh.value()));
        }
        // Short of the saddle no cell is looked at.
        const auto within = engine.value()->slideTo(4.4);
        ASSERT_THAT(within, IsOk());
        EXPECT_EQ(within.value().cellsResolved, 0u);
    }
}

} // namespace
} // namespace isoslider::extract
