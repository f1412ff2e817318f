#include <cmath>
#include <limits>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

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
    Writer(const std::filesystem::path& path, bool isNetcdf4) : path_(path) {
        EXPECT_EQ(nc_create(path.c_str(), isNetcdf4 ? NC_NETCDF4 | NC_CLOBBER : NC_CLOBBER, &file_), NC_NOERR);
    }
    ~Writer() { close(); }
    std::filesystem::path close() {
        if (file_ >= 0) {
            EXPECT_EQ(nc_close(std::exchange(file_, -1)), NC_NOERR);
        }
        return path_;
    }
    int file() const { return file_; }

    int dimension(const char* name, std::size_t extent) const {
        int id = -1;
        EXPECT_EQ(nc_def_dim(file_, name, extent, &id), NC_NOERR);
        return id;
    }
    /// A dimension with coordinates.
    int axis(const char* name, const std::vector<double>& places, const char* units = "") {
        const int id = dimension(name, places.size());
        const int variable = define(name, NC_DOUBLE, {id});
        if (*units != '\0')
            text(variable, "units", units);
        later_.push_back({variable, places});
        return id;
    }
    int define(const char* name, nc_type type, const std::vector<int>& dimensions) const {
        int id = -1;
        EXPECT_EQ(nc_def_var(file_, name, type, static_cast<int>(dimensions.size()), dimensions.data(), &id), NC_NOERR);
        return id;
    }
    void text(int variable, const char* name, const std::string& value) const {
        nc_put_att_text(file_, variable, name, value.size(), value.c_str());
    }
    void number(int variable, const char* name, nc_type type, const std::vector<double>& values) const {
        EXPECT_EQ(nc_put_att_double(file_, variable, name, type, values.size(), values.data()), NC_NOERR);
    }
    void put(int variable, const std::vector<double>& values) { later_.push_back({variable, values}); }
    void putRamp(int variable, std::size_t count) {
        std::vector<double> values(count);
        std::iota(values.begin(), values.end(), 0.0);
        put(variable, values);
    }
    std::filesystem::path finish() {
        nc_enddef(file_);
        for (const auto& [variable, values] : later_)
            EXPECT_EQ(nc_put_var_double(file_, variable, values.data()), NC_NOERR);
        return close();
    }

private:
    std::filesystem::path path_;
    int file_ = -1;
    std::vector<std::pair<int, std::vector<double>>> later_;
};

/// Both kinds of file.
class NetcdfReader : public testing::TestWithParam<bool> {
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
    }
    static std::vector<std::string> notesOf(const std::filesystem::path& path) {
        const auto source = openVolume(path);
        EXPECT_THAT(source, test::IsOk());
        return source.value()->info().notes;
    }
    Writer writer(const char* name = "a.nc") const { return Writer(folder.path() / name, GetParam()); }
    /// 2 x 3 x 4 of z, y, x at even places.
    static std::vector<int> evenAxes(Writer& writer) {
        return {writer.axis("lev", {100, 110}, "m"), writer.axis("lat", {-1, 0, 1}, "degrees_north"),
                writer.axis("lon", {0, 0.5, 1, 1.5}, "degrees_east")};
    }
    test::TemporaryFolder folder;
};
INSTANTIATE_TEST_SUITE_P(Kinds, NetcdfReader, testing::Bool(),
                         [](const auto& parameter) { return parameter.param ? "NetCDF4" : "Classic"; });

TEST_P(NetcdfReader, TakesPlaceAndSpacingFromCoordinates) {
    auto w = writer();
    const int v = w.define("v", NC_SHORT, evenAxes(w));
    w.text(v, "units", "K");
    w.putRamp(v, 24);
    const auto path = w.finish();
    const auto grid = read(path);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->type(), ScalarType::I16);
    EXPECT_EQ(grid.value()->dims(), (GridDims{4, 3, 2}));
    EXPECT_EQ(grid.value()->geometry().origin, glm::dvec3(0, -1, 100));
    EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(0.5, 1, 10));
    for (std::int64_t i = 0; i < 24; ++i)
        ASSERT_EQ(grid.value()->valueAt(i % 4, i / 4 % 3, i / 12), static_cast<double>(i));
    EXPECT_THAT(notesOf(path), testing::Contains(HasSubstr("'K'")));
    EXPECT_THAT(notesOf(path), testing::Contains(HasSubstr("'lon' is in 'degrees_east'")));
    EXPECT_EQ(openVolume(path).value()->info().lengthUnit, "") << "not all are lengths";
}

TEST_P(NetcdfReader, IsKnownWhateverTheFileIsNamed) {
    auto w = writer(GetParam() ? "a.h5" : "a.dat");
    const int v = w.define("v", NC_SHORT, evenAxes(w));
    w.putRamp(v, 24);
    const auto path = w.finish();
    const auto source = openVolume(path, {.field = GetParam() ? "/v" : "v"}); // also by its name as HDF5
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().format, "NetCDF");
    EXPECT_EQ(source.value()->info().geometry.spacing, glm::dvec3(0.5, 1, 10));
    EXPECT_EQ(listVolumes(path).value().fields[0].name, "v");
}

TEST_P(NetcdfReader, TakesCoordinatesOfSinglePrecisionForEven) {
    auto w = writer();
    std::vector<double> places;
    for (int i = 0; i < 300; ++i)
        places.push_back(static_cast<double>(static_cast<float>(1000.0 + 0.1 * i))); // off by up to 3e-4 of a step
    const int v = w.define("v", NC_SHORT, {w.axis("z", {0, 1}), w.axis("y", {0, 1}), w.axis("x", places)});
    w.putRamp(v, 1200);
    const auto path = w.finish();
    EXPECT_FALSE(listVolumes(path).value().fields[0].isResampled);
    EXPECT_EQ(read(path).value()->type(), ScalarType::I16);
}

TEST_P(NetcdfReader, AxesOfOneUnitOfLengthSayIt) {
    auto w = writer();
    const int v =
        w.define("v", NC_SHORT,
                 {w.axis("z", {0, 10}, "km"), w.axis("y", {0, 1, 2}, "kilometers"), w.axis("x", {0, 1, 2, 3}, "km")});
    w.text(v, "long_name", "wind speed");
    w.putRamp(v, 24);
    const auto source = openVolume(w.finish());
    ASSERT_THAT(source, test::IsOk());
    EXPECT_EQ(source.value()->info().lengthUnit, "km");
    EXPECT_EQ(source.value()->info().fieldTitle, "wind speed");
    EXPECT_THAT(source.value()->info().notes, testing::Not(testing::Contains(HasSubstr("is in"))));
    auto mixed = writer("mixed.nc");
    const int u = mixed.define(
        "v", NC_SHORT,
        {mixed.axis("z", {0, 10}, "m"), mixed.axis("y", {0, 1, 2}, "km"), mixed.axis("x", {0, 1, 2, 3}, "km")});
    mixed.putRamp(u, 24);
    const auto other = openVolume(mixed.finish());
    ASSERT_THAT(other, test::IsOk());
    EXPECT_EQ(other.value()->info().lengthUnit, "");
    EXPECT_THAT(other.value()->info().notes, testing::Contains(HasSubstr("'z' is in 'm'")));
}

TEST_P(NetcdfReader, TurnsDescendingAxesRound) {
    auto w = writer();
    const int z = w.axis("lev", {0, 1}), y = w.axis("lat", {1, 0, -1}), x = w.axis("lon", {3, 2, 1, 0});
    const int v = w.define("v", NC_SHORT, {z, y, x});
    w.putRamp(v, 24);
    const auto grid = read(w.finish());
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->geometry().origin, glm::dvec3(0, -1, 0));
    EXPECT_EQ(grid.value()->valueAt(0, 0, 0), 11.0);
    EXPECT_EQ(grid.value()->valueAt(3, 2, 1), 12.0);
}

TEST_P(NetcdfReader, GoesByWhatAxesStandFor) {
    auto w = writer();
    const int x = w.axis("lon", {0, 1}, "degrees_east"), z = w.axis("lev", {0, 2, 4}), y = w.axis("lat", {0, 3, 6, 9});
    const int v = w.define("v", NC_SHORT, {x, z, y});
    w.putRamp(v, 24);
    const auto grid = read(w.finish());
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->dims(), (GridDims{2, 4, 3}));
    EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(1, 3, 2));
    EXPECT_EQ(grid.value()->valueAt(1, 0, 0), 12.0);
    EXPECT_EQ(grid.value()->valueAt(0, 1, 0), 1.0);
    EXPECT_EQ(grid.value()->valueAt(0, 0, 1), 4.0);
}

TEST_P(NetcdfReader, ResamplesUnevenAxes) {
    auto w = writer();
    const int z = w.axis("lev", {0, 1, 4}), y = w.axis("lat", {0, 1}), x = w.axis("lon", {0, 1});
    const int v = w.define("v", NC_DOUBLE, {z, y, x});
    w.put(v, {0, 0, 0, 0, 10, 10, 10, 10, 40, 40, 40, 40});
    ReadOptions options;
    options.resampleDims = {2, 2, 5};
    const auto source = openVolume(w.finish(), options);
    ASSERT_THAT(source, test::IsOk());
    ASSERT_THAT(source.value()->prepare({}), test::IsOk());
    std::vector<float> values(20);
    ASSERT_THAT(source.value()->readSlab(0, 5, std::as_writable_bytes(std::span(values))), test::IsOk());
    EXPECT_EQ(values[8], 20.0f);
    ASSERT_TRUE(source.value()->info().resampling.has_value());
    EXPECT_EQ(source.value()->info().resampling->maxDifference, 0.0);
}

TEST_P(NetcdfReader, KeepsThinLayersOfUnevenAxes) {
    auto w = writer();
    const int z = w.axis("lev", {0, 1, 2, 12}), y = w.axis("lat", {0, 1}), x = w.axis("lon", {0, 1});
    const int v = w.define("v", NC_DOUBLE, {z, y, x});
    w.put(v, {0, 0, 0, 0, 10, 10, 10, 10, 5, 5, 5, 5, 0, 0, 0, 0});
    const auto path = w.finish();
    const auto grid = read(path);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->dims(), (GridDims{2, 2, 13}));
    EXPECT_EQ(listVolumes(path).value().fields[0].dims, grid.value()->dims()) << "what is listed is what is made";
    EXPECT_EQ(grid.value()->valueAt(0, 0, 1), 10.0);
    EXPECT_EQ(grid.value()->valueAt(0, 0, 2), 5.0);
}

TEST_P(NetcdfReader, TurnsDepthsRoundSoThatUpIsUp) {
    struct Case {
        const char *positive, *standard, *units;
        bool isDown;
    };
    const Case cases[] = {{"down", "", "m", true},        {"Down", "", "1", true},    {"up", "depth", "m", false},
                          {"", "depth", "m", true},       {"", "", "hPa", true},      {"up", "", "hPa", false},
                          {"", "air_pressure", "", true}, {"", "height", "m", false}, {"", "", "m", false}};
    for (const Case& c : cases) {
        SCOPED_TRACE(std::string(c.positive) + ", " + c.standard + ", " + c.units);
        auto w = writer();
        const int z = w.axis("lev", {10, 20, 30}, c.units), y = w.axis("lat", {0, 1}), x = w.axis("lon", {0, 1});
        int variable = -1;
        ASSERT_EQ(nc_inq_varid(w.file(), "lev", &variable), NC_NOERR);
        if (*c.positive != '\0')
            w.text(variable, "positive", c.positive);
        if (*c.standard != '\0')
            w.text(variable, "standard_name", c.standard);
        w.putRamp(w.define("v", NC_SHORT, {z, y, x}), 12);
        const auto path = w.finish();
        const auto grid = read(path);
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->geometry().origin.z, c.isDown ? -30.0 : 10.0);
        EXPECT_EQ(grid.value()->geometry().spacing.z, 10.0);
        EXPECT_EQ(grid.value()->valueAt(0, 0, 0), c.isDown ? 8.0 : 0.0);
        EXPECT_EQ(grid.value()->valueAt(0, 0, 2), c.isDown ? 0.0 : 8.0);
        EXPECT_EQ(
            std::ranges::count_if(notesOf(path), [](const auto& n) { return n.find("grows downwards") != n.npos; }),
            c.isDown ? 1 : 0);
    }
}

TEST_P(NetcdfReader, TurnsNoDepthRoundThatIsNotUp) {
    auto w = writer();
    const int z = w.axis("a", {0, 1}), y = w.axis("depth", {0, 5}), x = w.axis("b", {0, 1, 2});
    w.putRamp(w.define("v", NC_SHORT, {z, y, x}), 12);
    int variable = -1;
    ASSERT_EQ(nc_inq_varid(w.file(), "depth", &variable), NC_NOERR);
    w.text(variable, "positive", "down");
    const auto grid = read(w.finish());
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->dims(), (GridDims{3, 2, 2}));
    EXPECT_EQ(grid.value()->geometry().origin, glm::dvec3(0));
    EXPECT_EQ(grid.value()->valueAt(0, 0, 0), 0.0);
}

TEST_P(NetcdfReader, LeavesMissingValuesOut) {
    auto w = writer();
    const int v = w.define("v", NC_SHORT, evenAxes(w));
    w.number(v, "_FillValue", NC_SHORT, {3});
    w.number(v, "missing_value", NC_SHORT, {5});
    w.number(v, "valid_range", NC_SHORT, {2, 20});
    w.putRamp(v, 24);
    const auto path = w.finish();
    const auto grid = read(path);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->type(), ScalarType::F32); // which holds all integers of 16 bits
    for (std::int64_t i = 0; i < 24; ++i) {
        const double value = grid.value()->valueAt(i % 4, i / 4 % 3, i / 12);
        if (i == 3 || i == 5 || i < 2 || i > 20)
            EXPECT_TRUE(std::isnan(value)) << i;
        else
            EXPECT_EQ(value, static_cast<double>(i));
    }
    EXPECT_THAT(notesOf(path), testing::Contains(HasSubstr("valid range 2 to 20")));
    EXPECT_THAT(notesOf(path), testing::Contains(HasSubstr("value 3 is missing")));
}

TEST_P(NetcdfReader, LeavesMissingFloatsOut) {
    auto w = writer();
    const int v = w.define("v", NC_FLOAT, evenAxes(w));
    w.number(v, "missing_value", NC_DOUBLE, {1e20}); // stored as the nearest f32
    std::vector<double> values(24, 1.0);
    values[1] = 1e20;
    values[2] = NC_FILL_FLOAT;
    w.put(v, values);
    const auto grid = read(w.finish());
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_TRUE(std::isnan(grid.value()->valueAt(1, 0, 0)));
    EXPECT_TRUE(std::isnan(grid.value()->valueAt(2, 0, 0)));
    EXPECT_EQ(grid.value()->valueAt(3, 0, 0), 1.0);
}

TEST_P(NetcdfReader, Unpacks) {
    for (const nc_type type : {NC_FLOAT, NC_DOUBLE}) {
        auto w = writer();
        const int v = w.define("v", NC_SHORT, evenAxes(w));
        w.number(v, "scale_factor", type, {0.25});
        w.number(v, "add_offset", type, {273});
        w.number(v, "_FillValue", NC_SHORT, {23});
        w.putRamp(v, 24);
        const auto grid = read(w.finish());
        ASSERT_THAT(grid, test::IsOk());
        EXPECT_EQ(grid.value()->type(), type == NC_FLOAT ? ScalarType::F32 : ScalarType::F64);
        EXPECT_EQ(grid.value()->valueAt(3, 0, 0), 273.75);
        EXPECT_TRUE(std::isnan(grid.value()->valueAt(3, 2, 1)));
    }
}

TEST_P(NetcdfReader, TakesSignedTypesForUnsignedWhereTheFileSaysSo) {
    auto w = writer();
    const int v = w.define("v", NC_BYTE, evenAxes(w));
    w.text(v, "_Unsigned", "true");
    std::vector<double> values(24, 0.0);
    values[1] = -1;
    w.put(v, values);
    const auto grid = read(w.finish());
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->type(), ScalarType::U8);
    EXPECT_EQ(grid.value()->valueAt(1, 0, 0), 255.0);
}

TEST_P(NetcdfReader, TakesTimesForFrames) {
    auto w = writer();
    auto axes = evenAxes(w);
    axes.insert(axes.begin(), w.axis("when", {0, 6, 12}, "hours since 2000-01-01"));
    const int v = w.define("v", NC_INT, axes);
    w.putRamp(v, 72);
    const auto path = w.finish();
    const auto contents = listVolumes(path);
    ASSERT_THAT(contents, test::IsOk());
    EXPECT_EQ(contents.value().fields[0].frames, 3);
    EXPECT_EQ(contents.value().fields[0].dims, (GridDims{4, 3, 2}));
    EXPECT_TRUE(contents.value().needsChoice());
    expectRefusal(path, "--frame");
    ReadOptions options;
    options.frame = 2;
    const auto grid = read(path, options);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->valueAt(1, 0, 0), 49.0);
    options.frame = -1;
    expectRefusal(path, "--frame -1", options);
}

TEST_P(NetcdfReader, CountsFramesOverAllFurtherAxes) {
    auto w = writer();
    auto axes = evenAxes(w);
    axes.insert(axes.begin(), {w.axis("time", {0, 1}), w.dimension("member", 3)});
    const int v = w.define("v", NC_INT, axes);
    w.putRamp(v, 144);
    ReadOptions options;
    options.frame = 4; // second time, second member
    const auto grid = read(w.finish(), options);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->valueAt(0, 0, 0), 96.0);
}

TEST_P(NetcdfReader, AsksWhichVariable) {
    auto w = writer();
    const auto axes = evenAxes(w);
    for (const char* name : {"u", "v"})
        w.putRamp(w.define(name, NC_FLOAT, axes), 24);
    const int bounds = w.dimension("nv", 2);
    w.putRamp(w.define("lat_bnds", NC_FLOAT, {axes[1], bounds}), 6);
    int lat = -1;
    nc_inq_varid(w.file(), "lat", &lat);
    w.text(lat, "bounds", "lat_bnds");
    const auto path = w.finish();
    expectRefusal(path, "'u', 'v'");
    ReadOptions options;
    options.field = "v";
    EXPECT_THAT(read(path, options), test::IsOk());
    EXPECT_EQ(listVolumes(path).value().fields.size(), 2u) << "bounds are no field";
}

TEST_P(NetcdfReader, PrefersTheOneWithDepth) {
    auto w = writer();
    const auto axes = evenAxes(w);
    w.putRamp(w.define("mask", NC_BYTE, {axes[1], axes[2]}), 12);
    w.putRamp(w.define("v", NC_FLOAT, axes), 24);
    const auto path = w.finish();
    const auto grid = read(path);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->dims()[2], 2);
    EXPECT_FALSE(listVolumes(path).value().needsChoice());
}

TEST_P(NetcdfReader, FallsBackToIndicesWhereCoordinatesAreNone) {
    auto w = writer();
    const int z = w.dimension("a", 2), y = w.axis("b", {0, 1, 0}), x = w.axis("c", {0, 2, 4, 6});
    w.putRamp(w.define("v", NC_FLOAT, {z, y, x}), 24);
    const auto path = w.finish();
    const auto grid = read(path);
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->geometry().spacing, glm::dvec3(2, 1, 1));
    EXPECT_THAT(notesOf(path), testing::Contains(HasSubstr("'a' has no coordinates")));
    EXPECT_THAT(notesOf(path), testing::Contains(HasSubstr("b: the coordinates neither")));
}

TEST_P(NetcdfReader, RefusesPackingThatIsNone) {
    for (const double slope : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
        auto w = writer();
        const int v = w.define("v", NC_SHORT, evenAxes(w));
        w.number(v, "scale_factor", NC_DOUBLE, {slope});
        w.putRamp(v, 24);
        expectRefusal(w.finish(), "scale_factor");
    }
}

TEST_P(NetcdfReader, RefusesEmptySeries) {
    auto w = writer();
    auto axes = evenAxes(w);
    axes.insert(axes.begin(), w.dimension("time", NC_UNLIMITED));
    w.define("v", NC_FLOAT, axes);
    expectRefusal(w.finish(), "series of none");
}

TEST_P(NetcdfReader, RefusesEveryShorterFile) {
    auto w = writer();
    w.putRamp(w.define("v", NC_DOUBLE, evenAxes(w)), 24);
    const std::string whole = test::readText(w.finish());
    for (std::size_t size = 1; size + 4 < whole.size(); size += test::kSparser * (GetParam() ? 241 : 17))
        ASSERT_FALSE(read(folder.write("b.nc", whole.substr(0, size))).isOk()) << size << " of " << whole.size();
}

TEST_P(NetcdfReader, SurvivesEveryDamagedByte) {
    auto w = writer();
    w.putRamp(w.define("v", NC_DOUBLE, evenAxes(w)), 24);
    const std::string whole = test::readText(w.finish());
    for (std::size_t i = 0; i < whole.size(); i += 1 + whole.size() * test::kSparser / 60) {
        std::string damaged = whole;
        damaged[i] = static_cast<char>(damaged[i] ^ 0x55);
        static_cast<void>(read(folder.write("b.nc", damaged)));
    }
}

TEST(NetcdfGroups, AreSearched) {
    const test::TemporaryFolder folder;
    Writer w(folder / "a.nc", true);
    int group = -1, v = -1;
    const int x = w.axis("lon", {0, 2}), y = w.dimension("b", 2);
    nc_def_grp(w.file(), "model", &group);
    const int dimensions[3] = {y, y, x};
    nc_def_var(group, "v", NC_FLOAT, 3, dimensions, &v);
    nc_def_var_deflate(group, v, 1, 1, 9);
    const auto values = std::vector<float>{0, 1, 2, 3, 4, 5, 6, 7};
    nc_put_var_float(group, v, values.data());
    const auto grid = readVolume(w.finish());
    ASSERT_THAT(grid, test::IsOk());
    EXPECT_EQ(grid.value()->geometry().spacing.x, 2.0) << "coordinates of the group above";
    EXPECT_EQ(grid.value()->valueAt(1, 1, 1), 7.0);
}

TEST(NetcdfNames, AreNoAddresses) {
    EXPECT_THAT(readVolume("https://localhost/a.nc"), test::HasError(ErrorCode::NotFound));
    const test::TemporaryFolder folder;
    EXPECT_FALSE(readVolume(folder.write("a#mode=zarr.nc", "no")).isOk());
}

} // namespace
} // namespace isoslider::io
