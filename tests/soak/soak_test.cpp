#include "tests/soak/soak.h"

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::test {

// session_soak goes on for an hour.
TEST(Soak, LeavesNothingOpenAndNoMemoryAfterAFewRounds) {
    const TemporaryFolder folder;
    Soak soak(folder.path(), writeSoakVolumes(folder.path(), 24), 1);
    const auto first = soak.round();
    ASSERT_THAT(first, IsOk());
    EXPECT_GT(first.value().moves, 100);
    for (int i = 0; i < 2; ++i) {
        const auto later = soak.round();
        ASSERT_THAT(later, IsOk());
        EXPECT_EQ(growthOf(first.value(), later.value()), "");
    }
}

TEST(Soak, FindsWhatGrows) {
    SoakRound first;
    first.residentBytes = first.heapBytes = std::uint64_t{100} << 20;
    first.descriptors = first.threads = 8;
    EXPECT_EQ(growthOf(first, first), "");
    SoakRound open = first, leaking = first;
    open.descriptors = 9;
    EXPECT_EQ(growthOf(first, open), "9 descriptors are open, 8 were after the first round");
    leaking.heapBytes += std::uint64_t{8} << 20;
    EXPECT_EQ(growthOf(first, leaking), "110592 KiB in use, 102400 after the first round");
}

} // namespace isoslider::test
