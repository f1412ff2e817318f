// The process that libraries parse in: what it states is taken with care, and its death is one clear line.

#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/reader_process/library_formats.h"
#include "core/volume_io/reader_process/messages.h"
#include "core/volume_io/reader_process/reader_client.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::io {
namespace {

namespace fs = std::filesystem;
using test::HasError;
using test::IsOk;

const std::string kVtk = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 2\n"
                         "ORIGIN 1 2 3\nSPACING 1 0.5 2\nPOINT_DATA 12\nSCALARS height float 1\nLOOKUP_TABLE default\n"
                         "0 1 2 3 4 5 6 7 8 9 10 11\n";

class ReaderProcess : public testing::Test {
protected:
    ~ReaderProcess() override {
        ::unsetenv("ISOSLIDER_READER");
        ::unsetenv("ISOSLIDER_READER_SILENCE");
    }
    /// A reader that is a script instead.
    void useReader(const std::string& script) {
        const fs::path program = folder.write("reader", "#!/bin/sh\n" + script + "\n");
        fs::permissions(program, fs::perms::owner_all);
        ::setenv("ISOSLIDER_READER", program.c_str(), 1);
    }
    test::TemporaryFolder folder;
    fs::path volume = folder.write("a.vtk", kVtk);
};

TEST_F(ReaderProcess, IsEndedWhenItHangs) {
    useReader("exec sleep 1000");
    ::setenv("ISOSLIDER_READER_SILENCE", "1", 1);
    const auto start = std::chrono::steady_clock::now();
    const auto opened = openInReaderProcess(volume, {});
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
    ASSERT_THAT(opened, HasError(ErrorCode::IoError));
    EXPECT_THAT(opened.error().message, testing::HasSubstr("hung"));
    EXPECT_EQ(opened.error().path, volume.string());
}

TEST_F(ReaderProcess, IsNotEndedWhileItWorks) {
    useReader("while :; do :; done");
    ::setenv("ISOSLIDER_READER_SILENCE", "1", 1);
    std::stop_source stop;
    const std::jthread later([&stop] {
        std::this_thread::sleep_for(std::chrono::seconds(4));
        stop.request_stop();
    });
    JobControl job;
    job.stop = stop.get_token();
    const auto start = std::chrono::steady_clock::now();
    EXPECT_THAT(openInReaderProcess(volume, {}, job), HasError(ErrorCode::Cancelled));
    EXPECT_GT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3)) << "ended before it was stopped";
}

TEST_F(ReaderProcess, ReadsWhatThisProcessReads) {
    const auto here = openInProcess(volume, {}), there = openInReaderProcess(volume, {});
    ASSERT_THAT(here, IsOk());
    ASSERT_THAT(there, IsOk());
    EXPECT_EQ(there.value()->info().geometry, here.value()->info().geometry);
    EXPECT_EQ(there.value()->info().type, here.value()->info().type);
    EXPECT_EQ(there.value()->info().format, here.value()->info().format);
    EXPECT_EQ(there.value()->info().fieldName, "height");
    for (int z = 0; z < 2; ++z) {
        std::vector<std::byte> a(6 * sizeof(float)), b(a.size());
        ASSERT_THAT(here.value()->readSlab(z, z + 1, a), IsOk());
        ASSERT_THAT(there.value()->readSlab(z, z + 1, b), IsOk());
        EXPECT_EQ(a, b);
    }
    std::vector<double> fractions;
    JobControl job;
    job.progress = [&](double fraction, std::string_view) { fractions.push_back(fraction); };
    EXPECT_THAT(there.value()->prepare(job), IsOk());
}

TEST_F(ReaderProcess, ListsWhatThisProcessLists) {
    const auto here = listInProcess(volume, {}), there = listInReaderProcess(volume, {});
    ASSERT_THAT(here, IsOk());
    ASSERT_THAT(there, IsOk());
    ASSERT_EQ(there.value().fields.size(), here.value().fields.size());
    EXPECT_EQ(there.value().fields[0].name, "height");
    EXPECT_EQ(there.value().fields[0].dims, (GridDims{3, 2, 2}));
}

TEST_F(ReaderProcess, RefusalsArriveAsTheyAre) {
    const auto bad = folder.write("bad.vtk", kVtk.substr(0, 60));
    const auto here = openInProcess(bad, {}), there = openInReaderProcess(bad, {});
    ASSERT_FALSE(here.isOk());
    ASSERT_FALSE(there.isOk());
    EXPECT_EQ(there.error().code, here.error().code);
    EXPECT_EQ(there.error().line(), here.error().line());
}

TEST_F(ReaderProcess, DeathIsOneLineThatNamesTheFile) {
    for (const std::string script : {"kill -SEGV $$", "kill -ABRT $$", "exit 1", "exit 0"}) {
        useReader(script);
        const auto opened = openVolume(volume);
        ASSERT_THAT(opened, HasError(ErrorCode::Corruption)) << script;
        EXPECT_THAT(opened.error().line(), testing::HasSubstr("a.vtk: crashes its reader")) << script;
        EXPECT_THAT(listVolumes(volume), HasError(ErrorCode::Corruption)) << script;
    }
    useReader("exit 127"); // as where a library is missing
    EXPECT_THAT(openVolume(volume), HasError(ErrorCode::IoError)) << "no fault of the file";
    EXPECT_THAT(openVolume(volume).error().line(), testing::HasSubstr("cannot be started"));
    useReader("kill -XCPU $$");
    EXPECT_THAT(openVolume(volume).error().line(), testing::HasSubstr("busy without end"));
    useReader("kill -KILL $$");
    EXPECT_THAT(openVolume(volume), HasError(ErrorCode::OutOfSpace));
}

TEST_F(ReaderProcess, InvalidRepliesAreRefused) {
    // A length, then that many bytes; stdin is the socket.
    for (const std::string bytes : {R"(\001\000\000\000\007)", R"(\002\000\000\000\002\000)", R"(\377\377\377\377)",
                                    R"(\000\000\000\000)", R"(\005\000\000\000\000\000\000\000\000)"}) {
        useReader("printf '" + bytes + "' >&0; sleep 5");
        const auto started = std::chrono::steady_clock::now();
        EXPECT_THAT(openVolume(volume), HasError(ErrorCode::Corruption)) << bytes;
        EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(4)) << bytes;
    }
}

TEST_F(ReaderProcess, WithoutAProgramThereIsAReason) {
    ::setenv("ISOSLIDER_READER", (folder.path() / "absent").c_str(), 1);
    const auto opened = openVolume(volume);
    ASSERT_THAT(opened, HasError(ErrorCode::IoError));
    EXPECT_THAT(opened.error().line(), testing::HasSubstr("cannot start"));
}

VolumeInfo someInfo() {
    VolumeInfo info;
    info.geometry.dims = {7, 5, 3};
    info.geometry.spacing = {0.5, 1.5, 2.5};
    info.geometry.origin = {-1.0, 1e300, 3.0};
    info.geometry.direction = glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, 1);
    info.type = ScalarType::I16;
    info.format = "a format";
    info.fieldName = "a field";
    info.fieldTitle = "what people call it";
    info.lengthUnit = "µm";
    info.notes = {"one", "two"};
    info.resampling = ResampleReport{1, 2, 0.5, 0.25, 0.125, 3};
    return info;
}

VolumeContents someContents() {
    VolumeContents contents;
    contents.format = "a format";
    contents.fields.resize(2);
    contents.fields[1].name = "velocity";
    contents.fields[1].title = "Velocity";
    contents.fields[1].dims = {4, 5, 6};
    contents.fields[1].typeName = "float32";
    contents.fields[1].components = 3;
    contents.fields[1].componentNames = {"x", "y", "z"};
    contents.fields[1].frames = 9;
    contents.fields[1].isResampled = true;
    contents.fields[1].problem = "none";
    contents.preferred = 1;
    contents.isPreferredChosen = true;
    return contents;
}

TEST(ReaderMessages, KeepEveryField) {
    ReaderRequest request;
    request.kind = RequestKind::ReadSlab;
    request.path = "/a/b c";
    request.options.raw = RawLayout{{3, 4, 5}, ScalarType::F64, {1, 2, 3}, 77, true};
    request.options.field = "x";
    request.options.component = kMagnitude;
    request.options.frame = 1LL << 40;
    request.options.resampleDims = {8, 9, 10};
    request.options.allowsExternalData = true;
    request.options.allowsTrailing = true;
    request.options.memoryBytes = std::uint64_t{3} << 33;
    request.zBegin = 3;
    request.zEnd = 1LL << 33;
    const auto taken = decodeRequest(encodeRequest(request));
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->kind, request.kind);
    EXPECT_EQ(taken->path, request.path);
    EXPECT_EQ(taken->options, request.options);
    EXPECT_EQ(taken->zBegin, request.zBegin);
    EXPECT_EQ(taken->zEnd, request.zEnd);

    const VolumeInfo info = someInfo();
    const auto infoTaken = decodeInfo(encodeInfo(info));
    ASSERT_TRUE(infoTaken);
    EXPECT_EQ(infoTaken->geometry, info.geometry);
    EXPECT_EQ(infoTaken->type, info.type);
    EXPECT_EQ(infoTaken->format, info.format);
    EXPECT_EQ(infoTaken->fieldName, info.fieldName);
    EXPECT_EQ(infoTaken->fieldTitle, info.fieldTitle);
    EXPECT_EQ(infoTaken->lengthUnit, info.lengthUnit);
    EXPECT_EQ(infoTaken->notes, info.notes);
    ASSERT_TRUE(infoTaken->resampling);
    const ResampleReport& report = *infoTaken->resampling;
    EXPECT_EQ(std::tie(report.sourcePoints, report.comparedPoints, report.outsidePoints), std::tuple(1, 2, 3));
    EXPECT_EQ(std::tie(report.maxDifference, report.rmsDifference, report.rangeFraction), std::tuple(0.5, 0.25, 0.125));

    const auto contents = decodeContents(encodeContents(someContents()));
    ASSERT_TRUE(contents);
    const VolumeField &field = contents->fields[1], wanted = someContents().fields[1];
    EXPECT_EQ(std::tie(field.name, field.title, field.dims, field.typeName, field.components, field.componentNames,
                       field.frames, field.isResampled, field.problem),
              std::tie(wanted.name, wanted.title, wanted.dims, wanted.typeName, wanted.components,
                       wanted.componentNames, wanted.frames, wanted.isResampled, wanted.problem));
    EXPECT_EQ(contents->preferred, 1u);
    EXPECT_TRUE(contents->isPreferredChosen);

    const auto error = decodeError(encodeError(makeError(ErrorCode::OutOfSpace, "two\nlines", "p", 5)));
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code, ErrorCode::OutOfSpace);
    EXPECT_EQ(error->message, "two lines");
    EXPECT_EQ(error->path, "p");
    EXPECT_EQ(error->offset, 5u);
}

TEST(ReaderMessages, ThatNoReaderMaySendAreRefused) {
    VolumeInfo info = someInfo();
    info.geometry.dims = {1 << 30, 1 << 30, 1 << 30};
    EXPECT_FALSE(decodeInfo(encodeInfo(info)));
    info = someInfo();
    info.geometry.spacing[1] = 0.0;
    EXPECT_FALSE(decodeInfo(encodeInfo(info)));
    for (const char* unit : {"m\x1bm", "\xff", "a unit", "seventeen_letters"}) {
        info = someInfo();
        info.lengthUnit = unit;
        EXPECT_FALSE(decodeInfo(encodeInfo(info))) << unit;
    }
    VolumeContents contents = someContents();
    contents.preferred = 2;
    EXPECT_FALSE(decodeContents(encodeContents(contents)));
    contents = someContents();
    contents.fields[0].components = 0;
    EXPECT_FALSE(decodeContents(encodeContents(contents)));
    EXPECT_FALSE(decodeContents(encodeContents({})));
    EXPECT_FALSE(decodeProgress(encodeProgress(std::nan(""), "x")));
}

TEST(ReaderMessages, WhatIsForPeopleIsOneLine) {
    const auto error = decodeError(encodeError(makeError(ErrorCode::Corruption, "a\nb\x1b[2J\x7f", "/a")));
    ASSERT_TRUE(error);
    EXPECT_EQ(error->message, "a b [2J ");
    VolumeInfo info = someInfo();
    info.notes = {"a\nb"};
    EXPECT_EQ(decodeInfo(encodeInfo(info)).value().notes[0], "a b");
    VolumeContents contents = someContents();
    contents.fields[0].title = contents.fields[0].problem = "a\rb";
    const auto decoded = decodeContents(encodeContents(contents));
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->fields[0].title + decoded->fields[0].problem, "a ba b");
}

TEST(ReaderMessages, OfAnyBytesNeverHarm) {
    std::mt19937 random(5);
    const std::vector<std::vector<std::byte>> seeds = {encodeInfo(someInfo()), encodeContents(someContents()),
                                                       encodeRequest({}), encodeProgress(0.5, "x"),
                                                       encodeError(cancelledError())};
    for (int round = 0; round < 20000; ++round) {
        auto bytes = seeds[static_cast<std::size_t>(round) % seeds.size()];
        for (int change = 0; change < 1 + round % 3; ++change)
            bytes[random() % bytes.size()] = static_cast<std::byte>(random());
        if (round % 2 == 0)
            bytes.resize(random() % (bytes.size() + 1));
        (void)decodeRequest(bytes);
        (void)decodeContents(bytes);
        (void)decodeProgress(bytes);
        (void)decodeError(bytes);
        if (const auto info = decodeInfo(bytes)) {
            EXPECT_GT(pointCount(info->geometry.dims), 0);
        }
    }
}

} // namespace
} // namespace isoslider::io
