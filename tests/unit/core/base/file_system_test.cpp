#include "core/base/file_system.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include <gtest/gtest.h>

#include "core/base/memory_file_system.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider {
namespace {

using test::TemporaryFolder;

std::span<const std::byte> bytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

TEST(FileSystem, ReadsAtAnyOffset) {
    const TemporaryFolder folder;
    const auto file = defaultFileSystem().openForReading(folder.write("a", "0123456789"));
    ASSERT_TRUE(file.isOk());
    EXPECT_EQ(file.value()->sizeBytes(), 10u);
    std::array<std::byte, 4> four{};
    EXPECT_EQ(file.value()->readAt(3, four).value(), 4u);
    EXPECT_EQ(four[0], std::byte{'3'});
    EXPECT_EQ(file.value()->readAt(8, four).value(), 2u);
    EXPECT_EQ(file.value()->readAt(1000, four).value(), 0u);
    const auto tooFar = file.value()->readExactlyAt(8, four);
    ASSERT_FALSE(tooFar.isOk());
    EXPECT_EQ(tooFar.error().code, ErrorCode::Corruption);
}

TEST(FileSystem, RefusesWhatIsNotARegularFile) {
    const TemporaryFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    const std::filesystem::path paths[] = {folder.path(), folder / "pipe", "/dev/zero"};
    for (const auto& path : paths) {
        const auto file = defaultFileSystem().openForReading(path);
        ASSERT_FALSE(file.isOk()) << path;
        EXPECT_EQ(file.error().code, ErrorCode::InvalidArgument) << file.error().line();
    }
    EXPECT_EQ(defaultFileSystem().openForReading(folder / "none").error().code, ErrorCode::NotFound);
}

TEST(AtomicFile, AppearsOnlyWhenPublished) {
    const TemporaryFolder folder;
    const auto path = folder / "out";
    {
        auto file = AtomicFile::create(path);
        ASSERT_TRUE(file.isOk());
        ASSERT_TRUE(file.value()->writeAll(bytesOf("abcdef")).isOk());
        ASSERT_TRUE(file.value()->writeAt(1, bytesOf("XY")).isOk());
        EXPECT_EQ(file.value()->sizeBytes(), 6u);
        EXPECT_FALSE(std::filesystem::exists(path));
        ASSERT_TRUE(file.value()->publish().isOk());
    }
    EXPECT_EQ(test::readText(path), "aXYdef");
    EXPECT_FALSE(std::filesystem::exists(partialPath(path)));
}

TEST(AtomicFile, LeavesTheEarlierFileWhenAbandoned) {
    const TemporaryFolder folder;
    const auto path = folder.write("out", "old");
    {
        auto file = AtomicFile::create(path);
        ASSERT_TRUE(file.isOk());
        ASSERT_TRUE(file.value()->writeAll(bytesOf("new")).isOk());
    }
    EXPECT_EQ(test::readText(path), "old");
    EXPECT_FALSE(std::filesystem::exists(partialPath(path)));
}

TEST(AtomicFile, RefusesASecondWriter) {
    const TemporaryFolder folder;
    auto first = AtomicFile::create(folder / "out");
    ASSERT_TRUE(first.isOk());
    ASSERT_TRUE(first.value()->writeAll(bytesOf("first")).isOk());
    const auto second = AtomicFile::create(folder / "out");
    ASSERT_FALSE(second.isOk());
    EXPECT_EQ(second.error().code, ErrorCode::InvalidArgument);
    ASSERT_TRUE(first.value()->publish().isOk());
    EXPECT_EQ(test::readText(folder / "out"), "first");
}

TEST(AtomicFile, TakesOverAPartialLeftByACrash) {
    const TemporaryFolder folder;
    folder.write("out.partial", "a longer text of a program that died");
    auto file = AtomicFile::create(folder / "out");
    ASSERT_TRUE(file.isOk());
    ASSERT_TRUE(file.value()->writeAll(bytesOf("new")).isOk());
    ASSERT_TRUE(file.value()->publish().isOk());
    EXPECT_EQ(test::readText(folder / "out"), "new");
}

TEST(AtomicFile, IsOldOrNewWhicheverCallFails) {
    bool everSucceeded = false;
    for (int failing = 0; !everSucceeded; ++failing) {
        const TemporaryFolder folder;
        const auto path = folder.write("out", "old");
        test::FaultyFileSystem faulty(failing, ENOSPC);
        const Status status = [&]() -> Status {
            auto file = AtomicFile::create(path, faulty);
            if (!file.isOk())
                return std::move(file).error();
            ISO_TRY(file.value()->writeAll(bytesOf("new ")));
            ISO_TRY(file.value()->writeAll(bytesOf("text")));
            return file.value()->publish();
        }();
        everSucceeded = status.isOk();
        if (!status.isOk()) {
            EXPECT_EQ(status.error().code, ErrorCode::OutOfSpace);
        }
        const std::string text = test::readText(path);
        EXPECT_TRUE(text == "old" || text == "new text") << text;
        EXPECT_FALSE(std::filesystem::exists(partialPath(path)));
        ASSERT_LT(failing, 20);
    }
}

/// No further file can be opened while this lives.
class NoMoreFiles {
public:
    NoMoreFiles() {
        ::getrlimit(RLIMIT_NOFILE, &before_);
        const int next = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
        ::close(next);
        rlimit limit = before_;
        limit.rlim_cur = static_cast<rlim_t>(next);
        ::setrlimit(RLIMIT_NOFILE, &limit);
    }
    ~NoMoreFiles() { ::setrlimit(RLIMIT_NOFILE, &before_); }
    NoMoreFiles(const NoMoreFiles&) = delete;
    NoMoreFiles& operator=(const NoMoreFiles&) = delete;

private:
    rlimit before_{};
};

TEST(AtomicFile, KeepsTheEarlierFileWhenTheFolderCannotBeOpened) {
    if (test::kHasSanitizers)
        GTEST_SKIP() << "the sanitizers want files themselves";
    const TemporaryFolder folder;
    const auto path = folder.write("out", "old");
    {
        auto file = AtomicFile::create(path);
        ASSERT_TRUE(file.isOk());
        ASSERT_TRUE(file.value()->writeAll(bytesOf("new")).isOk());
        const NoMoreFiles limit;
        const Status status = file.value()->publish();
        ASSERT_FALSE(status.isOk());
        EXPECT_EQ(status.error().code, ErrorCode::IoError) << status.error().line();
    }
    EXPECT_EQ(test::readText(path), "old");
    EXPECT_FALSE(std::filesystem::exists(partialPath(path)));
}

TEST(AtomicFile, InMemoryAsksNothingOfTheDisk) {
    const TemporaryFolder folder;
    MemoryFileSystem memory;
    for (const auto& path : {folder / "absent/a", folder.path()}) { // no such folder; a folder is there
        auto file = AtomicFile::create(path, memory);
        ASSERT_TRUE(file.isOk()) << file.error().line();
        ASSERT_TRUE(file.value()->writeAll(bytesOf("new")).isOk());
        ASSERT_TRUE(file.value()->publish().isOk());
        EXPECT_EQ(readWholeFile(path, 10, memory).value().size(), 3u);
        EXPECT_FALSE(AtomicFile::create(path).isOk()) << "on the disk";
    }
}

TEST(AtomicFile, WritesThroughSymbolicLinks) {
    namespace fs = std::filesystem;
    const TemporaryFolder folder;
    fs::create_directory(folder / "there");
    folder.write("there/out", "old");
    fs::create_symlink("there/out", folder / "direct");
    fs::create_symlink(folder / "direct", folder / "link");
    fs::create_symlink("there/none", folder / "dangling");
    for (const auto* name : {"link", "dangling"}) {
        auto file = AtomicFile::create(folder / name);
        ASSERT_TRUE(file.isOk()) << name;
        EXPECT_EQ(file.value()->path(), folder / name);
        ASSERT_TRUE(file.value()->writeAll(bytesOf("new")).isOk());
        ASSERT_TRUE(file.value()->publish().isOk());
        EXPECT_TRUE(fs::is_symlink(folder / name));
    }
    EXPECT_EQ(test::readText(folder / "there/out"), "new");
    EXPECT_EQ(test::readText(folder / "there/none"), "new");
    EXPECT_TRUE(fs::is_symlink(folder / "direct"));
}

TEST(AtomicFile, KeepsThePermissionsOfTheFileThatItReplaces) {
    namespace fs = std::filesystem;
    const TemporaryFolder folder;
    const fs::path path = folder.write("out", "old");
    constexpr auto kOfOwner = fs::perms::owner_read | fs::perms::owner_write;
    for (const fs::perms wanted : {kOfOwner, kOfOwner | fs::perms::group_read, kOfOwner | fs::perms::owner_exec}) {
        fs::permissions(path, wanted);
        auto file = AtomicFile::create(path);
        ASSERT_TRUE(file.isOk());
        EXPECT_EQ(fs::status(folder / "out.partial").permissions(), wanted);
        ASSERT_TRUE(file.value()->publish().isOk());
        EXPECT_EQ(fs::status(path).permissions(), wanted);
    }
}

TEST(AtomicFile, RefusesLinksInACircle) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("b", folder / "a");
    std::filesystem::create_symlink("a", folder / "b");
    const auto file = AtomicFile::create(folder / "a");
    ASSERT_FALSE(file.isOk());
    EXPECT_EQ(file.error().code, ErrorCode::IoError);
}

TEST(CheckOutputPath, NamesWhatStandsInTheWay) {
    const TemporaryFolder folder;
    EXPECT_TRUE(checkOutputPath(folder / "new.ply").isOk());
    EXPECT_EQ(checkOutputPath(folder.path()).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(checkOutputPath(folder / "none/new.ply").error().code, ErrorCode::NotFound);
    EXPECT_EQ(checkOutputPath("/dev/null").error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(checkOutputPath("").error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(checkOutputPath(folder.write("file", "") / "x").error().code, ErrorCode::InvalidArgument);
}

TEST(ReadWholeFile, IsBounded) {
    const TemporaryFolder folder;
    const auto path = folder.write("a", "12345");
    EXPECT_EQ(readWholeFile(path, 5).value().size(), 5u);
    EXPECT_EQ(readWholeFile(path, 4).error().code, ErrorCode::InvalidArgument);
}

} // namespace
} // namespace isoslider
