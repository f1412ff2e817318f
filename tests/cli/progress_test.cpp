#include <gtest/gtest.h>

#include "app/cli/progress_bar.h"

namespace isoslider::cli {
namespace {

TEST(ProgressBar, RoundsWhatIsLeftUp) {
    EXPECT_EQ(durationText(0.2), "5 s");
    EXPECT_EQ(durationText(41.0), "45 s");
    EXPECT_EQ(durationText(94.0), "95 s");
    EXPECT_EQ(durationText(100.0), "2 min");
    EXPECT_EQ(durationText(3500.0), "59 min");
    EXPECT_EQ(durationText(3660.0), "1 h 10 min");
    EXPECT_EQ(durationText(7200.0), "2 h 0 min");
    EXPECT_EQ(durationText(100000.0), "27 h 50 min");
}

} // namespace
} // namespace isoslider::cli
