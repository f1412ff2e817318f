#include "core/base/guarded.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/job_control.h"
#include "tests/support/result_matchers.h"

namespace isoslider {
namespace {

TEST(Guarded, PassesWhatIsReturned) {
    EXPECT_THAT(guarded({"no memory"}, [] { return Status(); }), test::IsOk());
    const auto number = guarded({"no memory"}, [] { return Result<int>(7); });
    ASSERT_THAT(number, test::IsOk());
    EXPECT_EQ(number.value(), 7);
    EXPECT_TRUE(guarded({"no memory"}, [] { return Status(cancelledError()); }).isCancelled());
}

TEST(Guarded, TurnsWhatIsThrownIntoErrors) {
    const ThrownErrors errors{"no memory for it", ErrorCode::Corruption, "cannot be read", "a.isx"};
    const Status memory = guarded(errors, []() -> Status { throw std::bad_alloc(); });
    EXPECT_THAT(memory, test::HasError(ErrorCode::OutOfSpace));
    EXPECT_THAT(memory.error().line(),
                testing::AllOf(testing::HasSubstr("a.isx"), testing::HasSubstr("no memory for it")));
    const auto other = guarded(errors, []() -> Result<int> { throw std::runtime_error("seven"); });
    EXPECT_THAT(other, test::HasError(ErrorCode::Corruption));
    EXPECT_THAT(other.error().message, testing::StrEq("cannot be read: seven"));
}

} // namespace
} // namespace isoslider
