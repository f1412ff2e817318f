// The unit of spacing and origin, format by format; DICOM, TIFF, NetCDF and HDF5 where their own tests are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::io {
namespace {

using test::put;
using test::replaced;

class LengthUnits : public testing::Test {
protected:
    VolumeInfo info(const char* name, const std::string& bytes, const ReadOptions& options = {}) {
        const auto source = openVolume(folder.write(name, bytes), options);
        EXPECT_THAT(source, test::IsOk());
        return source.isOk() ? source.value()->info() : VolumeInfo();
    }
    std::string unit(const char* name, const std::string& bytes) { return info(name, bytes).lengthUnit; }
    test::TemporaryFolder folder;
};

TEST_F(LengthUnits, MetaImageSaysItInDistanceUnits) {
    const auto with = [](const char* line) {
        return replaced(test::mha(), "NDims = 3\n", std::string("NDims = 3\n") + line);
    };
    EXPECT_EQ(unit("a.mha", test::mha()), "");
    EXPECT_EQ(unit("a.mha", with("DistanceUnits = mm\n")), "mm");
    EXPECT_EQ(unit("a.mha", with("DistanceUnits = um\n")), "µm");
    EXPECT_EQ(unit("a.mha", with("DistanceUnits = ?\n")), "");
}

TEST_F(LengthUnits, NrrdSaysItOfSpaceOrOfEachAxis) {
    const auto with = [](const std::string& lines) { return replaced(test::nrrd(), "\n\n", "\n" + lines + "\n\n"); };
    EXPECT_EQ(unit("a.nrrd", test::nrrd()), "");
    EXPECT_EQ(unit("a.nrrd", with("units: \"mm\" \"mm\" \"mm\"")), "mm");
    EXPECT_EQ(unit("a.nrrd", with("units: \"mm\" \"mm\" \"cm\"")), "");
    EXPECT_EQ(unit("a.nrrd", with("units: \"mm\" \"mm\"")), "") << "of two axes of three";
    EXPECT_EQ(unit("a.nrrd", with("units: \"mm\" \"mm\" \"m\x1bm\"")), "");
    const auto oriented = [](const std::string& units) {
        return "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\n"
               "space directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\ncontent: a head\n" +
               units + "\n\n12345678";
    };
    EXPECT_EQ(unit("b.nrrd", oriented("space units: \"micron\" \"micron\" \"micron\"")), "µm");
    EXPECT_EQ(unit("b.nrrd", oriented("space units: \"\" \"\" \"\"")), "");
    EXPECT_EQ(info("b.nrrd", oriented("space units: \"mm\" \"mm\" \"mm\"")).fieldTitle, "a head");
}

TEST_F(LengthUnits, NiftiIsInMillimetresWhereItsCodeIsKnown) {
    const auto with = [](char code) {
        std::string bytes = test::nifti();
        bytes[123] = code;
        return bytes;
    };
    EXPECT_EQ(unit("a.nii", with(0)), "");
    for (const char code : {1, 2, 3, 2 + 8})
        EXPECT_EQ(unit("a.nii", with(code)), "mm") << int(code);
    EXPECT_EQ(info("a.nii", with(3)).geometry.spacing.y, 0.001 * info("a.nii", with(2)).geometry.spacing.y);
}

TEST_F(LengthUnits, MrcIsInAngstromIfItHasACell) {
    std::string header(1024, '\0');
    for (std::size_t axis = 0; axis < 3; ++axis) {
        put<std::int32_t>(header, 4 * axis, 2);
        put<std::int32_t>(header, 28 + 4 * axis, 2);
        put<float>(header, 40 + 4 * axis, 3.0f);
        put<float>(header, 52 + 4 * axis, 90.0f);
        put<std::int32_t>(header, 64 + 4 * axis, static_cast<std::int32_t>(axis) + 1);
    }
    std::memcpy(header.data() + 208, "MAP DD", 6);
    EXPECT_EQ(unit("a.mrc", header + "12345678"), "Å");
    put<float>(header, 44, 0.0f);
    EXPECT_EQ(unit("a.mrc", header + "12345678"), "") << "a spacing is assumed";
}

TEST_F(LengthUnits, RawSaysNone) {
    ReadOptions options;
    options.raw = RawLayout{};
    options.raw->dims = {2, 2, 2};
    EXPECT_EQ(info("a.raw", "12345678", options).lengthUnit, "");
}

} // namespace
} // namespace isoslider::io
