#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/grid/volume_statistics.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/test_paths.h"

namespace isoslider::io {
namespace {

const std::filesystem::path kData = std::filesystem::path(test::sharedFolder()) / "data";

struct Expected {
    const char* file;
    GridDims dims;
    const char* type;
    glm::dvec3 spacing;
    double min, max;
    std::uint64_t distinct;
    const char* format;
};

void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.file; } // NOLINT: GoogleTest's name

class SharedVolume : public testing::TestWithParam<Expected> {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(kData / GetParam().file))
            GTEST_SKIP() << "further test data is not here: " << kData / GetParam().file;
    }
};

TEST_P(SharedVolume, IsReadAsItsSourceSays) {
    const Expected& expected = GetParam();
    auto source = openVolume(kData / expected.file);
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().format, expected.format);
    const auto grid = readVolume(kData / expected.file);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->dims(), expected.dims);
    EXPECT_EQ(scalarTypeName(grid.value()->type()), expected.type);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(grid.value()->geometry().spacing[axis], expected.spacing[axis], 1e-5 * expected.spacing[axis]);
    const auto statistics = computeStatistics(*grid.value());
    ASSERT_THAT(statistics, test::IsOk());
    EXPECT_NEAR(statistics.value().min, expected.min, 1e-5 * std::abs(expected.min));
    EXPECT_NEAR(statistics.value().max, expected.max, 1e-5 * std::abs(expected.max));
    EXPECT_EQ(statistics.value().distinctValues, expected.distinct);
    EXPECT_EQ(statistics.value().nanCount, 0u);
}

const glm::dvec3 kOnes(1.0);

INSTANTIATE_TEST_SUITE_P(
    Formats, SharedVolume,
    testing::Values(
        Expected{"mha/blob0.mha", {40, 40, 40}, "u8", kOnes, 0, 255, 2, "MetaImage"},
        Expected{"mha/blob4.mha", {40, 40, 40}, "u8", kOnes, 0, 255, 2, "MetaImage"},
        Expected{"mha/fuel.mha", {68, 68, 68}, "u8", kOnes, 0, 255, 223, "MetaImage"},
        Expected{"mha/hydrogenAtom.mha", {128, 128, 128}, "u8", kOnes, 0, 250, 88, "MetaImage"},
        Expected{"mha/marschnerlobb.mha", {43, 43, 43}, "u8", kOnes, 0, 255, 256, "MetaImage"},
        Expected{"mha/neghip.mha", {70, 70, 70}, "u8", kOnes, 0, 255, 256, "MetaImage"},
        Expected{"mha/nucleon.mha", {41, 41, 41}, "u8", kOnes, 0, 249, 245, "MetaImage"},
        Expected{"mha/silicium.mha", {104, 40, 40}, "u8", kOnes, 0, 255, 244, "MetaImage"},
        Expected{"mhd/HeadMRVolume.mhd", {48, 62, 42}, "u8", {4, 4, 4}, 0, 255, 255, "MetaImage"},
        Expected{"mhd/cranium.mhd", {256, 256, 108}, "i16", {0.957031, 0.957031, 1.5}, -1024, 2986, 3443, "MetaImage"},
        Expected{"awkward/nan_seg.mha", {78, 110, 64}, "u16", kOnes, 0, 4, 5, "MetaImage"},
        Expected{"awkward/niivue_mha.mha", {64, 64, 37}, "i16", {3.4375, 3.4375, 3.8}, 0, 6690, 4773, "MetaImage"},
        Expected{"nifti/avg152T1_RL_nifti.nii.gz", {91, 109, 91}, "u8", {2, 2, 2}, 0, 255, 256, "NIfTI"},
        Expected{"nifti/mricron_ch2.nii.gz", {181, 217, 181}, "u8", kOnes, 0, 254, 249, "NIfTI"},
        Expected{"nifti/mricron_inia19-t1-brain.nii.gz",
                 {168, 206, 128},
                 "f32",
                 {0.5, 0.5, 0.5},
                 0,
                 383.176,
                 826455,
                 "NIfTI"},
        Expected{"awkward/niivue_minimal.nii.gz", {64, 64, 10}, "u8", {3, 3, 3}, 0, 63, 64, "NIfTI"},
        // Stored as u8 with a slope of 0.36: values are those after it.
        Expected{
            "awkward/space_AIL.nii.gz", {79, 67, 64}, "f32", {2.38975, 2.36649, 2.38523}, 0, 92.553886, 251, "NIfTI"},
        Expected{
            "awkward/space_RAS.nii.gz", {64, 79, 67}, "f32", {2.38523, 2.38975, 2.36649}, 0, 92.553886, 251, "NIfTI"},
        Expected{"nrrd/dcmqi_pm-example-float.nrrd",
                 {256, 256, 20},
                 "f32",
                 {0.7031, 0.7031, 2.9999},
                 0,
                 0.004095,
                 4046,
                 "NRRD"},
        Expected{"nrrd/headsq/quarter.nhdr", {64, 64, 93}, "i16", {3.2, 3.2, 1.5}, 0, 3926, 2987, "NRRD"},
        Expected{"nrrd/pyradiomics_brain1_image.nrrd",
                 {256, 256, 25},
                 "i16",
                 {0.78125, 0.78125, 6.5},
                 0,
                 3057,
                 2413,
                 "NRRD"},
        Expected{"nrrd/tooth/tooth.nhdr", {103, 94, 161}, "u16", kOnes, 0, 1300, 1289, "NRRD"},
        Expected{"vti/heart.vti", {32, 32, 12}, "f32", {1, 1, 4}, 0, 255, 254, "VTK image"},
        Expected{"vti/isabel_02.vti",
                 {125, 125, 25},
                 "f64",
                 {4.0080321286, 4.0080321286, 4.0408163266},
                 0,
                 68.2455,
                 386456,
                 "VTK image"},
        Expected{"vti/vase.vti", {115, 101, 75}, "u8", kOnes, 0, 239, 240, "VTK image"},
        Expected{"vti/viscousfingers_001.vti", {64, 64, 64}, "f32", kOnes, 0, 76.7632, 200633, "VTK image"},
        Expected{"vtk/carotid.vtk", {76, 49, 45}, "f32", kOnes, 0, 580, 490, "VTK image"},
        Expected{"vtk/heart.vtk", {32, 32, 12}, "f32", {1, 1, 4}, 0, 255, 254, "VTK image"},
        Expected{"vtk/ironProt.vtk", {68, 68, 68}, "u8", kOnes, 0, 255, 256, "VTK image"}),
    [](const auto& parameter) {
        std::string name = std::filesystem::path(parameter.param.file).filename().string();
        std::replace_if(
            name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
        return name;
    });

struct Refused {
    const char* file;
    ErrorCode code;
    const char* says;
};

TEST(SharedFiles, ThatAreNoScalarVolumesAreRefused) {
    if (!std::filesystem::exists(kData))
        GTEST_SKIP() << "further test data is not here: " << kData;
    const Refused files[] = {
        {"awkward/img4d_11f.nii.gz", ErrorCode::InvalidArgument, "has 11 frames: choose one with --frame 0 to 10"},
        {"awkward/example_nifti2.nii.gz", ErrorCode::InvalidArgument, "has 2 frames: choose one with --frame 0 to 1"},
        {"awkward/tensor_rgb.nii.gz", ErrorCode::InvalidArgument,
         "has 3 components: choose one with --component 0 to 2"},
        {"awkward/no_meta.dcm", ErrorCode::InvalidArgument, "is not DICOM"},
        {"vti/vase_4comp.vti", ErrorCode::InvalidArgument, "--component"},
        {"hdf5/openpmd_femm_3d.h5", ErrorCode::InvalidArgument, "--field"},
    };
    for (const Refused& file : files) {
        const auto grid = readVolume(kData / file.file);
        ASSERT_THAT(grid, test::HasError(file.code)) << file.file;
        EXPECT_THAT(grid.error().line(), testing::HasSubstr(file.says));
    }
}

TEST(SharedFiles, BluntFinIsResampled) {
    const auto path = kData / "plot3d/bluntfinxyz.bin";
    if (!std::filesystem::exists(path))
        GTEST_SKIP() << "further test data is not here: " << path;
    ReadOptions options;
    const auto begin = std::chrono::steady_clock::now();
    const auto grid = readVolume(path, options);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->dims(), (GridDims{256, 256, 256}));
    const auto statistics = computeStatistics(*grid.value());
    ASSERT_THAT(statistics, test::IsOk());
    EXPECT_GT(statistics.value().min, 0.19);
    EXPECT_LT(statistics.value().max, 4.98);
    EXPECT_GT(statistics.value().nanCount, 0u);
    RecordProperty("seconds", std::to_string(elapsed.count()));
    std::cout << elapsed.count() << " s, " << statistics.value().nanCount << " missing of "
              << pointCount(grid.value()->dims()) << "\n";
    EXPECT_LT(elapsed.count(), 60.0);

    options.field = "energy";
    options.resampleDims = {40, 30, 20};
    const auto energy = readVolume(kData / "plot3d/bluntfinq.bin", options);
    ASSERT_THAT(energy, test::IsOk());
    EXPECT_EQ(energy.value()->dims(), options.resampleDims);
    EXPECT_LT(computeStatistics(*energy.value()).value().max, 25.17);
}

struct Mesh {
    const char* file;
    const char* format;
    std::int64_t points;
    double min, max; ///< of the values at them
};

TEST(SharedFiles, OfOtherGridsAreResampled) {
    const Mesh meshes[] = {{"vtk/RectGrid2.vtk", "VTK rectilinear grid", 47 * 33 * 11, 0, 10.3964},
                           {"vtk/SampleStructGrid.vtk", "VTK structured grid", 20 * 30 * 40, 0, 1.30456},
                           {"vtk/post.vtk", "VTK unstructured grid", 2288, 0.355368, 1.64124}};
    for (const Mesh& mesh : meshes) {
        const auto path = kData / mesh.file;
        if (!std::filesystem::exists(path))
            GTEST_SKIP() << "further test data is not here: " << path;
        const auto source = openVolume(path);
        ASSERT_THAT(source, test::IsOk());
        EXPECT_EQ(source.value()->info().format, mesh.format);
        VolumeSource* whole = source.value().get();
        const GridDims dims = whole->info().geometry.dims;
        EXPECT_GT(static_cast<double>(pointCount(dims)), 0.85 * static_cast<double>(mesh.points));
        if (std::string_view(mesh.format) != "VTK rectilinear grid") { // those are as fine as their nearest points
            EXPECT_LT(static_cast<double>(pointCount(dims)), 1.15 * static_cast<double>(mesh.points));
        }
        std::vector<float> samples(static_cast<std::size_t>(pointCount(dims)));
        ASSERT_THAT(whole->readSlab(0, dims[2], std::as_writable_bytes(std::span(samples))), test::IsOk());
        const auto report = whole->info().resampling;
        ASSERT_TRUE(report.has_value());
        EXPECT_EQ(report->sourcePoints, mesh.points);
        EXPECT_GT(report->comparedPoints, mesh.points / 3);
        EXPECT_LT(report->rmsDifference, 0.2 * (mesh.max - mesh.min));
        for (const float sample : samples)
            if (!std::isnan(sample)) {
                EXPECT_GE(sample, mesh.min - 1e-4);
                EXPECT_LE(sample, mesh.max + 1e-4);
            }
        std::cout << mesh.file << " " << dims[0] << "x" << dims[1] << "x" << dims[2] << ": " << report->comparedPoints
                  << " compared, max " << report->maxDifference << ", rms " << report->rmsDifference << ", "
                  << report->rangeFraction << " of the range, " << report->outsidePoints << " outside\n";
    }
}

TEST(SharedFiles, OrientationsOfOneBrainAgreeInSpace) {
    // The same head stored with its axes in two orders lies in the same place.
    const char* names[] = {"awkward/space_RAS.nii.gz", "awkward/space_AIL.nii.gz"};
    std::vector<glm::dvec3> centres;
    for (const char* name : names) {
        if (!std::filesystem::exists(kData / name))
            GTEST_SKIP() << "further test data is not here: " << kData / name;
        const auto grid = readVolume(kData / name);
        ASSERT_THAT(grid, test::IsOk());
        const GridDims& dims = grid.value()->dims();
        glm::dvec3 sum(0.0);
        double weight = 0.0;
        for (std::int64_t z = 0; z < dims[2]; ++z)
            for (std::int64_t y = 0; y < dims[1]; ++y)
                for (std::int64_t x = 0; x < dims[0]; ++x) {
                    const double value = grid.value()->valueAt(x, y, z);
                    sum += value * glm::dvec3(grid.value()->geometry().indexToWorld() * glm::dvec4(x, y, z, 1));
                    weight += value;
                }
        centres.push_back(sum / weight);
    }
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(centres[0][axis], centres[1][axis], 0.5);
}

} // namespace
} // namespace isoslider::io
