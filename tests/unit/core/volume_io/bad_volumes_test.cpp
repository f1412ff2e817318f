#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/bad_files.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::io {
namespace {

using test::BadFile;
using enum ErrorCode;

std::uint64_t peakRssBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
}

// Of this process and of readers that have ended: other work on the machine does not count.
double processorSeconds() {
    double seconds = 0.0;
    for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        ::getrusage(who, &usage);
        for (const timeval& time : {usage.ru_utime, usage.ru_stime})
            seconds += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }
    return seconds;
}

class BadVolume : public testing::TestWithParam<BadFile> {};

TEST_P(BadVolume, IsRefusedSoonWithOneClearLine) {
    const BadFile& bad = GetParam();
    ASSERT_THAT(bad.bytes, testing::Not(testing::HasSubstr("TEST ERROR")));
    const test::TemporaryFolder folder;
    const auto path = folder.write(bad.file, bad.bytes);
    if (!bad.companion.empty())
        folder.write("data.raw", bad.companion);
    const std::uint64_t rssBefore = peakRssBytes();
    const double begin = processorSeconds();
    testing::internal::CaptureStderr();
    const auto grid = readVolume(path);
    const std::string printed = testing::internal::GetCapturedStderr();
    const double elapsed = processorSeconds() - begin;
    ASSERT_THAT(grid, test::HasError(bad.code));
    EXPECT_THAT(grid.error().line(), testing::HasSubstr(bad.says));
    EXPECT_THAT(grid.error().line(), testing::Not(testing::HasSubstr("\n")));
    EXPECT_THAT(grid.error().line(), testing::HasSubstr(folder.path().string()));
    EXPECT_EQ(printed, "");
    EXPECT_LT(elapsed, 1.0);
    EXPECT_LT(peakRssBytes() - rssBefore, std::uint64_t{64} << 20);
}

const auto kLabel = [](const auto& parameter) { return std::string(parameter.param.label); };

INSTANTIATE_TEST_SUITE_P(MetaImage, BadVolume, testing::ValuesIn(test::badMetaImages()), kLabel);
INSTANTIATE_TEST_SUITE_P(Nrrd, BadVolume, testing::ValuesIn(test::badNrrds()), kLabel);
INSTANTIATE_TEST_SUITE_P(Nifti, BadVolume, testing::ValuesIn(test::badNiftis()), kLabel);
INSTANTIATE_TEST_SUITE_P(Maps, BadVolume, testing::ValuesIn(test::badMaps()), kLabel);
INSTANTIATE_TEST_SUITE_P(Vtk, BadVolume, testing::ValuesIn(test::badVtks()), kLabel);

TEST(BadPath, IsRefused) {
    const test::TemporaryFolder folder;
    EXPECT_THAT(readVolume(folder / "none.mha"), test::HasError(NotFound));
    std::filesystem::create_directory(folder / "folder.mha");
    EXPECT_THAT(readVolume(folder / "folder.mha"), test::HasError(InvalidArgument));
    ASSERT_EQ(::mkfifo((folder / "pipe.nrrd").c_str(), 0600), 0);
    EXPECT_THAT(readVolume(folder / "pipe.nrrd"), test::HasError(InvalidArgument));
    EXPECT_THAT(readVolume("/dev/zero"), test::HasError(InvalidArgument));
    EXPECT_THAT(readVolume(folder / std::string(4096, 'x')), test::HasError(IoError));
}

TEST(BadPath, B034_OfADataFileThroughALinkIsRefusedUnlessAllowed) {
    const test::TemporaryFolder outside, folder;
    outside.write("data.raw", test::ramp<std::int16_t>(24));
    std::filesystem::create_symlink(outside / "data.raw", folder / "data.raw");
    const auto linked = {folder.write("a.mhd", test::mhaHeader("data.raw")),
                         folder.write("a.nhdr", test::detachedNrrd("data.raw")),
                         folder.write("b.mhd", test::mhaHeader((outside / "data.raw").string())),
                         folder.write("b.nhdr", test::detachedNrrd((outside / "data.raw").string()))};
    for (const auto& path : linked) {
        const auto refused = readVolume(path);
        ASSERT_THAT(refused, test::HasError(InvalidArgument));
        EXPECT_THAT(refused.error().line(), testing::HasSubstr("outside the folder"));
        EXPECT_THAT(readVolume(path, {.allowsExternalData = true}), test::IsOk());
    }
}

class BadRaw : public testing::Test {
protected:
    Result<std::shared_ptr<const ScalarGrid>> read(std::uint64_t fileBytes, GridDims dims,
                                                   ScalarType type = ScalarType::U8) {
        ReadOptions options;
        options.raw = RawLayout{dims, type};
        options.allowsTrailing = allowsTrailing;
        return readVolume(folder.write("a.raw", std::string(fileBytes, 'x')), options);
    }
    test::TemporaryFolder folder;
    bool allowsTrailing = false;
};

TEST_F(BadRaw, SizesAreRefused) {
    const auto shortFile = read(23, {4, 3, 2});
    ASSERT_THAT(shortFile, test::HasError(Corruption));
    EXPECT_THAT(shortFile.error().line(), testing::AllOf(testing::HasSubstr("23"), testing::HasSubstr("24")));
    EXPECT_THAT(read(25, {4, 3, 2}), test::HasError(InvalidArgument));
    EXPECT_THAT(read(0, {4, 3, 2}), test::HasError(Corruption));
    EXPECT_THAT(read(24, {0, 10, 10}), test::HasError(InvalidArgument));
    EXPECT_THAT(read(24, {-1, 64, 64}), test::HasError(InvalidArgument));
    EXPECT_THAT(read(24, {65536, 65537, 1}), test::HasError(Corruption));
    EXPECT_THAT(read(24, {1 << 21, 1 << 21, 1 << 21}), test::HasError(InvalidArgument));
    EXPECT_THAT(read(24, {std::int64_t{1} << 32, std::int64_t{1} << 32, 1}), test::HasError(InvalidArgument));
    allowsTrailing = true;
    EXPECT_THAT(read(25, {4, 3, 2}), test::IsOk());
}

TEST_F(BadRaw, SmallestSizesAreAccepted) {
    for (const GridDims dims : {GridDims{1, 1, 1}, {1, 64, 64}, {64, 64, 1}, {2, 2, 2}})
        EXPECT_THAT(read(static_cast<std::uint64_t>(pointCount(dims)), dims), test::IsOk());
}

TEST_F(BadRaw, FileCutWhileOpenIsAnError) {
    const auto path = folder.write("a.raw", std::string(1000, 'x'));
    ReadOptions options;
    options.raw = RawLayout{{10, 10, 10}};
    auto source = openVolume(path, options);
    ASSERT_THAT(source, test::IsOk());
    std::filesystem::resize_file(path, 500);
    std::vector<std::byte> out(1000);
    EXPECT_THAT(source.value()->readSlab(0, 10, out), test::HasError(Corruption));
}

} // namespace
} // namespace isoslider::io
