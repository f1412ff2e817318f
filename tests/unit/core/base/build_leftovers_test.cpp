#include "core/base/build_leftovers.h"

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"

namespace isoslider {
namespace {

TEST(BuildLeftovers, AreKnownByName) {
    for (const char* name : {"a.isx.resume", "a.isx.resume.partial", "a.isx.partial", "a.isx.sort.partial",
                             "a.isx.topology.partial", "a.isx.levels", "a.isx.levels.partial"})
        EXPECT_EQ(indexOfLeftover(std::filesystem::path("/data") / name), "/data/a.isx") << name;
    for (const char* name : {"a.isx", "a.mha", "a.partial", "a.resume", "resume", ".resume", "a.isx.resume.mha",
                             "a.levels", "", "a.isx/b.resume"})
        EXPECT_FALSE(indexOfLeftover(name)) << name;
}

TEST(BuildLeftovers, AreNoVolumes) {
    EXPECT_THAT(checkIsNoLeftover("a.mha"), test::IsOk());
    const Status refused = checkIsNoLeftover("/data/a.isx.resume");
    ASSERT_FALSE(refused.isOk());
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
    EXPECT_NE(refused.error().line().find("a part of the index 'a.isx', not a volume"), std::string::npos)
        << refused.error().line();
}

} // namespace
} // namespace isoslider
