#include "core/base/result.h"

#include <memory>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"

namespace isoslider {
namespace {

TEST(Error, IsOneLineWhateverIsInIt) {
    EXPECT_EQ(makeError(ErrorCode::IoError, "cannot read").line(), "cannot read");
    EXPECT_EQ(makeError(ErrorCode::Corruption, "bad", "a.isx", 64).line(), "a.isx: bad (at byte 64)");
    EXPECT_EQ(makeError(ErrorCode::Corruption, "two\nlines", "a\tb\x7f").line(), "a\\x09b\\x7f: two\\x0alines");
    EXPECT_EQ(makeError(ErrorCode::NotFound, "fehlt", "Schädel.mhd").line(), "Schädel.mhd: fehlt") << "UTF-8 stays";
}

TEST(Result, HoldsAValueOrAnError) {
    Result<std::unique_ptr<int>> value(std::make_unique<int>(7));
    ASSERT_THAT(value, test::IsOk());
    const std::unique_ptr<int> taken = std::move(value).value();
    EXPECT_EQ(*taken, 7);
    const Result<std::unique_ptr<int>> error(makeError(ErrorCode::NotFound, "none"));
    EXPECT_THAT(error, test::HasError(ErrorCode::NotFound));
    EXPECT_FALSE(error.isCancelled());
    EXPECT_TRUE(Result<int>(makeError(ErrorCode::Cancelled, "cancelled")).isCancelled());
    EXPECT_TRUE(Status(makeError(ErrorCode::Cancelled, "cancelled")).isCancelled());
    EXPECT_FALSE(Status().isCancelled());
}

TEST(Result, TryReturnsTheFirstErrorAndGoesNoFurther) {
    int reached = 0;
    const auto run = [&](bool fails) -> Status {
        ISO_TRY(fails ? Status(makeError(ErrorCode::OutOfSpace, "full", "x", 3)) : Status());
        ++reached;
        return {};
    };
    EXPECT_THAT(run(false), test::IsOk());
    EXPECT_EQ(reached, 1);
    const Status failed = run(true);
    EXPECT_EQ(reached, 1);
    EXPECT_EQ(failed.error().line(), "x: full (at byte 3)");
}

TEST(ResultDeathTest, AskingAnErrorForItsValueStopsTheProgram) {
    const Result<int> error(makeError(ErrorCode::NotFound, "none"));
    EXPECT_DEATH(static_cast<void>(error.value()), "isOk");
    const Result<int> value(1);
    EXPECT_DEATH(static_cast<void>(value.error()), "isOk");
}

} // namespace
} // namespace isoslider
