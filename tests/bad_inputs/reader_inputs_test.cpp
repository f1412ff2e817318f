// B027 to B075: files with a header. They and what their refusals state are in bad_files.cpp, and
// bad_volumes_test tries them one by one; here the program is given those of the catalogue.

#include <filesystem>

#include "tests/bad_inputs/bad_input_fixture.h"
#include "tests/unit/core/volume_io/bad_files.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class BadReader : public BadInputTest {
protected:
    void expectAllRefused(const std::vector<BadFile>& files) const {
        for (const BadFile& bad : files) {
            if (bad.label[0] != 'B')
                continue;
            SCOPED_TRACE(bad.label);
            folder_.write(bad.file, bad.bytes);
            if (!bad.companion.empty())
                folder_.write("data.raw", bad.companion);
            expectRefusedSoon({"extract", path(bad.file), "--isovalue", "1"}, bad.says);
            fs::remove(path(bad.file));
            fs::remove(path("data.raw"));
        }
    }
};

TEST_F(BadReader, RefusesEveryBadMetaImage) { expectAllRefused(badMetaImages()); }
TEST_F(BadReader, RefusesEveryBadNrrd) { expectAllRefused(badNrrds()); }
TEST_F(BadReader, RefusesEveryBadNifti) { expectAllRefused(badNiftis()); }
TEST_F(BadReader, RefusesEveryBadVtk) { expectAllRefused(badVtks()); }

TEST_F(BadReader, B032_AHeaderOf100MBWithoutALineEnd) {
    folder_.write("a.nrrd", "NRRD0004\n" + std::string(2'000'000, 'x'));
    fs::resize_file(path("a.nrrd"), 100'000'000);
    for (const auto* command : {"info", "extract"}) {
        std::vector<std::string> words{command, path("a.nrrd")};
        if (words[0] == "extract")
            words.insert(words.end(), {"--isovalue", "1"});
        expectRefusedSoon(words, "NRRD");
    }
}

TEST_F(BadReader, B033_B034_OutsideTheFolderOnlyWhenAllowed) {
    const std::string samples = ramp<std::int16_t>(24);
    fs::create_directories(path("outside/deeper"));
    fs::create_directory(path("inside"));
    folder_.write("outside/deeper/data.raw", samples);
    fs::create_directory_symlink(path("outside"), path("inside/link"));
    for (const std::string& data :
         {path("outside/deeper/data.raw"), std::string("../outside/deeper/data.raw"),
          std::string("link/deeper/data.raw"), std::string("link/../outside/deeper/data.raw")}) {
        folder_.write("inside/a.nhdr", detachedNrrd(data));
        folder_.write("inside/a.mhd", mhaHeader(data));
        for (const auto* name : {"inside/a.nhdr", "inside/a.mhd"}) {
            expectRefusedSoon({"info", path(name)}, "outside the folder");
            EXPECT_EQ(expectAcceptedSoon({"info", path(name), "--allow-external"})["dims"], OrderedJson({4, 3, 2}))
                << data;
        }
    }
}

TEST_F(BadReader, B047_LeftHandedDirectionsKeepTheOutsideOutside) {
    // A ball in a NRRD file, with each axis turned round in turn: the volume enclosed has the same sign.
    const std::string ball = readText(sphereVolume()).substr(readText(sphereVolume()).find("LOCAL\n") + 6);
    for (const auto* directions : {"(1,0,0) (0,2,0) (0,0,3)", "(-1,0,0) (0,2,0) (0,0,3)", "(1,0,0) (0,-2,0) (0,0,3)",
                                   "(0,2,0) (1,0,0) (0,0,3)", "(-1,0,0) (0,-2,0) (0,0,-3)"}) {
        folder_.write(
            "a.nrrd",
            std::string("NRRD0004\ntype: float\ndimension: 3\nspace: left-posterior-superior\nsizes: 16 16 16\n"
                        "space directions: ") +
                directions + "\nendian: little\nencoding: raw\n\n" + ball);
        const auto mesh = expectAcceptedSoon({"extract", path("a.nrrd"), "--isovalue", "5"});
        EXPECT_EQ(mesh["oriented"], true) << directions;
        EXPECT_NEAR(mesh["volume"].get<double>(), 6.0 * 4.0 / 3.0 * 3.14159265 * 125.0, 150.0) << directions;
        for (const auto* kind : {"edges", "metacells"}) {
            ASSERT_EQ(run({"build", path("a.nrrd"), "-o", path("a.isx"), "--index", kind}).exitCode, 0);
            const auto same = expectAcceptedSoon({"extract", path("a.isx"), "--isovalue", "5"});
            EXPECT_EQ(same["volume"], mesh["volume"]) << directions << ' ' << kind;
        }
    }
}

TEST_F(BadReader, B067_ASeriesIsNeverTakenForOneVolume) {
    std::string bytes = niftiHeader() + ramp<std::int16_t>(48);
    put<std::int16_t>(bytes, 40, 4);
    put<std::int16_t>(bytes, 48, 2);
    folder_.write("a.nii", bytes);
    expectRefusedSoon({"extract", path("a.nii"), "--isovalue", "5"}, "--frame 0 to 1");
    expectRefusedSoon({"build", path("a.nii"), "-o", path("a.isx")}, "--frame 0 to 1");
    EXPECT_FALSE(fs::exists(path("a.isx")));
    const auto info = expectAcceptedSoon({"info", path("a.nii"), "--frame", "1"});
    EXPECT_EQ(info["min"], 24);
    EXPECT_EQ(info["max"], 47);
}

} // namespace
} // namespace isoslider::test
