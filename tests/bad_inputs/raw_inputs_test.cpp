// B001 to B026: samples without a header.

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include <fmt/format.h>

#include "tests/bad_inputs/bad_input_fixture.h"
#include "tests/support/sanitizers.h"
#include "tests/support/slab_oracle.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

using Vertex = std::array<double, 3>;

/// What is read of an OBJ file: places as they are written, and triangles.
struct ObjMesh {
    explicit ObjMesh(const std::string& bytes) {
        std::istringstream text(bytes);
        std::string line;
        while (std::getline(text, line)) {
            std::istringstream words(line);
            std::string key, word;
            words >> key;
            if (key == "v") {
                Vertex place{};
                for (double& number : place) {
                    words >> word;
                    number = std::strtod(word.c_str(), nullptr); // "nan" and "inf" as well
                }
                vertices.push_back(place);
            } else if (key == "f") {
                std::array<std::size_t, 3> triangle{};
                for (std::size_t& corner : triangle) {
                    words >> word;
                    corner = std::strtoul(word.c_str(), nullptr, 10) - 1;
                }
                triangles.push_back(triangle);
            }
        }
    }
    bool isFinite() const {
        return std::all_of(vertices.begin(), vertices.end(), [](const Vertex& v) {
            return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
        });
    }
    /// Each vertex within an edge of the grid, off its ends.
    bool liesOnEdges() const {
        return std::all_of(vertices.begin(), vertices.end(), [](const Vertex& v) {
            return std::count_if(v.begin(), v.end(), [](double x) { return x == std::floor(x); }) == 2;
        });
    }
    Vertex middleOf(const std::array<std::size_t, 3>& triangle) const {
        Vertex middle{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const std::size_t corner : triangle)
                middle[axis] += vertices[corner][axis] / 3.0;
        return middle;
    }

    std::vector<Vertex> vertices;
    std::vector<std::array<std::size_t, 3>> triangles;
};

class BadRaw : public BadInputTest {
protected:
    OrderedJson extract(const std::vector<std::string>& volume, const std::string& isovalue) const {
        return expectAcceptedSoon(joined(joined({"extract"}, volume), {"--isovalue", isovalue}));
    }
    // The mesh of an export, judged by the program's own check of files.
    OrderedJson exported(const std::vector<std::string>& volume, const std::string& isovalue) const {
        const auto out = path("surface.ply");
        fs::remove(out);
        const auto made = run(joined(joined({"extract"}, volume), {"--isovalue", isovalue, "-o", out}));
        EXPECT_EQ(made.exitCode, 0) << made.standardError;
        const auto checked = run({"check", out, "--json"});
        return OrderedJson::parse(checked.standardOutput, nullptr, false);
    }
    // The volume itself, and indexes of both kinds of it: what `extract` is given.
    std::vector<std::vector<std::string>> allForms(const std::vector<std::string>& volume) const {
        std::vector<std::vector<std::string>> forms{volume};
        for (const auto* kind : {"edges", "metacells"}) {
            const auto index = path(std::string(kind) + ".isx");
            const auto built = run(joined(joined({"build"}, volume), {"-o", index, "--index", kind}));
            EXPECT_EQ(built.exitCode, 0) << built.standardError;
            forms.push_back({index});
        }
        return forms;
    }
    // Components, Euler number, boundary loops and active edges, as sweeping each cell in slices finds them.
    template <class Sample>
    static void expectOracleCounts(const OrderedJson& json, const std::vector<Sample>& samples, std::int64_t side,
                                   double isovalue) {
        const auto expected =
            sweepGrid(std::vector<double>(samples.begin(), samples.end()), {side, side, side}, isovalue);
        EXPECT_EQ(json["components"], expected.components) << isovalue;
        EXPECT_EQ(json["euler"], expected.euler) << isovalue;
        EXPECT_EQ(json["boundary_loops"], expected.loops) << isovalue;
        EXPECT_EQ(json["active_edges"], expected.activeEdges) << isovalue;
        EXPECT_EQ(json["valid"], true) << isovalue;
    }
    ObjMesh objMesh(const std::vector<std::string>& source, const std::string& isovalue) const {
        const auto made = run(joined(joined({"extract"}, source), {"--isovalue", isovalue, "-o", path("a.obj")}));
        EXPECT_EQ(made.exitCode, 0) << made.standardError;
        return ObjMesh(readText(path("a.obj")));
    }
    std::string sparse(const std::string& name, std::uint64_t bytes) const {
        folder_.write(name, "");
        fs::resize_file(path(name), bytes);
        return path(name);
    }
};

TEST_F(BadRaw, B001_OneByteShort) {
    const auto volume = raw("a.raw", std::string(63, 'x'), "4,4,4", "u8");
    expectRefusedSoon(joined({"info"}, volume), "has 63 bytes");
    expectRefusedSoon(joined({"info"}, volume), "64");
}

TEST_F(BadRaw, B002_LongerThanAskedFor) {
    const auto volume = raw("a.raw", std::string(65, 'x'), "4,4,4", "u8");
    expectRefusedSoon(joined({"info"}, volume), "has 65 bytes");
    expectRefusedSoon(joined({"info"}, volume), "64");
    const auto json = expectAcceptedSoon(joined(joined({"info"}, volume), {"--allow-trailing"}));
    EXPECT_EQ(json["dims"], OrderedJson({4, 4, 4}));
    EXPECT_THAT(json["notes"].dump(), ::testing::AllOf(HasSubstr("65 bytes"), HasSubstr("1 byte")));
    expectRefusedSoon(joined(joined({"extract"}, volume), {"--isovalue", "1"}), "has 65 bytes");
    expectRefusedSoon(joined(joined({"build"}, volume), {"-o", path("a.isx")}), "has 65 bytes");
    extract(joined(volume, {"--allow-trailing"}), "1");
    fs::resize_file(path("a.raw"), (std::uint64_t{1} << 30) + 64);
    expectRefusedSoon(joined({"info"}, volume), "has 1073741888 bytes");
    EXPECT_THAT(expectAcceptedSoon(joined(joined({"info"}, volume), {"--allow-trailing"}))["notes"].dump(),
                HasSubstr("1073741824 bytes"));
}

TEST_F(BadRaw, B003_Empty) {
    expectRefusedSoon(joined({"info"}, raw("a.raw", "", "4,4,4", "u8")), "has 0 bytes");
    for (const auto* name : {"a.mha", "a.nrrd", "a.nii", "a.vti", "a.vtk", "a.dcm", "a.h5", "a.nc", "a.tif", "a.mrc"})
        expectFileRefused(name, "", "is empty");
}

TEST_F(BadRaw, B004_ZeroExtent) {
    expectRefusedSoon(joined({"info"}, raw("a.raw", std::string(100, 'x'), "0,10,10", "u8")), "extent 0");
}

TEST_F(BadRaw, B005_WithoutCells) {
    for (const auto* dims : {"1,1,1", "1,64,64", "64,64,1"}) {
        const std::size_t samples = std::string_view(dims) == "1,1,1" ? 1 : 4096;
        const auto volume = raw("a.raw", std::string(samples, 'x').replace(0, 1, "a"), dims, "u8");
        const auto json = extract(volume, "110");
        EXPECT_EQ(json["triangles"], 0);
        EXPECT_THAT(expectAcceptedSoon(joined({"info"}, volume))["notes"].dump(), HasSubstr("no cells"));
        for (const auto* kind : {"edges", "metacells"}) {
            expectAcceptedSoon(joined(joined({"build"}, volume), {"-o", path("a.isx"), "--index", kind}));
            EXPECT_EQ(extract({path("a.isx")}, "110")["triangles"], 0) << kind;
            EXPECT_EQ(exported({path("a.isx")}, "110")["triangles"], 0) << kind;
            EXPECT_EQ(expectAcceptedSoon({"stats", path("a.isx")})["kind"], kind);
            EXPECT_EQ(expectAcceptedSoon({"slide", path("a.isx"), "--path", "110,97,130"})["steps"].size(), 3u) << kind;
        }
    }
}

TEST_F(BadRaw, B006_OneCell) {
    const auto volume = raw("a.raw", std::string("\0\0\0\0\0\0\0\x08", 8), "2,2,2", "u8");
    for (const auto& form : allForms(volume)) {
        EXPECT_EQ(extract(form, "4")["triangles"], 1) << form[0];
        EXPECT_EQ(objMesh(form, "4").vertices, (std::vector<Vertex>{{1, 1, 0.5}, {1, 0.5, 1}, {0.5, 1, 1}})) << form[0];
    }
}

TEST_F(BadRaw, B007_NegativeExtent) {
    expectRefusedSoon(joined({"info"}, raw("a.raw", std::string(4096, 'x'), "-1,64,64", "u8")), "extent -1");
}

TEST_F(BadRaw, B008_ProductThatWrapsIn32Bits) {
    expectRefusedSoon(joined({"info"}, raw("a.raw", std::string(65536, 'x'), "65536,65537,1", "u8")), "4295032832");
}

TEST_F(BadRaw, B009_ProductThatWrapsIn64Bits) {
    expectRefusedSoon(joined({"info"}, raw("a.raw", std::string(64, 'x'), "2097152,2097152,2097152", "u8")), "extent");
}

TEST_F(BadRaw, B010_ProductThatWrapsToNothing) {
    expectRefusedSoon(joined({"info"}, raw("a.raw", std::string(64, 'x'), "4294967296,4294967296,1", "u8")), "extent");
}

TEST_F(BadRaw, B011_MorePointsThan31Bits) {
#if ISO_HAS_SANITIZER
    GTEST_SKIP() << "3 billion samples under a sanitizer take minutes";
#endif
    const auto file = sparse("a.raw", std::uint64_t{1536} * 1536 * 1297);
    {
        std::fstream last(file, std::ios::in | std::ios::out | std::ios::binary);
        last.seekp(-1, std::ios::end);
        last.put('\x08');
    }
    ProcessOptions patient;
    patient.timeout = std::chrono::minutes(4);
    const auto built = run({"build", file, "--raw-dims", "1536,1536,1297", "--raw-type", "u8", "-o", path("a.isx"),
                            "--index", "metacells", "--memory", "512M"},
                           patient);
    ASSERT_EQ(built.exitCode, 0) << built.standardError;
    const auto made = run({"extract", path("a.isx"), "--isovalue", "4", "-o", path("a.off"), "--json"}, patient);
    ASSERT_EQ(made.exitCode, 0) << made.standardError;
    EXPECT_EQ(OrderedJson::parse(made.standardOutput)["triangles"], 1);
    // Three corners, each half way from the last grid point to a neighbour.
    EXPECT_THAT(readText(path("a.off")), HasSubstr("1534.5 1535 1296"));
    EXPECT_THAT(readText(path("a.off")), HasSubstr("1535 1535 1295.5"));
    const auto topology = run({"topology", path("a.isx"), "--events", "0", "--json"}, patient);
    ASSERT_EQ(topology.exitCode, 0) << topology.standardError;
    EXPECT_THAT(topology.standardOutput, HasSubstr("[1535.0,1535.0,1296.0]"));
}

TEST_F(BadRaw, B012_BeyondTheMachine) {
    const auto file = sparse("a.raw", std::uint64_t{2049} * 2049 * 2049);
    ProcessOptions bounded;
#if !ISO_HAS_SANITIZER
    bounded.addressSpaceBytes = std::uint64_t{4} << 30;
#endif
    const auto result = run({"build", file, "--raw-dims", "2049,2049,2049", "--raw-type", "u8", "-o", path("a.isx"),
                             "--index", "metacells", "--memory", "64M"},
                            bounded);
    EXPECT_EQ(result.exitCode, 3) << result.standardError;
    EXPECT_THAT(result.standardError, HasSubstr("memory budget is too small"));
    EXPECT_FALSE(fs::exists(path("a.isx")));
#if !ISO_HAS_SANITIZER
    EXPECT_LT(result.peakRssBytes, std::uint64_t{192} << 20) << "before any allocation";
    EXPECT_LT(result.processorTime, std::chrono::seconds(1));
    // Nor is it read whole where there is no memory for it.
    const auto whole =
        run({"extract", file, "--raw-dims", "2049,2049,2049", "--raw-type", "u8", "--isovalue", "1"}, bounded);
    EXPECT_THAT(whole.exitCode, ::testing::AnyOf(3, 4)) << whole.standardError;
    EXPECT_EQ(std::count(whole.standardError.begin(), whole.standardError.end(), '\n'), 1) << whole.standardError;
    EXPECT_THAT(whole.standardError, HasSubstr("memory"));
    EXPECT_LT(whole.processorTime, std::chrono::seconds(1));
#endif
}

TEST_F(BadRaw, B013_UnknownType) {
    for (const auto* type : {"float128", "", "u128", "%s"})
        expectRefusedSoon(joined({"info"}, raw("a.raw", std::string(64, 'x'), "4,4,4", type)), "sample type", 2);
}

TEST_F(BadRaw, B014_SwappedBytes) {
    std::vector<std::uint16_t> ramp;
    for (int i = 0; i < 32 * 32 * 32; ++i) {
        const auto value = static_cast<std::uint16_t>(i % 32 * 9 + i / 32 % 32 * 7 + i / 1024 * 5);
        ramp.push_back(static_cast<std::uint16_t>(value << 8 | value >> 8));
    }
    const auto volume = raw("a.raw", samplesOf(ramp), "32,32,32", "u16");
    const auto wrong = expectAcceptedSoon(joined({"info"}, volume));
    EXPECT_THAT(wrong["notes"].dump(), HasSubstr("byte order"));
    EXPECT_EQ(wrong["max"], 0xff01) << "as it was asked for, not as it seems to be meant";
    const auto right = expectAcceptedSoon(joined(joined({"info"}, volume), {"--big-endian"}));
    EXPECT_FALSE(right.contains("notes")) << right.dump();
    EXPECT_EQ(right["max"], 31 * 21);
}

TEST_F(BadRaw, B015_NothingFinite) {
    const float inf = std::numeric_limits<float>::infinity();
    std::vector<float> mixed(64, inf);
    mixed[7] = -inf;
    mixed[9] = std::nanf("");
    const std::pair<const char*, std::string> volumes[] = {{"f32", samplesOf(std::vector<float>(64, std::nanf("")))},
                                                           {"f32", samplesOf(mixed)},
                                                           {"f64", samplesOf(std::vector<double>(64, std::nan("")))}};
    for (const auto& [type, bytes] : volumes) {
        const auto volume = raw("a.raw", bytes, "4,4,4", type);
        expectRefusedSoon(joined({"info"}, volume), "no finite sample");
        expectRefusedSoon(joined(joined({"extract"}, volume), {"--isovalue", "0"}), "no finite sample");
        expectRefusedSoon(joined(joined({"topology"}, volume), {"--at", "0"}), "no finite sample");
        for (const auto* kind : {"edges", "metacells"})
            expectRefusedSoon(joined(joined({"build"}, volume), {"-o", path("a.isx"), "--index", kind}),
                              "no finite sample");
    }
}

std::vector<float> ball() {
    std::vector<float> samples;
    for (int z = -5; z <= 5; ++z)
        for (int y = -5; y <= 5; ++y)
            for (int x = -5; x <= 5; ++x)
                samples.push_back(4.0f - std::sqrt(static_cast<float>(x * x + y * y + z * z)));
    return samples;
}

TEST_F(BadRaw, B016_OneMissingSample) {
    auto samples = ball();
    samples[0] = std::nanf("");
    const auto volume = raw("a.raw", samplesOf(samples), "11,11,11", "f32");
    EXPECT_EQ(expectAcceptedSoon(joined({"info"}, volume))["nan_count"], 1);
    EXPECT_EQ(exported(volume, "1")["closed"], true) << "the corner is far from the surface";
    samples[5 + 11 * 5 + 121 * 9] = std::nanf(""); // upon it
    const auto holed = raw("b.raw", samplesOf(samples), "11,11,11", "f32");
    EXPECT_EQ(expectAcceptedSoon(joined({"info"}, holed))["nan_count"], 2);
    for (const auto& form : allForms(holed)) {
        SCOPED_TRACE(form[0]);
        const auto open = extract(form, "0.25");
        EXPECT_EQ(open["valid"], true);
        EXPECT_EQ(open["closed"], false);
        EXPECT_EQ(open["boundary_loops"], 1);
        for (const auto& opening : open["open_at"].items())
            EXPECT_EQ(opening.value()["loops"], opening.key() == "missing" ? 1 : 0) << opening.key();
        // Of the eight cells around the missing sample there is nothing.
        const ObjMesh mesh = objMesh(form, "0.25");
        EXPECT_GT(mesh.triangles.size(), 100u);
        for (const auto& triangle : mesh.triangles) {
            const Vertex middle = mesh.middleOf(triangle);
            EXPECT_FALSE(std::abs(middle[0] - 5) < 1 && std::abs(middle[1] - 5) < 1 && std::abs(middle[2] - 9) < 1);
        }
    }
}

TEST_F(BadRaw, B017_Infinities) {
    auto samples = ball();
    samples[5 + 11 * 5 + 121 * 8] = std::numeric_limits<float>::infinity();
    samples[5 + 11 * 5 + 121 * 9] = -std::numeric_limits<float>::infinity();
    const auto volume = raw("a.raw", samplesOf(samples), "11,11,11", "f32");
    EXPECT_EQ(expectAcceptedSoon(joined({"info"}, volume))["nan_count"], 2);
    const auto info = expectAcceptedSoon(joined({"info"}, volume));
    EXPECT_EQ(info["max"], 4.0);
    EXPECT_NEAR(info["min"].get<double>(), 4.0 - std::sqrt(75.0), 1e-5);
    for (const auto& form : allForms(volume))
        for (const auto* isovalue : {"0.25", "-1", "1", "3.4e38", "-3.4e38"}) {
            SCOPED_TRACE(form[0] + " at " + isovalue);
            EXPECT_EQ(extract(form, isovalue)["valid"], true);
            const ObjMesh mesh = objMesh(form, isovalue);
            EXPECT_TRUE(mesh.isFinite());
            EXPECT_EQ(mesh.vertices.empty(), std::string_view(isovalue).size() > 5);
        }
}

TEST_F(BadRaw, B018_TwoZeros) {
    auto samples = ball();
    for (float& sample : samples)
        sample = sample > 0.0f ? sample : 0.0f;
    const auto volume = raw("a.raw", samplesOf(samples), "11,11,11", "f32");
    const auto plain = extract(volume, "0"), small = extract(volume, "1e-45");
    EXPECT_EQ(plain["triangles"], 0) << "nothing is below";
    EXPECT_GT(small["triangles"], 0);
    for (std::size_t i = 0; i < samples.size(); i += 3)
        samples[i] = samples[i] == 0.0f ? -0.0f : samples[i];
    const auto mixedVolume = raw("b.raw", samplesOf(samples), "11,11,11", "f32");
    EXPECT_EQ(expectAcceptedSoon(joined({"info"}, mixedVolume))["distinct_values"],
              expectAcceptedSoon(joined({"info"}, volume))["distinct_values"]);
    for (const auto& form : allForms(mixedVolume))
        for (const auto* isovalue : {"0", "-0", "-0.0", "1e-45"}) {
            const auto mixed = extract(form, isovalue);
            const auto& expected = std::string_view(isovalue) == "1e-45" ? small : plain;
            for (const auto* key : {"vertices", "triangles", "components", "euler", "boundary_loops"})
                EXPECT_EQ(expected[key], mixed[key]) << key << " of " << form[0] << " at " << isovalue;
        }
}

TEST_F(BadRaw, B019_Denormals) {
    auto samples = ball();
    const float least = std::numeric_limits<float>::denorm_min();
    for (float& sample : samples)
        sample = sample > 0.0f ? 7 * least : 2 * least;
    const auto volume = raw("a.raw", samplesOf(samples), "11,11,11", "f32");
    const auto mesh = exported(volume, "6.3e-45"); // between 4 and 5 of the least
    EXPECT_EQ(mesh["closed"], true);
    EXPECT_EQ(mesh["manifold"], true);
    EXPECT_EQ(mesh["euler"], 2);
    EXPECT_EQ(mesh["degenerate_triangles"], 0);
    for (const auto& form : allForms(volume))
        EXPECT_TRUE(objMesh(form, "6.3e-45").liesOnEdges()) << form[0];
    // And of f64, whose least is 5e-324.
    std::vector<double> wide;
    for (const float sample : samples)
        wide.push_back((sample == 7 * least ? 7 : 2) * std::numeric_limits<double>::denorm_min());
    for (const auto& form : allForms(raw("b.raw", samplesOf(wide), "11,11,11", "f64")))
        EXPECT_TRUE(objMesh(form, "2e-323").liesOnEdges()) << form[0];
}

TEST_F(BadRaw, B020_DifferenceThatOverflows) {
    auto samples = ball();
    const float most = std::numeric_limits<float>::max();
    for (float& sample : samples)
        sample = sample > 0.0f ? most : -most;
    const auto volume = raw("a.raw", samplesOf(samples), "11,11,11", "f32");
    const auto mesh = exported(volume, "0");
    EXPECT_EQ(mesh["closed"], true);
    EXPECT_EQ(mesh["euler"], 2);
    EXPECT_EQ(mesh["degenerate_triangles"], 0);
    for (const auto& form : allForms(volume))
        for (const auto* isovalue : {"0", "1e38", "-3.4e38", "3.4e38"})
            EXPECT_TRUE(objMesh(form, isovalue).liesOnEdges()) << form[0] << " at " << isovalue;
    std::vector<double> wide;
    for (const float sample : samples)
        wide.push_back(sample > 0.0f ? std::numeric_limits<double>::max() : std::numeric_limits<double>::lowest());
    for (const auto& form : allForms(raw("b.raw", samplesOf(wide), "11,11,11", "f64")))
        for (const auto* isovalue : {"0", "1e308", "-1.7e308"})
            EXPECT_TRUE(objMesh(form, isovalue).liesOnEdges()) << form[0] << " at " << isovalue;
}

TEST_F(BadRaw, B021_Constant) {
    const auto volume = raw("a.raw", std::string(512, '\x05'), "8,8,8", "u8");
    EXPECT_EQ(expectAcceptedSoon(joined({"info"}, volume))["distinct_values"], 1);
    for (const auto* isovalue : {"4", "5", "6"})
        EXPECT_EQ(extract(volume, isovalue)["triangles"], 0) << isovalue;
    for (const auto* kind : {"edges", "metacells"}) {
        expectAcceptedSoon(joined(joined({"build"}, volume), {"-o", path("a.isx"), "--index", kind}));
        EXPECT_EQ(extract({path("a.isx")}, "5")["triangles"], 0) << kind;
        const auto level = expectAcceptedSoon({"stats", path("a.isx")})["levels"][0];
        EXPECT_EQ(level["blocks"], 0) << "no isovalue changes anything";
        EXPECT_EQ(level["edges"], 0);
        const auto steps = expectAcceptedSoon({"slide", path("a.isx"), "--path", "4,5,6,5,4"})["steps"];
        EXPECT_EQ(steps.size(), 5u);
        for (const auto& step : steps)
            EXPECT_EQ(step["edges_touched"], 0);
    }
}

TEST_F(BadRaw, B022_Checkerboard) {
    std::vector<std::int8_t> samples;
    for (int i = 0; i < 512; ++i)
        samples.push_back(static_cast<std::int8_t>((i + i / 8 + i / 64) % 2 == 0 ? 1 : -1));
    const auto volume = raw("a.raw", samplesOf(samples), "8,8,8", "i8");
    for (const auto& form : allForms(volume))
        for (const auto* isovalue : {"0", "1", "0.5", "-0.999"})
            expectOracleCounts(extract(form, isovalue), samples, 8, std::stod(isovalue));
    const auto mesh = exported(volume, "0");
    EXPECT_EQ(mesh["manifold"], true);
    EXPECT_EQ(mesh["oriented"], true);
    EXPECT_EQ(mesh["degenerate_triangles"], 0);
    EXPECT_EQ(mesh["duplicate_triangles"], 0);
}

TEST_F(BadRaw, B023_IsovalueOnSamplesEverywhere) {
    std::vector<std::uint8_t> samples;
    for (int z = -5; z <= 5; ++z)
        for (int y = -5; y <= 5; ++y)
            for (int x = -5; x <= 5; ++x) {
                const int distance = std::abs(x) + std::abs(y) + std::abs(z);
                samples.push_back(static_cast<std::uint8_t>(distance > 6 ? 0 : 6 - distance));
            }
    const auto volume = raw("a.raw", samplesOf(samples), "11,11,11", "u8");
    for (const auto* isovalue : {"2", "3", "4", "5", "6"}) {
        const auto mesh = exported(volume, isovalue);
        EXPECT_EQ(mesh["closed"], true) << isovalue;
        EXPECT_EQ(mesh["manifold"], true) << isovalue;
        EXPECT_EQ(mesh["euler"], 2) << isovalue;
        EXPECT_EQ(mesh["degenerate_triangles"], 0) << isovalue;
    }
    // The surface at a sample's value is the limit of those below it.
    for (const auto& form : allForms(volume))
        for (const int isovalue : {1, 2, 3, 4, 5, 6}) {
            const auto at = extract(form, std::to_string(isovalue)),
                       below = extract(form, std::to_string(isovalue - 1) + ".999999999");
            for (const auto* key : {"vertices", "triangles", "active_edges", "components", "euler", "boundary_loops"})
                EXPECT_EQ(at[key], below[key]) << key << " of " << form[0] << " at " << isovalue;
            expectOracleCounts(at, samples, 11, isovalue);
        }
}

TEST_F(BadRaw, B024_SourceThatChangesMeanwhile) {
    // Large enough for what changes to come while a build lasts.
    const auto volume = noiseVolume(test::kHasSanitizers ? 96 : 120),
               larger = noiseVolume(test::kHasSanitizers ? 128 : 200, "larger.mha");
    const std::string samples = readText(volume), largerSamples = readText(larger);
    fs::remove(larger);
    struct Change {
        const char* name;
        std::function<void()> make;
    };
    const auto overwrite = [&](std::streamoff place) {
        std::fstream file(volume, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(place);
        file << std::string(100'000, 'x');
    };
    const std::vector<Change> changes{
        {"overwritten in its first part", [&] { overwrite(1 << 20); }},
        {"overwritten in its last part", [&] { overwrite(3 << 20); }},
        {"overwritten, its time set back",
         [&, time = fs::last_write_time(volume)] {
             overwrite(1 << 20);
             fs::last_write_time(volume, time);
         }},
        {"replaced", [&] { fs::rename(path("noise.new"), volume); }},
        {"shorter", [&] { fs::resize_file(volume, 4096); }},
        {"longer", [&] { fs::resize_file(volume, fs::file_size(volume) + 4096); }},
        {"deleted", [&] { fs::remove(volume); }},
        {"unreadable", [&] { fs::permissions(volume, fs::perms::none); }},
    };
    for (const Change& change : changes)
        for (const auto* kind : {"edges", "metacells"}) {
            SCOPED_TRACE(fmt::format("{}, {}", change.name, kind));
            const bool isMetacells = std::string_view(kind) == "metacells";
            folder_.write("noise.mha", isMetacells ? largerSamples : samples);
            if (std::string_view(change.name) == "replaced") // ready beforehand: the build would be done
                folder_.write("noise.new", std::string(fs::file_size(volume), 'x'));
            ProcessOptions options;
            options.timeout = std::chrono::seconds(50);
            options.signalToSend = SIGCONT; // harmless: the moment is what is wanted
            options.signalWhen = [&] {
                if (!fs::exists(path("a.isx.partial")))
                    return false;
                change.make();
                return true;
            };
            const auto result =
                run({"build", volume, "-o", path("a.isx"), "--index", kind, "--memory", "64M"}, options);
            EXPECT_EQ(result.exitCode, 3) << result.standardError;
            EXPECT_THAT(result.standardError, HasSubstr("noise.mha"));
            if (std::string_view(change.name) != "shorter") { // which may be found first by reading
                EXPECT_THAT(result.standardError, HasSubstr("changed while it was read"));
            }
            EXPECT_EQ(std::count(result.standardError.begin(), result.standardError.end(), '\n'), 1)
                << result.standardError;
            fs::remove(volume);
            EXPECT_TRUE(folder_.names().empty()) << folder_.names().front();
        }
}

TEST_F(BadRaw, B025_NoRegularFile) {
    fs::create_directory(path("folder.mha"));
    ASSERT_EQ(::mkfifo(path("pipe.mha").c_str(), 0600), 0);
    const int listener = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path("s.mha").copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    expectRefusedSoon({"info", path("folder.mha")}, "folder");
    expectRefusedSoon({"info", path("pipe.mha")}, "regular file");
    expectRefusedSoon({"info", path("s.mha")}, "regular file");
    expectRefusedSoon({"info", "/dev/zero"}, "regular file");
    for (const auto& name : {path("folder.mha"), path("pipe.mha"), path("s.mha"), std::string("/dev/zero")})
        for (const auto& command : {std::vector<std::string>{"info"},
                                    {"build", "-o", path("a.isx")},
                                    {"extract", "--isovalue", "1"},
                                    {"resample", "-o", path("a.mha"), "--size", "4,4,4"}}) {
            std::vector<std::string> words{command[0], name, "--raw-dims", "4,4,4", "--raw-type", "u8"};
            words.insert(words.end(), command.begin() + 1, command.end());
            expectRefusedSoon(words, "regular file");
        }
    for (const auto& name : {path("pipe.mha"), path("s.mha"), std::string("/dev/zero")})
        for (const auto* command : {"stats", "check"})
            expectRefusedSoon({command, name}, "regular file");
    fs::create_symlink("/dev/zero", path("link.mha"));
    fs::create_symlink(path("nothing"), path("dangling.mha"));
    expectRefusedSoon({"info", path("link.mha")}, "regular file");
    expectRefusedSoon({"info", path("dangling.mha")}, "dangling.mha", 4);
    ::close(listener);
}

TEST_F(BadRaw, B026_StrangeNames) {
    const std::string bytes = readText(sphereVolume());
    for (const std::string name : {"new\nline.mha", "%s%n%d.mha", "no utf-8 \xff\xfe.mha", "-dash.mha", " spaces .mha",
                                   "\xd7\xa9\xd7\x9c\xd7\x95\xd7\x9d.mha", "quote'\"`$(x).mha"}) {
        folder_.write(name, bytes);
        EXPECT_EQ(expectAcceptedSoon({"info", path(name)})["dims"], OrderedJson({16, 16, 16})) << name;
        // Written under such names as well.
        const std::string index = path(name + ".isx"), mesh = path(name + ".ply");
        ASSERT_EQ(run({"build", path(name), "-o", index}).exitCode, 0) << name;
        EXPECT_GT(expectAcceptedSoon({"extract", index, "--isovalue", "5", "-o", mesh})["triangles"], 0) << name;
        EXPECT_EQ(expectAcceptedSoon({"check", mesh})["closed"], true) << name;
        folder_.write(name, bytes.substr(0, 900));
        expectRefusedSoon({"info", path(name)}, "isoslider-cli: ");
    }
    for (const auto* command : {"info", "stats", "check"})
        expectRefusedSoon({command, path(std::string(4096, 'a') + ".mha")}, "isoslider-cli: ", 4);
    expectRefusedSoon({"build", sphereVolume(), "-o", path(std::string(4096, 'a') + ".isx")}, "isoslider-cli: ", 4);
    expectRefusedSoon({"info", path(std::string(200, 'a') + "/" + std::string(200, 'b') + "/none.mha")}, "none.mha", 4);
    // The longest name that a file can have leaves no room for what is written beside it first.
    const auto longest = path(std::string(251, 'x') + ".isx");
    const auto built = run({"build", sphereVolume(), "-o", longest});
    EXPECT_TRUE(built.exitCode == 0 ? fs::exists(longest) : built.exitCode == 4 && !fs::exists(longest))
        << built.standardError;
    // A dash in front: relative to the folder that the program runs in, and behind "--".
    folder_.write("-dash.mha", bytes);
    const ProcessResult dashed = run({"info", "--json", "--", "-dash.mha"});
    EXPECT_EQ(dashed.exitCode, 0) << dashed.standardError;
    expectRefusedSoon({"info", "-dash.mha"}, "isoslider-cli: ", 2);
}

} // namespace
} // namespace isoslider::test
