// A volume whose files change while its index is built.

#include <chrono>
#include <fstream>
#include <functional>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/formats/dicom/dicom_bytes.h"

namespace isoslider::preprocess {
namespace {

namespace fs = std::filesystem;
using test::HasError;
using test::IsOk;

constexpr int kSide = 24;

std::string samples(int add) {
    std::string bytes;
    for (int i = 0; i < kSide * kSide * kSide; ++i)
        bytes.push_back(static_cast<char>(i * 7 % 101 + add));
    return bytes;
}

// In place: the same inode, the same size.
void overwrite(const fs::path& path, const std::string& bytes) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file << bytes;
}

class ChangedVolume : public testing::TestWithParam<index::IndexKind> {
protected:
    /// Builds the index of a file or folder and calls `change` when the first samples have been read.
    Result<BuildReport> build(const fs::path& volume, const std::function<void()>& change) {
        auto source = io::openVolume(volume);
        EXPECT_THAT(source, IsOk());
        if (!source.isOk())
            return source.error();
        JobControl job;
        bool hasChanged = false;
        job.progress = [&](double fraction, std::string_view) {
            if (fraction > 0.1 && !std::exchange(hasChanged, true))
                change();
        };
        BuildOptions options;
        options.kind = GetParam();
        auto built = buildIndex(*source.value(), folder_ / "out/a.isx", options, job);
        EXPECT_TRUE(hasChanged);
        return built;
    }
    void expectRefused(const fs::path& volume, const fs::path& changed, const std::function<void()>& change) {
        SCOPED_TRACE(changed.string());
        const auto built = build(volume, change);
        ASSERT_THAT(built, HasError(ErrorCode::InvalidArgument));
        EXPECT_EQ(built.error().line(), changed.string() + ": changed while it was read");
        EXPECT_TRUE(fs::is_empty(folder_ / "out")) << "nothing is published";
    }
    void expectBuilt(const fs::path& volume, const std::function<void()>& change) {
        EXPECT_THAT(build(volume, change), IsOk());
        EXPECT_TRUE(fs::remove(folder_ / "out/a.isx"));
    }

    fs::path writeNrrd() {
        folder_.write("bone.raw", samples(0));
        const fs::path header = folder_.write("bone.nhdr", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 24 24\n"
                                                           "encoding: raw\ndata file: bone.raw\n");
        settle();
        return header;
    }
    /// The clock of the file system goes on, so that it reports a change from what was written before.
    static void settle() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }

    void SetUp() override { fs::create_directory(folder_ / "out"); }

    test::TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Kinds, ChangedVolume, testing::Values(index::IndexKind::Edges, index::IndexKind::Metacells),
                         [](const auto& kind) { return std::string(index::indexKindName(kind.param)); });

TEST_P(ChangedVolume, IsRefusedWhenItsSamplesAreOverwrittenInPlace) {
    const fs::path header = writeNrrd();
    expectRefused(header, folder_ / "bone.raw", [&] { overwrite(folder_ / "bone.raw", samples(3)); });
}

TEST_P(ChangedVolume, IsRefusedWhenItsModificationTimeIsSetBack) {
    const fs::path header = writeNrrd(), data = folder_ / "bone.raw";
    const auto before = fs::last_write_time(data);
    expectRefused(header, data, [&] {
        overwrite(data, samples(3));
        fs::last_write_time(data, before);
        EXPECT_EQ(fs::last_write_time(data), before);
    });
}

TEST_P(ChangedVolume, IsRefusedWhenItIsReplacedOrGoesAway) {
    expectRefused(writeNrrd(), folder_ / "bone.raw", [&] {
        folder_.write("new.raw", samples(3));
        fs::rename(folder_ / "new.raw", folder_ / "bone.raw");
    });
    expectRefused(writeNrrd(), folder_ / "bone.raw", [&] { fs::remove(folder_ / "bone.raw"); });
}

TEST_P(ChangedVolume, IsRefusedWhenItsHeaderChanges) {
    const fs::path header = writeNrrd();
    expectRefused(header, header, [&] { std::ofstream(header, std::ios::app) << "# more\n"; });
}

// Read whole, as extract, topology and resample do. A reader process keeps its own copy of what it has read: the same.
TEST(ChangedFile, IsRefusedWhenItIsReadIntoMemory) {
    const test::TemporaryFolder folder;
    const std::string head = "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 24 24 24\n"
                             "ORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 13824\nSCALARS s unsigned_char 1\n"
                             "LOOKUP_TABLE default\n";
    for (const auto& [name, start] :
         {std::pair<std::string, std::string>{"a.nrrd", "NRRD0004\ntype: uint8\ndimension: "
                                                        "3\nsizes: 24 24 24\nencoding: raw\n\n"},
          {"a.vtk", head}}) {
        const fs::path file = folder.write(name, start + samples(0));
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        const auto source = io::openVolume(file);
        ASSERT_THAT(source, IsOk());
        overwrite(file, start + samples(3));
        const auto grid = io::readVolume(*source.value(), file);
        ASSERT_THAT(grid, HasError(ErrorCode::InvalidArgument)) << name;
        EXPECT_EQ(grid.error().line(), file.string() + ": changed while it was read");
        EXPECT_THAT(io::readVolume(file), IsOk()) << "it stands still again";
    }
}

TEST_P(ChangedVolume, IsBuiltWhenOtherFilesChange) {
    const fs::path header = writeNrrd();
    folder_.write("other.raw", "old");
    expectBuilt(header, [&] {
        folder_.write("other.raw", "new");
        folder_.write("third.raw", "new");
    });
}

TEST_P(ChangedVolume, MayBeAFolderOfSlices) {
    const fs::path series = folder_ / "series";
    fs::create_directories(series / "deeper");
    for (int slice = 0; slice < 20; ++slice)
        folder_.write("series/deeper/" + std::to_string(slice) + ".dcm",
                      test::dicomFile(test::dicomSlice(slice, slice, [slice](int x, int y) { return x + y * slice; })));
    folder_.write("series/notes.txt", "old");
    settle();
    const fs::path changed = series / "deeper/7.dcm";
    const std::string other = test::dicomFile(test::dicomSlice(7, 7, [](int x, int y) { return x * 7 + y; }));
    ASSERT_EQ(other.size(), fs::file_size(changed));
    expectRefused(series, changed, [&] { overwrite(changed, other); });
    expectBuilt(series, [&] {
        folder_.write("series/notes.txt", "new");
        folder_.write("series/deeper/20.dcm", "new");
    });
}

} // namespace
} // namespace isoslider::preprocess
