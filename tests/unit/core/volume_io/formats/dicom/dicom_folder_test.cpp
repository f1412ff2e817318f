// Slices of folders: distinguished, sorted, made one volume.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/formats/dicom/dicom_bytes.h"

namespace isoslider::io {
namespace {

using test::DicomElements;
using test::dicomFile;
using test::dicomSlice;
using testing::Contains;
using testing::HasSubstr;
using enum ErrorCode;

DicomElements filled(double z, int instance, int value) {
    return dicomSlice(z, instance, [value](int, int) { return value; });
}

class DicomFolder : public testing::Test {
protected:
    void add(const std::string& name, const DicomElements& elements) { folder_.write(name, dicomFile(elements)); }

    std::shared_ptr<const ScalarGrid> read(const ReadOptions& options = {}) {
        auto grid = readVolume(folder_.path(), options);
        EXPECT_THAT(grid, test::IsOk());
        return grid.isOk() ? grid.value() : std::make_shared<const ScalarGrid>();
    }
    std::vector<std::string> notes(const ReadOptions& options = {}) {
        const auto source = openVolume(folder_.path(), options);
        EXPECT_THAT(source, test::IsOk());
        return source.isOk() ? source.value()->info().notes : std::vector<std::string>();
    }
    std::string refusal(const ReadOptions& options = {}) {
        const auto grid = readVolume(folder_.path(), options);
        EXPECT_FALSE(grid.isOk());
        return grid.isOk() ? "" : grid.error().line();
    }
    VolumeContents contents() {
        auto listed = listVolumes(folder_.path());
        EXPECT_THAT(listed, test::IsOk());
        return listed.isOk() ? listed.value() : VolumeContents();
    }

    test::TemporaryFolder folder_;
};

TEST_F(DicomFolder, IsSortedByPositionWithTheSpacingOfThePositions) {
    add("a", filled(7.0, 1, 30));
    add("b", filled(4.5, 3, 20));
    add("c", filled(2.0, 2, 10));
    const auto grid = read();
    const GridGeometry& geometry = grid->geometry();
    EXPECT_EQ(grid->dims(), (GridDims{8, 6, 3}));
    EXPECT_EQ(geometry.spacing, glm::dvec3(0.5, 0.75, 2.5)); // not the thickness of 9
    EXPECT_EQ(geometry.origin, glm::dvec3(10, 20, 2));
    EXPECT_EQ(grid->type(), ScalarType::I16);
    for (int z = 0; z < 3; ++z)
        EXPECT_EQ(grid->valueAt(3, 2, z), 10 * (z + 1));
    EXPECT_THAT(notes(), Contains(HasSubstr("in the order of their positions")));
    const auto source = openVolume(folder_.path());
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().lengthUnit, "mm");
    EXPECT_TRUE(source.value()->info().isPatientSpace);
    EXPECT_EQ(source.value()->info().fieldName, "1.2.3");
    EXPECT_EQ(source.value()->info().fieldTitle, listVolumes(folder_.path()).value().fields[0].title);
    EXPECT_THAT(source.value()->info().fieldTitle, HasSubstr("probe, MR"));
}

TEST_F(DicomFolder, WithoutPixelSpacingIsInNoUnit) {
    add("a", filled(7.0, 1, 30).without(0x00280030));
    add("b", filled(4.5, 3, 20).without(0x00280030));
    const auto source = openVolume(folder_.path());
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().lengthUnit, "");
    EXPECT_THAT(source.value()->info().notes, Contains(HasSubstr("no pixel spacing")));
}

TEST_F(DicomFolder, TakesTheDirectionOfObliqueSlices) {
    for (int i = 0; i < 3; ++i) {
        auto slice = filled(0, i, i);
        slice.text(0x00200037, "DS", "0\\0.6\\0.8\\0\\-0.8\\0.6"); // normal: x
        slice.text(0x00200032, "DS", std::to_string(5 - 2 * i) + "\\7\\8");
        add(std::to_string(i), slice);
    }
    const auto grid = read();
    const glm::dmat3& direction = grid->geometry().direction;
    EXPECT_NEAR(glm::length(direction[0] - glm::dvec3(0, 0.6, 0.8)), 0.0, 1e-12);
    EXPECT_NEAR(glm::length(direction[2] - glm::dvec3(1, 0, 0)), 0.0, 1e-12);
    EXPECT_FALSE(grid->geometry().isLeftHanded());
    EXPECT_EQ(grid->geometry().origin, glm::dvec3(1, 7, 8));
    EXPECT_EQ(grid->valueAt(0, 0, 0), 2);
}

TEST_F(DicomFolder, AppliesWholeSlopeAndInterceptToIntegers) {
    auto slice = dicomSlice(0, 1);
    slice.text(0x00281053, "DS", "1").text(0x00281052, "DS", "-1024");
    slice.number(0x00280101, "US", 12).number(0x00280102, "US", 11);
    add("a", slice);
    EXPECT_EQ(read()->type(), ScalarType::I16); // 12 bits stored fit
    EXPECT_EQ(read()->valueAt(7, 5, 0), 57 - 1024);
    slice.number(0x00280101, "US", 16).number(0x00280102, "US", 15);
    add("a", slice);
    EXPECT_EQ(read()->type(), ScalarType::I32); // 16 may not
    EXPECT_EQ(read()->valueAt(7, 5, 0), 57 - 1024);
}

TEST_F(DicomFolder, AppliesAFractionalIntercept) {
    auto slice = filled(0, 1, 100);
    slice.text(0x00281053, "DS", "1").text(0x00281052, "DS", "-0.25");
    add("a", slice);
    const auto grid = read();
    EXPECT_EQ(grid->type(), ScalarType::F32);
    EXPECT_EQ(grid->valueAt(0, 0, 0), 99.75);
}

TEST_F(DicomFolder, AppliesSlopesThatDifferFromSliceToSlice) {
    for (int i = 0; i < 2; ++i) {
        auto slice = filled(i, i, 100);
        slice.text(0x00281053, "DS", i == 0 ? "0.5" : "0.25").text(0x00281052, "DS", "1");
        add(std::to_string(i), slice);
    }
    const auto grid = read();
    EXPECT_EQ(grid->type(), ScalarType::F32);
    EXPECT_EQ(grid->valueAt(0, 0, 0), 51.0);
    EXPECT_EQ(grid->valueAt(0, 0, 1), 26.0);
}

TEST_F(DicomFolder, WithSeveralSeriesNeedsAChoice) {
    add("a", filled(0, 1, 1));
    auto other = filled(0, 2, 2);
    other.text(0x0020000e, "UI", "1.2.4").text(0x0008103e, "LO", "second");
    add("b", other);
    EXPECT_THAT(refusal(),
                testing::AllOf(HasSubstr("--field"), HasSubstr("1.2.3' (probe"), HasSubstr("1.2.4' (second")));
    ReadOptions options;
    options.field = "1.2.4";
    EXPECT_EQ(read(options)->valueAt(0, 0, 0), 2);
    options.field = "1.2";
    EXPECT_THAT(refusal(options), HasSubstr("there is none named '1.2'"));
    const auto listed = contents();
    ASSERT_EQ(listed.fields.size(), 2u);
    EXPECT_EQ(listed.fields[0].title, "probe, MR, 1 axial slice of 8 x 6, 2024-01-31");
    EXPECT_EQ(listed.fields[0].typeName, "int16");
    EXPECT_TRUE(listed.needsChoice());
}

TEST_F(DicomFolder, ListsSeriesByTheirNumbersButTellsThemApartByTheirUids) {
    for (int i = 0; i < 3; ++i) {
        auto slice = filled(i, i, i);
        slice.text(0x00200011, "IS", std::to_string(7 + i)); // not quite as it should be
        add("a" + std::to_string(i), slice);
    }
    auto first = filled(0, 9, 9);
    first.text(0x0020000e, "UI", "1.2.9").text(0x00200011, "IS", "2");
    add("z", first);
    const auto listed = contents();
    ASSERT_EQ(listed.fields.size(), 2u);
    EXPECT_EQ(listed.fields[0].name, "1.2.9");
    EXPECT_EQ(listed.fields[1].name, "1.2.3");
    EXPECT_EQ(listed.fields[1].dims[2], 3);
}

TEST_F(DicomFolder, B075_WithAMissingSliceIsRefusedNamingThePlace) {
    for (const int z : {0, 1, 2, 4, 5})
        add("slice" + std::to_string(z), filled(z, z, z));
    EXPECT_THAT(refusal(),
                HasSubstr("slices are missing: 1 between 'slice2' and 'slice4', 2 mm apart where others are 1"));
    EXPECT_THAT(contents().fields[0].problem, HasSubstr("missing"));
}

TEST_F(DicomFolder, OfUnevenSlicesIsInterpolatedToEvenOnes) {
    // 1 mm apart below, 2.5 above, as heads are scanned.
    for (const double z : {0.0, 1.0, 2.0, 3.0, 5.5, 8.0, 10.5})
        add("slice" + std::to_string(z), filled(z, static_cast<int>(10 * z), static_cast<int>(100 * z)));
    EXPECT_TRUE(contents().fields[0].isResampled);
    const auto grid = read();
    EXPECT_EQ(grid->dims(), (GridDims{8, 6, 11}));
    EXPECT_EQ(contents().fields[0].dims, grid->dims());
    EXPECT_EQ(grid->geometry().spacing.z, 1.0);
    EXPECT_EQ(grid->type(), ScalarType::F32);
    for (int z = 0; z < 11; ++z)
        EXPECT_NEAR(grid->valueAt(3, 4, z), 100.0 * z, 1e-3) << z;
    EXPECT_THAT(notes(), Contains(HasSubstr("1 to 2.5 mm apart: linearly interpolated to 11")));
    // In any order of slabs.
    const auto source = openVolume(folder_.path());
    ASSERT_THAT(source, test::IsOk());
    for (const int z : {7, 2, 9, 4}) {
        std::vector<float> plane(48);
        ASSERT_THAT(source.value()->readSlab(z, z + 1, std::as_writable_bytes(std::span(plane))), test::IsOk());
        EXPECT_NEAR(plane[5], 100.0 * z, 1e-3);
    }
}

TEST_F(DicomFolder, OfUnevenSlicesThatAreMovedSidewaysIsRefused) {
    for (const double z : {0.0, 1.0, 2.3, 3.3}) {
        auto slice = filled(z, static_cast<int>(10 * z), 1);
        slice.text(0x00200032, "DS", "10\\" + std::to_string(20 + z) + "\\" + std::to_string(z));
        add("slice" + std::to_string(z), slice);
    }
    EXPECT_THAT(refusal(), HasSubstr("unevenly spaced and moved sideways"));
}

TEST_F(DicomFolder, NotesWhatIsNearlyEven) {
    for (const double z : {0.0, 1.04, 2.0, 3.0})
        add("slice" + std::to_string(z), filled(z, static_cast<int>(10 * z), 1));
    EXPECT_EQ(read()->geometry().spacing.z, 1.0);
    EXPECT_THAT(notes(), Contains(HasSubstr("up to 0.04 mm away")));
}

TEST_F(DicomFolder, B075_LeavesCopiesOutAndRefusesSlicesThatContradictEachOther) {
    for (const int z : {0, 1, 2})
        add(std::to_string(z), filled(z, z, z));
    add("copy", filled(1, 1, 1));
    EXPECT_EQ(read()->dims()[2], 3);
    EXPECT_THAT(notes(), Contains(HasSubstr("1 slice left out, copies")));
    add("another", filled(1, 7, 1));
    EXPECT_THAT(refusal(), HasSubstr("lie at the same place"));
}

TEST_F(DicomFolder, OffersASliceOfAnotherSizeApart) {
    for (const int z : {0, 1, 2})
        add(std::to_string(z), filled(z, z, z));
    auto odd = filled(3, 3, 3);
    odd.number(0x00280010, "US", 5);
    add("3", odd);
    EXPECT_THAT(refusal(), HasSubstr("the file has 2"));
    ReadOptions options;
    options.field = "1.2.3#1";
    EXPECT_EQ(read(options)->dims(), (GridDims{8, 6, 3}));
    options.field = "1.2.3#2";
    EXPECT_EQ(read(options)->dims(), (GridDims{8, 5, 1}));
}

TEST_F(DicomFolder, MakesEchoesFramesOfOneSeries) {
    for (int i = 0; i < 6; ++i) {
        auto slice = filled(i / 2, i, 10 * (i % 2) + i / 2);
        slice.text(0x00180081, "DS", i % 2 == 0 ? "12.5" : "4.5"); // rising echo time: odd ones first
        add(std::to_string(i), slice);
    }
    ASSERT_EQ(contents().fields.size(), 1u);
    EXPECT_EQ(contents().fields[0].frames, 2);
    EXPECT_THAT(contents().fields[0].title, HasSubstr("2 echo times"));
    EXPECT_THAT(refusal(), HasSubstr("--frame 0 to 1"));
    ReadOptions options;
    options.frame = 0;
    EXPECT_EQ(read(options)->valueAt(0, 0, 2), 12);
    options.frame = 1;
    EXPECT_EQ(read(options)->valueAt(0, 0, 2), 2);
    options.frame = 2;
    EXPECT_THAT(refusal(options), HasSubstr("--frame 2"));
}

TEST_F(DicomFolder, TellsRepeatedSlicesApartByTheirOrderIfByNothingElse) {
    for (int i = 0; i < 6; ++i)
        add(std::to_string(i), filled(i % 3, i, i));
    ReadOptions options;
    options.frame = 1;
    EXPECT_EQ(read(options)->valueAt(0, 0, 0), 3);
    EXPECT_THAT(notes(options), Contains(HasSubstr("by their instance number only")));
}

// A field that is linear in space stays what it is when the slices are moved back.
TEST_F(DicomFolder, UndoesTheTiltOfAGantry) {
    const auto field = [](double x, double y, double z) { return 8 * x + 16 * y + 4 * z; };
    for (int i = 0; i < 4; ++i) {
        const double y0 = 20 + 0.3 * i, z = 2 * i;
        auto slice = dicomSlice(z, i, [&](int x, int y) {
            return static_cast<int>(std::lround(10 * field(10 + 0.5 * x, y0 + 0.75 * y, z)));
        });
        slice.text(0x00200032, "DS", "10\\" + std::to_string(y0) + "\\" + std::to_string(z));
        add(std::to_string(i), slice);
    }
    EXPECT_TRUE(contents().fields[0].isResampled);
    const auto grid = read();
    const GridGeometry& geometry = grid->geometry();
    EXPECT_EQ(grid->type(), ScalarType::F32);
    EXPECT_EQ(grid->dims(), (GridDims{8, 8, 4})); // 0.9 mm more, of 0.75 each
    EXPECT_EQ(contents().fields[0].dims, grid->dims());
    EXPECT_EQ(geometry.direction, glm::dmat3(1.0));
    EXPECT_EQ(geometry.spacing.z, 2.0);
    int missing = 0;
    for (int z = 0; z < 4; ++z)
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                const glm::dvec3 place = geometry.origin + geometry.spacing * glm::dvec3(x, y, z);
                const double value = grid->valueAt(x, y, z);
                const bool isInside = place.y >= 20 + 0.3 * z - 1e-9 && place.y <= 20 + 0.3 * z + 5 * 0.75 + 1e-9;
                EXPECT_EQ(std::isnan(value), !isInside) << x << ' ' << y << ' ' << z;
                missing += std::isnan(value);
                if (isInside) {
                    EXPECT_NEAR(value, 10 * field(place.x, place.y, place.z), 0.51);
                }
            }
    EXPECT_GT(missing, 0);
    EXPECT_THAT(notes(), Contains(HasSubstr("the gantry was tilted by 8.5")));
}

TEST_F(DicomFolder, RefusesSlicesThatAreMovedSideways) {
    for (int i = 0; i < 4; ++i) {
        auto slice = filled(i, i, i);
        slice.text(0x00200032, "DS", "10\\" + std::to_string(20 + (i == 1) * 3) + "\\" + std::to_string(i));
        add(std::to_string(i), slice);
    }
    EXPECT_THAT(refusal(), HasSubstr("slice '1' is moved sideways"));
}

TEST_F(DicomFolder, NamesTheSliceThatIsMovedSideways) {
    // Unevenly spaced, or the last one: neither may make another slice look moved.
    const std::vector<std::pair<std::vector<double>, int>> cases = {
        {{0, 1, 2, 3, 4}, 4}, {{0, 1, 2, 3, 4}, 0}, {{0, 1, 2.4, 3.1, 4.8, 5.9}, 3}};
    for (const auto& [places, moved] : cases) {
        const test::TemporaryFolder folder;
        for (int i = 0; i < static_cast<int>(places.size()); ++i) {
            const double z = places[static_cast<std::size_t>(i)];
            auto slice = filled(z, i, i);
            slice.text(0x00200032, "DS", "10\\" + std::to_string(20 + (i == moved) * 3) + "\\" + std::to_string(z));
            folder.write(std::to_string(i), dicomFile(slice));
        }
        const auto grid = readVolume(folder.path());
        ASSERT_FALSE(grid.isOk());
        EXPECT_THAT(grid.error().message, HasSubstr("slice '" + std::to_string(moved) + "' is moved sideways"));
    }
}

TEST_F(DicomFolder, OfSlicesAtAnyDistanceLacksNone) {
    for (const double z : {0.0, 1.0, 2.0, 4.0, 5.5}) // 2 mm is twice 1 mm, but 1.5 mm is no multiple
        add("slice" + std::to_string(z), filled(z, static_cast<int>(10 * z), static_cast<int>(100 * z)));
    EXPECT_THAT(notes(), Contains(HasSubstr("1 to 2 mm apart: linearly interpolated")));
}

TEST_F(DicomFolder, LeavesOutWhatCannotBeRead) {
    for (const int z : {0, 1, 2})
        add(std::to_string(z), filled(z, z, z));
    folder_.write("notes.txt", "no DICOM");
    folder_.write("cut", dicomFile(filled(3, 3, 3)).substr(0, 400));
    EXPECT_EQ(read()->dims()[2], 3);
    EXPECT_THAT(notes(), Contains(HasSubstr("2 files are left out; the first: 'cut'")));
}

TEST_F(DicomFolder, OfOtherFilesIsNoVolume) {
    folder_.write("notes.txt", "no DICOM");
    EXPECT_THAT(refusal(), HasSubstr("is a folder without slices"));
}

TEST_F(DicomFolder, WithoutPositionsFollowsTheInstanceNumbers) {
    for (int i = 0; i < 3; ++i) {
        auto slice = filled(0, i, i);
        slice.without(0x00200032).without(0x00200037);
        add(std::to_string(9 - i), slice);
    }
    const auto grid = read();
    EXPECT_EQ(grid->valueAt(0, 0, 2), 2);
    EXPECT_EQ(grid->geometry().spacing.z, 9.0); // the thickness is all there is
    EXPECT_THAT(notes(), Contains(HasSubstr("no position")));
}

} // namespace
} // namespace isoslider::io
