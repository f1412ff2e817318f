#include "core/base/memory_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "core/base/machine.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider {
namespace {

using testing::Optional;

struct MemoryLimitOfGroups : testing::Test {
    test::TemporaryFolder folder;
    void state(const std::string& file, std::string_view text) const {
        std::filesystem::create_directories((folder / file).parent_path());
        folder.write(file, text);
    }
    std::optional<std::uint64_t> limitOf(std::string_view membership) const {
        return memoryLimitOfGroups(membership, folder.path());
    }
};

TEST_F(MemoryLimitOfGroups, IsTheLeastOnTheWayToTheRoot) {
    state("job/memory.max", "8000000000\n");
    state("job/step/memory.max", "max\n");
    state("job/step/task/memory.max", "9000000000\n");
    EXPECT_THAT(limitOf("0::/job/step/task\n"), Optional(8000000000u));
    EXPECT_THAT(limitOf("0::/job/step"), Optional(8000000000u));
    state("job/step/task/memory.max", "7000000000\n");
    EXPECT_THAT(limitOf("0::/job/step/task\n"), Optional(7000000000u));
    EXPECT_THAT(limitOf("0::/job/step\n"), Optional(8000000000u));
}

TEST_F(MemoryLimitOfGroups, IsThatOfTheMemoryControllerInVersionOne) {
    state("memory/job/memory.limit_in_bytes", "5000000000\n");
    state("memory/other/memory.limit_in_bytes", "4000000000\n");
    EXPECT_THAT(limitOf("9:name=systemd:/other\n4:cpu,memory:/job\n3:cpuset:/other\n0::/\n"), Optional(5000000000u));
    EXPECT_THAT(limitOf("4:memory,cpu:/job\n"), Optional(5000000000u));
    EXPECT_EQ(limitOf("4:cpu:/job\n5:memoryless:/job\n"), std::nullopt);
}

TEST_F(MemoryLimitOfGroups, OfAContainerIsAtTheRoot) {
    state("memory.max", "3000000000\n");
    EXPECT_THAT(limitOf("0::/\n"), Optional(3000000000u));
    EXPECT_THAT(limitOf("0::/what/the/container/does/not/see\n"), Optional(3000000000u));
}

TEST_F(MemoryLimitOfGroups, IsNoneWhereNothingStatesOne) {
    EXPECT_EQ(limitOf(""), std::nullopt);
    EXPECT_EQ(limitOf("0::/job\n"), std::nullopt);
    EXPECT_EQ(limitOf("no line of its form\n:\n::\n\n"), std::nullopt);
    state("memory.max", "max\n");
    EXPECT_EQ(limitOf("0::/\n"), std::nullopt);
    state("memory.max", "");
    EXPECT_EQ(limitOf("0::/\n"), std::nullopt);
}

TEST(UsableMemory, IsAtMostWhatTheMachineHas) {
    EXPECT_GT(usableMemoryBytes(), 0u);
    EXPECT_LE(usableMemoryBytes(), physicalMemoryBytes());
}

TEST(UsableMemory, IsWithinTheLimitOnAddressSpace) {
    if (test::kHasSanitizers)
        GTEST_SKIP() << "sanitizers take more address space than there is memory";
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
    if (before.rlim_cur != RLIM_INFINITY)
        GTEST_SKIP() << "this process already has a limit";
    const std::uint64_t free = usableMemoryBytes();
    rlimit limited = before;
    limited.rlim_cur = free / 2;
    ASSERT_EQ(setrlimit(RLIMIT_AS, &limited), 0);
    const std::uint64_t within = usableMemoryBytes();
    ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_EQ(within, free / 2);
}

} // namespace
} // namespace isoslider
