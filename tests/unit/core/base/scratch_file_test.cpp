#include "core/base/scratch_file.h"

#include <cerrno>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/faulty_file_system.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider {
namespace {

using test::HasError;
using test::IsOk;

TEST(ScratchFile, GivesBackWhatWasAppendedByAnyThread) {
    const test::TemporaryFolder folder;
    ScratchFile file(folder / "scratch");
    EXPECT_EQ(file.sizeBytes(), 0u);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&file, t] {
            for (int i = 0; i < 50; ++i) {
                const std::vector<std::byte> bytes(static_cast<std::size_t>(1000 * t + i), std::byte(50 * t + i));
                const auto offset = file.append(bytes);
                ASSERT_THAT(offset, IsOk());
                std::vector<std::byte> back(bytes.size());
                ASSERT_THAT(file.readAt(offset.value(), back), IsOk());
                ASSERT_EQ(back, bytes);
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(file.sizeBytes(), 50u * 6000 + 4u * 49 * 25);
    EXPECT_TRUE(folder.names().empty()) << "nothing is left, however the program ends";
}

TEST(ScratchFile, ReportsEveryCallThatFails) {
    const test::TemporaryFolder folder;
    for (int call = 0; call < 2; ++call) { // create, write
        test::FaultyFileSystem faulty(call, ENOSPC);
        ScratchFile file(folder / "scratch", faulty);
        const auto offset = file.append(std::vector<std::byte>(10));
        ASSERT_THAT(offset, HasError(ErrorCode::OutOfSpace)) << call;
        EXPECT_EQ(offset.error().path, (folder / "scratch").string()) << call;
    }
    ScratchFile nowhere(folder / "no" / "scratch");
    EXPECT_THAT(nowhere.append(std::vector<std::byte>(10)), HasError(ErrorCode::NotFound));
}

} // namespace
} // namespace isoslider
