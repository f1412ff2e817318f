#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkHexahedron.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkRectilinearGrid.h>
#include <vtkRectilinearGridWriter.h>
#include <vtkStructuredGrid.h>
#include <vtkStructuredGridWriter.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridWriter.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLRectilinearGridWriter.h>
#include <vtkXMLStructuredGridWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::io {
namespace {

using testing::HasSubstr;

// Small grids of each kind, made with VTK, that carry two fields linear in space: resampling must be exact.

double scalarAt(const double* p) { return 2 * p[0] - p[1] + 3 * p[2] + 1; }

void addFields(vtkDataSet& data) {
    const vtkNew<vtkDoubleArray> scalars;
    const vtkNew<vtkFloatArray> vectors;
    scalars->SetName("s");
    vectors->SetName("v");
    vectors->SetNumberOfComponents(3);
    for (vtkIdType i = 0; i < data.GetNumberOfPoints(); ++i) {
        double p[3];
        data.GetPoint(i, p);
        scalars->InsertNextValue(scalarAt(p));
        vectors->InsertNextTuple3(p[0], p[1], p[2]);
    }
    data.GetPointData()->AddArray(vectors);
    data.GetPointData()->SetScalars(scalars);
}

vtkSmartPointer<vtkImageData> image() {
    auto data = vtkSmartPointer<vtkImageData>::New();
    data->SetExtent(1, 4, 0, 2, 0, 3);
    data->SetSpacing(1, 2, 0.5);
    addFields(*data);
    return data;
}

vtkSmartPointer<vtkRectilinearGrid> rectilinear(bool isEven) {
    auto data = vtkSmartPointer<vtkRectilinearGrid>::New();
    const auto axis = [](std::initializer_list<double> places) {
        auto array = vtkSmartPointer<vtkDoubleArray>::New();
        for (const double place : places)
            array->InsertNextValue(place);
        return array;
    };
    data->SetDimensions(4, 3, 2);
    data->SetXCoordinates(isEven ? axis({1, 3, 5, 7}) : axis({1, 2, 6, 7}));
    data->SetYCoordinates(axis({-1, 0, 1}));
    data->SetZCoordinates(axis({10, 14}));
    addFields(*data);
    return data;
}

vtkSmartPointer<vtkStructuredGrid> sheared() {
    auto data = vtkSmartPointer<vtkStructuredGrid>::New();
    const vtkNew<vtkPoints> points;
    for (int k = 0; k < 4; ++k)
        for (int j = 0; j < 5; ++j)
            for (int i = 0; i < 6; ++i)
                points->InsertNextPoint(i + 0.5 * k, j, k + 0.1 * i);
    data->SetDimensions(6, 5, 4);
    data->SetPoints(points);
    addFields(*data);
    return data;
}

/// Hexahedra, of which one is split into a wedge pair, and a triangle that has no volume.
vtkSmartPointer<vtkUnstructuredGrid> cells() {
    auto data = vtkSmartPointer<vtkUnstructuredGrid>::New();
    const vtkNew<vtkPoints> points;
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 4; ++i)
                points->InsertNextPoint(i, j, k);
    data->SetPoints(points);
    for (vtkIdType i = 0; i < 2; ++i) {
        const vtkIdType corners[8] = {i, i + 1, i + 5, i + 4, i + 8, i + 9, i + 13, i + 12};
        data->InsertNextCell(VTK_HEXAHEDRON, 8, corners);
    }
    const vtkIdType wedge[6] = {2, 3, 6, 10, 11, 14}; // the other half stays empty
    data->InsertNextCell(VTK_WEDGE, 6, wedge);
    const vtkIdType triangle[3] = {0, 1, 4};
    data->InsertNextCell(VTK_TRIANGLE, 3, triangle);
    addFields(*data);
    return data;
}

/// How a file is written.
struct Way {
    const char* name;
    bool isXml;
    bool isText;
    bool isAppended;
    bool isPacked;
    int legacyVersion;
};
void PrintTo(const Way& way, std::ostream* out) { *out << way.name; } // NOLINT: GoogleTest's name

template <class XmlWriter, class LegacyWriter>
std::filesystem::path written(vtkDataObject* data, const std::filesystem::path& folder, const char* suffix,
                              const Way& way) {
    const std::filesystem::path path = folder / (std::string("a") + (way.isXml ? suffix : ".vtk"));
    if (way.isXml) {
        const vtkNew<XmlWriter> writer;
        writer->SetInputData(data);
        writer->SetFileName(path.c_str());
        if (way.isText)
            writer->SetDataModeToAscii();
        else if (way.isAppended)
            writer->SetDataModeToAppended();
        else
            writer->SetDataModeToBinary();
        writer->SetEncodeAppendedData(false);
        if (way.isPacked)
            writer->SetCompressorTypeToZLib();
        else
            writer->SetCompressorTypeToNone();
        EXPECT_EQ(writer->Write(), 1);
        return path;
    }
    const vtkNew<LegacyWriter> writer;
    writer->SetInputData(data);
    writer->SetFileName(path.c_str());
    writer->SetFileVersion(way.legacyVersion);
    if (way.isText)
        writer->SetFileTypeToASCII();
    else
        writer->SetFileTypeToBinary();
    EXPECT_EQ(writer->Write(), 1);
    return path;
}

class VtkGrids : public testing::TestWithParam<Way> {
protected:
    std::filesystem::path file(vtkRectilinearGrid* data) const {
        return written<vtkXMLRectilinearGridWriter, vtkRectilinearGridWriter>(data, folder.path(), ".vtr", GetParam());
    }
    std::filesystem::path file(vtkStructuredGrid* data) const {
        return written<vtkXMLStructuredGridWriter, vtkStructuredGridWriter>(data, folder.path(), ".vts", GetParam());
    }
    std::filesystem::path file(vtkUnstructuredGrid* data) const {
        return written<vtkXMLUnstructuredGridWriter, vtkUnstructuredGridWriter>(data, folder.path(), ".vtu",
                                                                                GetParam());
    }
    static Result<std::shared_ptr<const ScalarGrid>> read(const std::filesystem::path& path, ReadOptions options = {}) {
        testing::internal::CaptureStderr();
        auto grid = readVolume(path, options);
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        return grid;
    }
    /// Every sample that is there is what `value` states of its place; the number of those.
    template <class Value>
    static int expectField(const ScalarGrid& grid, const Value& value) {
        int count = 0;
        const auto& [dims, spacing, origin, direction] = grid.geometry();
        for (int z = 0; z < dims[2]; ++z)
            for (int y = 0; y < dims[1]; ++y)
                for (int x = 0; x < dims[0]; ++x) {
                    const glm::dvec3 at = origin + spacing * glm::dvec3(x, y, z);
                    const double p[3] = {at.x, at.y, at.z};
                    const double sample = grid.valueAt(x, y, z);
                    count += !std::isnan(sample);
                    if (!std::isnan(sample) && std::abs(sample - value(p)) > 1e-4)
                        ADD_FAILURE() << x << " " << y << " " << z << ": " << sample << ", not " << value(p);
                }
        return count;
    }
    test::TemporaryFolder folder;
};

INSTANTIATE_TEST_SUITE_P(
    Ways, VtkGrids,
    testing::Values(Way{"XmlText", true, true, false, false, 0}, Way{"XmlBinary", true, false, false, false, 0},
                    Way{"XmlBinaryPacked", true, false, false, true, 0},
                    Way{"XmlAppended", true, false, true, false, 0},
                    Way{"XmlAppendedPacked", true, false, true, true, 0}, Way{"Text42", false, true, false, false, 42},
                    Way{"Binary42", false, false, false, false, 42}, Way{"Text51", false, true, false, false, 51},
                    Way{"Binary51", false, false, false, false, 51}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

TEST_P(VtkGrids, TakeEvenRectilinearOnesAsTheyAre) {
    const auto path = file(rectilinear(true));
    const auto grid = read(path);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->type(), ScalarType::F64);
    EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(2, 1, 4));
    EXPECT_EQ(grid.value()->geometry().origin, glm::dvec3(1, -1, 10));
    EXPECT_EQ(expectField(*grid.value(), scalarAt), 24);
    const auto contents = listVolumes(path);
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_EQ(contents.value().format, "VTK rectilinear grid");
    EXPECT_FALSE(contents.value().fields[0].isResampled);
}

TEST_P(VtkGrids, ResampleUnevenRectilinearOnes) {
    const auto path = file(rectilinear(false));
    ReadOptions options;
    options.resampleDims = {13, 5, 3};
    const auto grid = read(path, options);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->type(), ScalarType::F32);
    EXPECT_EQ(expectField(*grid.value(), scalarAt), 13 * 5 * 3);
    const auto contents = listVolumes(path);
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_TRUE(contents.value().fields[0].isResampled);
    EXPECT_EQ(contents.value().fields[0].dims, (GridDims{7, 3, 2})) << "a place at 1, 2 ... 7";
    EXPECT_EQ(contents.value().fields[0].dims, read(path).value()->dims()) << "what is listed is what is made";
    EXPECT_EQ(listVolumes(path, options).value().fields[0].dims, options.resampleDims);
}

TEST_P(VtkGrids, ResampleStructuredOnes) {
    const auto path = file(sheared());
    ReadOptions options;
    options.resampleDims = {27, 9, 15};
    const auto grid = read(path, options);
    ASSERT_THAT(grid, test::IsOk());
    const int inside = expectField(*grid.value(), scalarAt);
    EXPECT_GT(inside, 27 * 9 * 15 / 2);
    EXPECT_LT(inside, 27 * 9 * 15);
    const auto contents = listVolumes(path);
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_TRUE(contents.value().fields[0].isResampled);
    EXPECT_EQ(contents.value().fields[0].dims, read(path).value()->dims()) << "what is listed is what is made";
}

TEST_P(VtkGrids, TakeStructuredOnesThatAreUniformAsTheyAre) {
    // Single precision, far from the origin: the places are rounded. i runs along y, j backwards along x.
    const vtkNew<vtkPoints> points;
    points->SetDataTypeToFloat();
    for (int k = 0; k < 4; ++k)
        for (int j = 0; j < 5; ++j)
            for (int i = 0; i < 6; ++i)
                points->InsertNextPoint(100 - 0.2 * j, 0.3 * i, 0.1 * k);
    auto data = vtkSmartPointer<vtkStructuredGrid>::New();
    data->SetDimensions(6, 5, 4);
    data->SetPoints(points);
    addFields(*data);
    const auto path = file(data.Get());
    const auto grid = read(path);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->type(), ScalarType::F64) << "the samples are those of the file";
    const GridGeometry& geometry = grid.value()->geometry();
    EXPECT_EQ(geometry.dims, (GridDims{6, 5, 4}));
    EXPECT_NEAR(glm::length(geometry.spacing - glm::dvec3(0.3, 0.2, 0.1)), 0.0, 1e-5);
    EXPECT_NEAR(glm::length(geometry.direction[0] - glm::dvec3(0, 1, 0)), 0.0, 1e-4);
    EXPECT_NEAR(glm::length(geometry.direction[1] - glm::dvec3(-1, 0, 0)), 0.0, 1e-4);
    const double place[3] = {100 - 0.2 * 3, 0.3 * 2, 0.1 * 1};
    EXPECT_NEAR(grid.value()->valueAt(2, 3, 1), scalarAt(place), 1e-3);
    const auto contents = listVolumes(path);
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_FALSE(contents.value().fields[0].isResampled);
    EXPECT_EQ(contents.value().fields[0].dims, geometry.dims);
    const auto source = openVolume(path);
    ASSERT_THAT(source.value()->prepare({}), test::IsOk());
    EXPECT_FALSE(source.value()->info().resampling.has_value());
}

TEST_P(VtkGrids, ResampleUnstructuredOnes) {
    const auto path = file(cells());
    ReadOptions options;
    options.resampleDims = {13, 5, 5};
    const auto source = openVolume(path, options);
    ASSERT_THAT(source, test::IsOk());
    EXPECT_THAT(source.value()->info().notes, testing::ElementsAre(HasSubstr("1 cells without volume")));
    const auto grid = read(path, options);
    ASSERT_THAT(grid, test::IsOk());
    // All of two hexahedra, and the half of the third on this side of its diagonal.
    EXPECT_EQ(expectField(*grid.value(), scalarAt), (9 * 5 + 10) * 5);
    EXPECT_TRUE(std::isnan(grid.value()->valueAt(12, 4, 0)));
    EXPECT_EQ(listVolumes(path).value().fields[0].dims, read(path).value()->dims());
}

TEST_P(VtkGrids, ReportWhatResamplingLoses) {
    ReadOptions options;
    options.resampleDims = {13, 5, 5};
    const auto source = openVolume(file(cells()), options);
    ASSERT_THAT(source, test::IsOk());
    ASSERT_THAT(source.value()->prepare({}), test::IsOk());
    const auto report = source.value()->info().resampling;
    ASSERT_TRUE(report.has_value());
    EXPECT_EQ(report->sourcePoints, 16);
    EXPECT_EQ(report->comparedPoints, 14) << "two points belong to no cell with a volume";
    EXPECT_LT(report->maxDifference, 1e-5);
    EXPECT_EQ(report->outsidePoints, 10 * 5);
}

TEST_P(VtkGrids, GiveComponents) {
    const auto path = file(rectilinear(true));
    ReadOptions options;
    options.field = "v";
    const auto refused = read(path, options);
    ASSERT_THAT(refused, test::HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(refused.error().line(), HasSubstr("--component"));
    for (int c = 0; c < 3; ++c) {
        options.component = c;
        const auto grid = read(path, options);
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->type(), ScalarType::F32);
        EXPECT_EQ(expectField(*grid.value(), [c](const double* p) { return p[c]; }), 24);
    }
    options.component = kMagnitude;
    const auto grid = read(path, options);
    ASSERT_THAT(grid, test::IsOk());
    expectField(*grid.value(), [](const double* p) { return std::hypot(p[0], p[1], p[2]); });
    options.component = 3;
    EXPECT_THAT(read(path, options), test::HasError(ErrorCode::InvalidArgument));
}

TEST_P(VtkGrids, ListTheirArrays) {
    for (const auto& path : {file(rectilinear(false)), file(sheared()), file(cells())}) {
        const auto contents = listVolumes(path);
        ASSERT_THAT(contents, test::IsOk());
        ASSERT_EQ(contents.value().fields.size(), 2u);
        const VolumeField& preferred = contents.value().fields[contents.value().preferred];
        EXPECT_EQ(preferred.name, "s");
        EXPECT_EQ(preferred.typeName, "float64");
        EXPECT_FALSE(contents.value().needsChoice());
        const VolumeField& other = contents.value().fields[1 - contents.value().preferred];
        EXPECT_EQ(other.name, "v");
        EXPECT_EQ(other.components, 3);
        ReadOptions options;
        options.field = "w";
        EXPECT_THAT(read(path, options).error().line(), HasSubstr("'s'"));
    }
}

TEST_P(VtkGrids, OfUnstructuredCellsStopOnRequest) {
    std::stop_source stop;
    stop.request_stop();
    EXPECT_TRUE(readVolume(file(cells()), {}, {stop.get_token(), {}}).isCancelled());
    double last = 0.0;
    EXPECT_THAT(readVolume(file(cells()), {}, {{}, [&](double f, std::string_view) { last = f; }}), test::IsOk());
    EXPECT_EQ(last, 1.0);
}

TEST_P(VtkGrids, ThatEndEarlyAreRefused) {
    const auto path = file(cells());
    const std::string whole = test::readText(path);
    const bool isAppended = GetParam().isAppended; // its end is no more than the closing tags
    const std::size_t most = whole.size() - (isAppended ? 40 : GetParam().isXml ? 12 : 400);
    for (std::size_t size = 1; size < most; size += 131)
        ASSERT_FALSE(read(folder.write(path.filename().string(), whole.substr(0, size))).isOk())
            << size << " of " << whole.size();
}

// VTK would take memory for as many corners as the last offset states.
TEST_P(VtkGrids, WhoseOffsetsLeadBeyondTheCornersAreRefused) {
    if (!GetParam().isXml)
        GTEST_SKIP() << "this format counts its corners apart";
    for (const vtkIdType offset : {vtkIdType{26}, vtkIdType{4'000'000'000'000}, vtkIdType{-1}}) {
        const auto data = cells();
        vtkDataArray& offsets = *data->GetCells()->GetOffsetsArray();
        offsets.SetComponent(offsets.GetNumberOfTuples() - 1, 0, static_cast<double>(offset));
        const auto grid = read(file(data));
        EXPECT_THAT(grid, test::HasError(ErrorCode::Corruption)) << offset;
        EXPECT_EQ(grid.error().line().find('\n'), std::string::npos);
        if (!GetParam().isPacked) {
            EXPECT_THAT(grid.error().line(), HasSubstr("offsets")) << "VTK is not asked";
        }
        EXPECT_THAT(listVolumes(folder / "a.vtu"), test::HasError(ErrorCode::Corruption)) << offset;
    }
}

TEST_P(VtkGrids, WithCornersThatAreNoPointsAreRefused) {
    const auto data = cells();
    data->GetCells()->GetConnectivityArray()->SetComponent(3, 0, 16.0);
    const auto grid = read(file(data));
    EXPECT_THAT(grid, test::HasError(ErrorCode::Corruption));
    EXPECT_THAT(grid.error().line(), HasSubstr("point 16 of 16"));
}

TEST_P(VtkGrids, SurviveDamage) {
    for (const auto& path : {file(cells()), file(sheared()), file(rectilinear(false))}) {
        const std::string whole = test::readText(path);
        for (std::size_t i = 0; i < whole.size(); i += 1 + whole.size() * test::kSparser / 16) {
            std::string damaged = whole;
            damaged[i] = static_cast<char>(damaged[i] ^ 0x15);
            static_cast<void>(readVolume(folder.write(path.filename().string(), damaged)));
        }
    }
}

TEST(VtkImage, GivesComponentsAndPrefersTheActiveScalars) {
    const test::TemporaryFolder folder;
    const auto path = folder / "a.vti";
    const vtkNew<vtkXMLImageDataWriter> writer;
    writer->SetInputData(image());
    writer->SetFileName(path.c_str());
    writer->Write();
    const auto contents = listVolumes(path);
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_EQ(contents.value().fields[contents.value().preferred].name, "s");
    EXPECT_FALSE(contents.value().needsChoice());
    EXPECT_EQ(contents.value().fields[0].dims, (GridDims{4, 3, 4}));
    ReadOptions options;
    options.field = "v";
    options.component = 2;
    const auto grid = readVolume(path, options);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->valueAt(0, 0, 3), 1.5);
    EXPECT_EQ(grid.value()->geometry().origin, glm::dvec3(1, 0, 0));
}

/// Headers of blocks, 32 or 64 bits wide, are of the file's byte order, as samples are.
template <class XmlWriter>
std::filesystem::path bigEndian(vtkDataObject* data, const std::filesystem::path& path, bool isAppended, bool isPacked,
                                bool isWide) {
    const vtkNew<XmlWriter> writer;
    writer->SetInputData(data);
    writer->SetFileName(path.c_str());
    writer->SetByteOrderToBigEndian();
    if (isAppended)
        writer->SetDataModeToAppended();
    else
        writer->SetDataModeToBinary();
    writer->SetEncodeAppendedData(false);
    if (isPacked)
        writer->SetCompressorTypeToZLib();
    else
        writer->SetCompressorTypeToNone();
    writer->SetHeaderType(isWide ? vtkXMLWriter::UInt64 : vtkXMLWriter::UInt32);
    EXPECT_EQ(writer->Write(), 1);
    return path;
}

TEST(VtkXmlByteOrder, OfBlockHeadersIsThatOfTheFile) {
    const test::TemporaryFolder folder;
    for (int way = 0; way < 8; ++way) {
        const bool isAppended = (way & 1) != 0, isPacked = (way & 2) != 0, isWide = (way & 4) != 0;
        SCOPED_TRACE(way);
        const auto box = readVolume(
            bigEndian<vtkXMLImageDataWriter>(image(), folder / "a.vti", isAppended, isPacked, isWide), {.field = "s"});
        ASSERT_THAT(box, test::IsOk());
        const auto geometry = box.value()->geometry();
        const glm::dvec3 place = geometry.origin + geometry.spacing * glm::dvec3(3, 2, 3);
        const double at[3] = {place.x, place.y, place.z};
        EXPECT_NEAR(box.value()->valueAt(3, 2, 3), scalarAt(at), 1e-6);
        const auto mesh =
            readVolume(bigEndian<vtkXMLUnstructuredGridWriter>(cells(), folder / "a.vtu", isAppended, isPacked, isWide),
                       {.field = "s", .resampleDims = {13, 5, 5}});
        ASSERT_THAT(mesh, test::IsOk());
        const double middle[3] = {1, 0.5, 0.5};
        EXPECT_NEAR(mesh.value()->valueAt(4, 2, 2), scalarAt(middle), 1e-4);
    }
}

TEST(VtkLegacyCells, BeforeThePointsAreSteppedOver) {
    const test::TemporaryFolder folder;
    ReadOptions options;
    options.resampleDims = {5, 5, 5};
    const auto grid = readVolume(folder.write("a.vtk", test::vtkCells()), options);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_NEAR(grid.value()->valueAt(1, 1, 1), 0.25 * 6, 1e-6);
    const auto contents = listVolumes(folder / "a.vtk");
    EXPECT_EQ(contents.value().fields[contents.value().preferred].name, "s");
}

} // namespace
} // namespace isoslider::io
