// What builds hold in memory while the disk is slow. Whole programs within a budget: tests/cli/memory_test.cpp.

#include <atomic>
#include <chrono>
#include <fstream>
#include <random>
#include <thread>

#include <unistd.h>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::preprocess {
namespace {

std::uint64_t residentBytes() {
    std::ifstream statm("/proc/self/statm");
    std::uint64_t size = 0, resident = 0;
    statm >> size >> resident;
    return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

// The real disk, which stops at the first large write until the program takes no more memory. Remembers how
// much it took meanwhile.
class StallingFileSystem final : public FileSystem {
public:
    Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::filesystem::path& path) override {
        return defaultFileSystem().openForReading(path);
    }
    Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) override {
        auto file = defaultFileSystem().create(path);
        if (!file.isOk())
            return std::move(file).error();
        return std::unique_ptr<WritableFile>(std::make_unique<File>(*this, std::move(file).value()));
    }
    Status renameDurably(const std::filesystem::path& from, const std::filesystem::path& to) override {
        return defaultFileSystem().renameDurably(from, to);
    }
    Status removeFile(const std::filesystem::path& path) override { return defaultFileSystem().removeFile(path); }

    bool hasStalled() const { return hasStalled_; }
    std::uint64_t takenMeanwhile() const { return takenMeanwhile_; }

private:
    class File final : public WritableFile {
    public:
        File(StallingFileSystem& owner, std::unique_ptr<WritableFile> file) : owner_(owner), file_(std::move(file)) {}
        const std::filesystem::path& path() const override { return file_->path(); }
        std::uint64_t sizeBytes() const override { return file_->sizeBytes(); }
        Status writeAll(std::span<const std::byte> bytes) override {
            owner_.write(bytes.size());
            return file_->writeAll(bytes);
        }
        Status writeAt(std::uint64_t offset, std::span<const std::byte> bytes) override {
            return file_->writeAt(offset, bytes);
        }
        Status sync() override { return file_->sync(); }
        Status close() override { return file_->close(); }

    private:
        StallingFileSystem& owner_;
        std::unique_ptr<WritableFile> file_;
    };

    void write(std::size_t size) {
        if (size < 65536 || hasStalled_.exchange(true))
            return;
        const std::uint64_t before = residentBytes();
        constexpr std::uint64_t kSteady = std::uint64_t{1} << 18;
        for (std::uint64_t last = 0, now = before, rounds = 0; now > last + kSteady || rounds < 2; ++rounds) {
            std::this_thread::sleep_for(std::chrono::milliseconds(250));
            last = std::exchange(now, residentBytes());
        }
        const std::uint64_t after = residentBytes();
        takenMeanwhile_ = after > before ? after - before : 0;
    }

    std::atomic<bool> hasStalled_ = false;
    std::atomic<std::uint64_t> takenMeanwhile_ = 0;
};

// The samples of a slab, 64 MB that cannot be compressed, wait for the disk in rows of chunks; an eighth of the budget
// is for these.
TEST(BuildMetacells, KeepNoMoreRowsThanTheBudgetAllowsWhileTheDiskIsSlow) {
#if ISO_HAS_SANITIZER
    GTEST_SKIP() << "sanitizers take additional memory";
#endif
    if (tbb::this_task_arena::max_concurrency() < 2)
        GTEST_SKIP() << "nobody encodes while the only thread waits";
    GridGeometry geometry;
    geometry.dims = {64, 8192, 16};
    std::mt19937_64 random(1);
    const auto grid = test::makeVolume<double>(ScalarType::F64, geometry, [&](auto, auto, auto) {
        return static_cast<double>(random()) + 1.0 / static_cast<double>(random());
    });
    const test::TemporaryFolder folder;
    StallingFileSystem disk;
    BuildOptions options;
    options.kind = index::IndexKind::Metacells;
    options.memoryBytes = std::uint64_t{160} << 20;
    options.fileSystem = &disk;
    ASSERT_THAT(test::buildIndexOf(grid, folder / "a.isx", options), test::IsOk());
    ASSERT_TRUE(disk.hasStalled());
    EXPECT_LE(disk.takenMeanwhile(), options.memoryBytes / 8 + (std::uint64_t{12} << 20));
}

} // namespace
} // namespace isoslider::preprocess
