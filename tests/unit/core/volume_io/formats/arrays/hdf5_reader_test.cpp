#include <cstring>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::io {
namespace {

using testing::HasSubstr;

/// Writes a small file with the library itself.
class Writer {
public:
    explicit Writer(const std::filesystem::path& path)
        : path_(path), file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
    ~Writer() { close(); }
    std::filesystem::path close() {
        if (file_ >= 0)
            H5Fclose(std::exchange(file_, -1));
        return path_;
    }
    hid_t file() const { return file_; }

    void group(const char* name) const { H5Gclose(H5Gcreate2(file_, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)); }

    template <class T>
    void dataset(const char* name, const std::vector<hsize_t>& extents, const std::vector<T>& values, hid_t memory,
                 hid_t stored, const std::vector<hsize_t>& chunk = {}, bool isPacked = false) const {
        const hid_t space = H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
        const hid_t settings = H5Pcreate(H5P_DATASET_CREATE);
        if (!chunk.empty())
            H5Pset_chunk(settings, static_cast<int>(chunk.size()), chunk.data());
        if (isPacked)
            H5Pset_deflate(settings, 9);
        const hid_t id = H5Dcreate2(file_, name, stored, space, H5P_DEFAULT, settings, H5P_DEFAULT);
        if (!values.empty())
            H5Dwrite(id, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        H5Dclose(id);
        H5Pclose(settings);
        H5Sclose(space);
    }
    /// 0, 1, 2 ... in the file's order, as 16-bit integers.
    void ramp(const char* name, const std::vector<hsize_t>& extents, const std::vector<hsize_t>& chunk = {},
              bool isPacked = false) const {
        hsize_t count = 1;
        for (const hsize_t extent : extents)
            count *= extent;
        std::vector<std::int16_t> values(count);
        std::iota(values.begin(), values.end(), std::int16_t{0});
        dataset(name, extents, values, H5T_NATIVE_INT16, H5T_STD_I16BE, chunk, isPacked);
    }

    void numbers(const char* object, const char* name, const std::vector<double>& values) const {
        const hid_t id = H5Oopen(file_, object, H5P_DEFAULT);
        const hsize_t count = values.size();
        const hid_t space = H5Screate_simple(1, &count, nullptr);
        const hid_t attribute = H5Acreate2(id, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT);
        H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data());
        H5Aclose(attribute);
        H5Sclose(space);
        H5Oclose(id);
    }
    void texts(const char* object, const char* name, const std::vector<const char*>& values, bool isVariable) const {
        const hid_t id = H5Oopen(file_, object, H5P_DEFAULT);
        const hsize_t count = values.size();
        const hid_t space = H5Screate_simple(1, &count, nullptr);
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, isVariable ? H5T_VARIABLE : 8);
        const hid_t attribute = H5Acreate2(id, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
        std::string fixed;
        for (const char* value : values)
            fixed += std::string(value) + std::string(8 - std::strlen(value), '\0');
        H5Awrite(attribute, type, isVariable ? static_cast<const void*>(values.data()) : fixed.data());
        H5Aclose(attribute);
        H5Tclose(type);
        H5Sclose(space);
        H5Oclose(id);
    }
    void longText(const char* object, const char* name, const std::string& value) const {
        const hid_t id = H5Oopen(file_, object, H5P_DEFAULT);
        const hid_t space = H5Screate(H5S_SCALAR), type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, value.size());
        const hid_t attribute = H5Acreate2(id, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
        H5Awrite(attribute, type, value.data());
        H5Aclose(attribute);
        H5Tclose(type);
        H5Sclose(space);
        H5Oclose(id);
    }

private:
    std::filesystem::path path_;
    hid_t file_;
};

class Hdf5Reader : public testing::Test {
protected:
    static Result<std::shared_ptr<const ScalarGrid>> read(const std::filesystem::path& path, ReadOptions options = {}) {
        testing::internal::CaptureStderr();
        auto grid = readVolume(path, options);
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        return grid;
    }
    static void expectRefusal(const std::filesystem::path& path, const std::string& says, ReadOptions options = {}) {
        const auto grid = read(path, std::move(options));
        ASSERT_FALSE(grid.isOk());
        EXPECT_THAT(grid.error().line(), HasSubstr(says));
        EXPECT_THAT(grid.error().line(), testing::Not(HasSubstr("\n")));
    }
    std::filesystem::path at(const char* name) const { return folder.path() / name; }
    test::TemporaryFolder folder;
};

void expectRamp(const ScalarGrid& grid) {
    const auto values = grid.values<std::int16_t>();
    for (std::size_t i = 0; i < values.size(); ++i)
        ASSERT_EQ(values[i], static_cast<std::int16_t>(i));
}

TEST_F(Hdf5Reader, TakesTheOneDatasetHoweverItIsStored) {
    for (const bool isChunked : {false, true}) {
        Writer writer(at("a.h5"));
        writer.ramp("v", {5, 3, 4}, isChunked ? std::vector<hsize_t>{2, 2, 3} : std::vector<hsize_t>{}, isChunked);
        const auto grid = read(writer.close());
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->dims(), (GridDims{4, 3, 5}));
        EXPECT_EQ(grid.value()->type(), ScalarType::I16);
        EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(1));
        expectRamp(*grid.value());
    }
}

TEST_F(Hdf5Reader, ReadsSlabsInAnyOrder) {
    Writer writer(at("a.h5"));
    writer.ramp("v", {5, 3, 4}, {2, 2, 3});
    const auto source = openVolume(writer.close());
    ASSERT_THAT(source, test::IsOk());
    std::vector<std::int16_t> slab(24);
    for (const std::int64_t z : {3, 0, 1}) {
        ASSERT_THAT(source.value()->readSlab(z, z + 2, std::as_writable_bytes(std::span(slab))), test::IsOk());
        for (std::size_t i = 0; i < slab.size(); ++i)
            ASSERT_EQ(slab[i], static_cast<std::int16_t>(12 * z) + static_cast<std::int16_t>(i));
    }
}

TEST_F(Hdf5Reader, ReadsEveryTypeOfNumbers) {
    const struct {
        hid_t stored;
        ScalarType type;
    } kinds[] = {{H5T_STD_U8LE, ScalarType::U8},    {H5T_STD_I8BE, ScalarType::I8},   {H5T_STD_U16BE, ScalarType::U16},
                 {H5T_STD_I32BE, ScalarType::I32},  {H5T_STD_U32LE, ScalarType::F64}, {H5T_STD_I64BE, ScalarType::F64},
                 {H5T_IEEE_F32BE, ScalarType::F32}, {H5T_IEEE_F64LE, ScalarType::F64}};
    for (const auto& kind : kinds) {
        Writer writer(at("a.h5"));
        writer.dataset<double>("v", {2, 2, 2}, {0, 1, 2, 3, 4, 5, 6, 127}, H5T_NATIVE_DOUBLE, kind.stored);
        const auto grid = read(writer.close());
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->type(), kind.type);
        EXPECT_EQ(grid.value()->valueAt(1, 1, 1), 127.0);
        EXPECT_EQ(grid.value()->valueAt(0, 1, 0), 2.0);
    }
}

TEST_F(Hdf5Reader, RefusesIntegersThatF64CannotHold) {
    Writer writer(at("a.h5"));
    writer.dataset<std::int64_t>("v", {1, 1, 2}, {1, (std::int64_t{1} << 53) + 1}, H5T_NATIVE_INT64, H5T_STD_I64LE);
    expectRefusal(writer.close(), "9007199254740993");
}

TEST_F(Hdf5Reader, ListsTheWholeTreeOnce) {
    Writer writer(at("a.h5"));
    writer.group("g");
    writer.group("g/h");
    writer.ramp("g/h/deep", {2, 3, 4});
    writer.ramp("plane", {3, 4});
    writer.ramp("series", {2, 2, 2, 2});
    writer.ramp("line", {7});
    H5Lcreate_hard(writer.file(), "/", writer.file(), "g/h/up", H5P_DEFAULT, H5P_DEFAULT); // a circle
    H5Lcreate_hard(writer.file(), "g/h/deep", writer.file(), "again", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/g/h/deep", writer.file(), "soft", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("/etc/passwd", "/x", writer.file(), "elsewhere", H5P_DEFAULT, H5P_DEFAULT);
    const auto contents = listVolumes(writer.close());
    ASSERT_THAT(contents, test::IsOk());
    std::vector<std::string> names;
    for (const auto& field : contents.value().fields)
        names.push_back(field.name);
    EXPECT_THAT(names, testing::ElementsAre("/again", "/plane", "/series"));
    EXPECT_EQ(contents.value().fields[1].dims, (GridDims{4, 3, 1}));
    EXPECT_EQ(contents.value().fields[2].frames, 2);
    EXPECT_EQ(contents.value().fields[0].typeName, "int16");
    EXPECT_TRUE(contents.value().needsChoice());
}

TEST_F(Hdf5Reader, ListsTypesAndWhatCannotBeRead) {
    Writer writer(at("a.h5"));
    writer.dataset<float>("f", {2, 2, 2}, std::vector<float>(8), H5T_NATIVE_FLOAT, H5T_IEEE_F32LE);
    writer.dataset<double>("g", {2, 2, 2}, std::vector<double>(8), H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
    writer.dataset<double>("none", {0, 2, 2, 2}, {}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
    const auto contents = listVolumes(writer.close());
    ASSERT_THAT(contents, test::IsOk());
    ASSERT_EQ(contents.value().fields.size(), 3u);
    EXPECT_EQ(contents.value().fields[0].typeName, "float32");
    EXPECT_EQ(contents.value().fields[1].typeName, "float64");
    EXPECT_THAT(contents.value().fields[2].problem, HasSubstr("series of none"));
    Writer line(at("b.h5"));
    line.ramp("line", {7});
    const auto nothing = listVolumes(line.close());
    ASSERT_FALSE(nothing.isOk());
    EXPECT_THAT(nothing.error().line(), HasSubstr("no samples of two or three dimensions"));
}

TEST_F(Hdf5Reader, AsksWhichDatasetAndFrame) {
    Writer writer(at("a.h5"));
    writer.group("g");
    writer.ramp("g/one", {2, 2, 2});
    writer.ramp("two", {3, 2, 2, 2});
    const auto path = writer.close();
    expectRefusal(path, "--field");
    expectRefusal(path, "'/g/one'");
    ReadOptions options;
    options.field = "/three";
    expectRefusal(path, "none named '/three'", options);
    options.field = "g/one"; // the first slash may be left out
    EXPECT_THAT(read(path, options), test::IsOk());
    options.field = "/two";
    expectRefusal(path, "--frame", options);
    options.frame = 3;
    expectRefusal(path, "--frame 3", options);
    options.frame = 2;
    const auto grid = read(path, options);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->valueAt(0, 0, 0), 16.0);
    options.component = 1;
    expectRefusal(path, "component", options);
}

TEST_F(Hdf5Reader, FollowsOpenPmd) {
    for (const bool isFortran : {false, true}) {
        Writer writer(at("a.h5"));
        writer.group("B");
        writer.ramp("B/x", {2, 3, 4});
        writer.texts("B", "axisLabels", {"x", "y", "z"}, isFortran);
        writer.texts("B", "dataOrder", {isFortran ? "F" : "C"}, true);
        writer.numbers("B", "gridSpacing", {0.5, 2, 3});
        writer.numbers("B", "gridGlobalOffset", {10, 20, 30});
        writer.numbers("B/x", "position", {0.5, 0, 0});
        writer.numbers("B/x", "unitSI", {1e-3});
        const auto path = writer.close();
        const auto grid = read(path);
        ASSERT_THAT(grid, test::IsOk());
        const GridGeometry& geometry = grid.value()->geometry();
        EXPECT_EQ(geometry.spacing, glm::dvec3(0.5, 2, 3));
        EXPECT_EQ(geometry.origin, glm::dvec3(10.25, 20, 30));
        // C: x is the file's slowest axis. F: its fastest.
        EXPECT_EQ(geometry.dims, isFortran ? (GridDims{4, 3, 2}) : (GridDims{2, 3, 4}));
        EXPECT_EQ(grid.value()->valueAt(1, 0, 0), isFortran ? 1.0 : 12.0);
        EXPECT_EQ(grid.value()->valueAt(0, 0, 1), isFortran ? 12.0 : 1.0);
        EXPECT_EQ(grid.value()->valueAt(1, 2, 1), 21.0);
        const auto source = openVolume(path);
        EXPECT_THAT(source.value()->info().notes, testing::Contains(HasSubstr("unitSI")));
        // Planes across the file's order, last first.
        std::vector<std::int16_t> plane(static_cast<std::size_t>(geometry.dims[0] * geometry.dims[1]));
        const std::int64_t last = geometry.dims[2] - 1;
        ASSERT_THAT(source.value()->readSlab(last, last + 1, std::as_writable_bytes(std::span(plane))), test::IsOk());
        EXPECT_EQ(plane[1], grid.value()->valueAt(1, 0, last));
    }
}

TEST_F(Hdf5Reader, TakesSpacingFromElementSize) {
    Writer writer(at("a.h5"));
    writer.ramp("v", {2, 3, 4});
    writer.numbers("v", "element_size_um", {5, 1, 0.5});
    const auto path = writer.close();
    const auto grid = read(path);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(0.5, 1, 5));
    EXPECT_EQ(openVolume(path).value()->info().lengthUnit, "µm");
}

TEST_F(Hdf5Reader, TakesTheUnitOfLengthFromOpenPmd) {
    for (const auto& [metres, unit] : {std::pair{1.0, "m"}, {1e-6, "µm"}, {1e-10, "Å"}, {0.02, ""}}) {
        Writer writer(at("a.h5"));
        writer.ramp("v", {2, 3, 4});
        writer.numbers("v", "gridSpacing", {1, 1, 1});
        writer.numbers("v", "gridUnitSI", {metres});
        const auto source = openVolume(writer.close());
        ASSERT_THAT(source, test::IsOk());
        EXPECT_EQ(source.value()->info().lengthUnit, unit);
        EXPECT_EQ(source.value()->info().notes.size(), *unit == '\0' ? 2u : 1u)
            << "the axes; the unit that has no name";
    }
}

TEST_F(Hdf5Reader, RefusesSpacingThatIsNone) {
    Writer writer(at("a.h5"));
    writer.ramp("v", {2, 3, 4});
    writer.numbers("v", "gridSpacing", {1, 0, 1});
    expectRefusal(writer.close(), "gridSpacing");
}

TEST_F(Hdf5Reader, RefusesWhatHoldsNoSamples) {
    {
        Writer writer(at("a.h5"));
        writer.dataset<float>("v", {2, 2, 2}, {}, H5T_NATIVE_FLOAT, H5T_NATIVE_FLOAT);
        expectRefusal(writer.close(), "never written");
    }
    {
        Writer writer(at("a.h5"));
        writer.dataset<float>("v", {1000, 1000, 1000}, {}, H5T_NATIVE_FLOAT, H5T_NATIVE_FLOAT, {10, 10, 10});
        expectRefusal(writer.close(), "never written");
    }
    {
        Writer writer(at("a.h5"));
        writer.ramp("line", {7});
        expectRefusal(writer.close(), "no samples of two or three dimensions");
    }
    {
        Writer writer(at("a.h5"));
        const hid_t pair = H5Tcreate(H5T_COMPOUND, 8);
        H5Tinsert(pair, "r", 0, H5T_NATIVE_FLOAT);
        H5Tinsert(pair, "i", 4, H5T_NATIVE_FLOAT);
        writer.dataset<float>("v", {1, 2, 2}, std::vector<float>(8), pair, pair);
        expectRefusal(writer.close(), "records");
    }
}

TEST_F(Hdf5Reader, RefusesSizesBeyondTheFile) {
    Writer writer(at("a.h5"));
    const std::vector<hsize_t> large{1 << 10, 1 << 10, 1 << 9};
    writer.dataset<float>("v", large, {}, H5T_NATIVE_FLOAT, H5T_NATIVE_FLOAT, large);
    expectRefusal(writer.close(), "chunks are of 2048 MiB");
    Writer wide(at("b.h5"));
    wide.dataset<float>("v", {1 << 21, 1, 1}, {}, H5T_NATIVE_FLOAT, H5T_NATIVE_FLOAT);
    expectRefusal(wide.close(), "dims of '/v'");
}

TEST_F(Hdf5Reader, RefusesSamplesInOtherFiles) {
    folder.write("outside.raw", std::string(32, 'x'));
    Writer writer(at("a.h5"));
    const hid_t settings = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(settings, (folder / "outside.raw").c_str(), 0, 32);
    const hsize_t extents[3] = {2, 2, 2};
    const hid_t space = H5Screate_simple(3, extents, nullptr);
    H5Dclose(H5Dcreate2(writer.file(), "v", H5T_NATIVE_FLOAT, space, H5P_DEFAULT, settings, H5P_DEFAULT));
    H5Sclose(space);
    H5Pclose(settings);
    expectRefusal(writer.close(), "other files");
}

TEST_F(Hdf5Reader, RefusesEveryShorterFile) {
    Writer writer(at("a.h5"));
    writer.ramp("v", {5, 3, 4}, {2, 2, 3}, true);
    const std::string whole = test::readText(writer.close());
    for (std::size_t size = 1; size < whole.size(); size += test::kSparser * 97)
        ASSERT_FALSE(read(folder.write("b.h5", whole.substr(0, size))).isOk()) << size;
}

TEST_F(Hdf5Reader, PlacesVtkImageDataByItsAttributes) {
    Writer file(at("a.vtkhdf"));
    file.group("/VTKHDF");
    file.group("/VTKHDF/PointData");
    file.group("/VTKHDF/CellData");
    file.ramp("/VTKHDF/PointData/height", {2, 3, 4});
    file.ramp("/VTKHDF/CellData/load", {1, 2, 3});
    file.numbers("/VTKHDF", "WholeExtent", {1, 4, 0, 2, 0, 1});
    file.numbers("/VTKHDF", "Spacing", {0.5, 1, 2});
    file.numbers("/VTKHDF", "Origin", {10, 20, 30});
    file.numbers("/VTKHDF", "Direction", {0, -1, 0, 1, 0, 0, 0, 0, 1}); // rows: x runs along y
    const auto points = openVolume(file.close(), {.field = "/VTKHDF/PointData/height"});
    ASSERT_THAT(points, test::IsOk());
    const GridGeometry& geometry = points.value()->info().geometry;
    EXPECT_EQ(geometry.dims, (GridDims{4, 3, 2}));
    EXPECT_EQ(geometry.spacing, glm::dvec3(0.5, 1, 2));
    EXPECT_EQ(geometry.direction[0], glm::dvec3(0, 1, 0));
    EXPECT_EQ(geometry.direction[1], glm::dvec3(-1, 0, 0));
    EXPECT_EQ(geometry.origin, glm::dvec3(10, 20.5, 30)); // the extent begins at 1
    const auto cells = openVolume(at("a.vtkhdf"), {.field = "/VTKHDF/CellData/load"});
    ASSERT_THAT(cells, test::IsOk());
    EXPECT_EQ(cells.value()->info().geometry.origin, glm::dvec3(10 - 0.5, 20.5 + 0.25, 31));
}

TEST_F(Hdf5Reader, PlacesMincByTheStepsOfItsAxes) {
    Writer file(at("a.mnc"));
    for (const char* name : {"/minc-2.0", "/minc-2.0/image", "/minc-2.0/image/0", "/minc-2.0/dimensions"})
        file.group(name);
    file.ramp("/minc-2.0/image/0/image", {2, 3, 4});
    file.longText("/minc-2.0/image/0/image", "dimorder", "yspace,zspace,xspace");
    const char* axes[] = {"xspace", "yspace", "zspace"};
    const double steps[] = {-0.5, 1, 2}, starts[] = {10, 20, 30};
    for (int axis = 0; axis < 3; ++axis) {
        const std::string name = std::string("/minc-2.0/dimensions/") + axes[axis];
        file.ramp(name.c_str(), {1, 1});
        file.numbers(name.c_str(), "step", {steps[axis]});
        file.numbers(name.c_str(), "start", {starts[axis]});
        file.longText(name.c_str(), "units", "mm");
    }
    const auto source = openVolume(file.close(), {.field = "/minc-2.0/image/0/image"});
    ASSERT_THAT(source, test::IsOk());
    const VolumeInfo& info = source.value()->info();
    EXPECT_EQ(info.geometry.dims, (GridDims{4, 2, 3}));
    EXPECT_EQ(info.geometry.spacing, glm::dvec3(0.5, 1, 2));
    EXPECT_EQ(info.geometry.direction[0], glm::dvec3(1, 0, 0)); // x of the file runs to the left, and ours is left
    EXPECT_EQ(info.geometry.direction[1], glm::dvec3(0, -1, 0));
    EXPECT_EQ(info.geometry.direction[2], glm::dvec3(0, 0, 1));
    EXPECT_EQ(info.geometry.origin, glm::dvec3(-10, -20, 30));
    EXPECT_EQ(info.lengthUnit, "mm");
    EXPECT_THAT(info.notes, testing::Contains(HasSubstr("real values")));
}

TEST_F(Hdf5Reader, NotesSpacingsThatItDoesNotUnderstand) {
    Writer file(at("a.h5"));
    file.ramp("/a", {2, 3, 4});
    file.numbers("/a", "VoxelSizeInFurlongs", {1, 2, 3});
    const auto source = openVolume(file.close());
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().geometry.spacing, glm::dvec3(1.0));
    EXPECT_THAT(source.value()->info().notes,
                testing::Contains(HasSubstr("'VoxelSizeInFurlongs'): spacing 1 is taken")));
}

TEST_F(Hdf5Reader, IsKnownByItsFirstBytes) {
    Writer writer(at("volume.dat"));
    writer.ramp("v", {2, 3, 4});
    EXPECT_THAT(read(writer.close()), test::IsOk());
    expectRefusal(folder.write("a.h5", "not at all"), "HDF5");
}

} // namespace
} // namespace isoslider::io
