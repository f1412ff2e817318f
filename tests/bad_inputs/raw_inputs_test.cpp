// B001 to B026: samples without a header.

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/bad_inputs/bad_input_fixture.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

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
    EXPECT_THAT(json["notes"].dump(), HasSubstr("1 byte"));
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
        }
    }
}

TEST_F(BadRaw, B006_OneCell) {
    const auto volume = raw("a.raw", std::string("\0\0\0\0\0\0\0\x08", 8), "2,2,2", "u8");
    EXPECT_EQ(extract(volume, "4")["triangles"], 1);
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
#if defined(__SANITIZE_ADDRESS__)
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
                            "--index", "metacells", "--memory", "512M"}, patient);
    ASSERT_EQ(built.exitCode, 0) << built.standardError;
    const auto made = run({"extract", path("a.isx"), "--isovalue", "4", "-o", path("a.off"), "--json"}, patient);
    ASSERT_EQ(made.exitCode, 0) << made.standardError;
    EXPECT_EQ(OrderedJson::parse(made.standardOutput)["triangles"], 1);
    // Three corners, each half way from the last grid point to a neighbour.
    EXPECT_THAT(readText(path("a.off")), HasSubstr("1534.5 1535 1296"));
    EXPECT_THAT(readText(path("a.off")), HasSubstr("1535 1535 1295.5"));
}

TEST_F(BadRaw, B012_BeyondTheMachine) {
    const auto file = sparse("a.raw", std::uint64_t{2049} * 2049 * 2049);
    ProcessOptions bounded;
#if !defined(__SANITIZE_ADDRESS__)
    bounded.addressSpaceBytes = std::uint64_t{4} << 30;
#endif
    const auto result = run({"build", file, "--raw-dims", "2049,2049,2049", "--raw-type", "u8", "-o", path("a.isx"),
                             "--index", "metacells", "--memory", "64M"}, bounded);
    EXPECT_EQ(result.exitCode, 3) << result.standardError;
    EXPECT_THAT(result.standardError, HasSubstr("memory budget is too small"));
    EXPECT_FALSE(fs::exists(path("a.isx")));
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
    EXPECT_THAT(expectAcceptedSoon(joined({"info"}, volume))["notes"].dump(), HasSubstr("byte order"));
    const auto right = expectAcceptedSoon(joined(joined({"info"}, volume), {"--big-endian"}));
    EXPECT_FALSE(right.contains("notes")) << right.dump();
    EXPECT_EQ(right["max"], 31 * 21);
}

TEST_F(BadRaw, B015_NothingFinite) {
    const auto volume = raw("a.raw", samplesOf(std::vector<float>(64, std::nanf(""))), "4,4,4", "f32");
    expectRefusedSoon(joined({"info"}, volume), "no finite sample");
    expectRefusedSoon(joined(joined({"extract"}, volume), {"--isovalue", "0"}), "no finite sample");
    for (const auto* kind : {"edges", "metacells"})
        expectRefusedSoon(joined(joined({"build"}, volume), {"-o", path("a.isx"), "--index", kind}), "no finite sample");
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
    const auto open = exported(raw("b.raw", samplesOf(samples), "11,11,11", "f32"), "0.25");
    EXPECT_EQ(open["manifold"], true);
    EXPECT_EQ(open["closed"], false);
}

TEST_F(BadRaw, B017_Infinities) {
    auto samples = ball();
    samples[5 + 11 * 5 + 121 * 8] = std::numeric_limits<float>::infinity();
    samples[5 + 11 * 5 + 121 * 9] = -std::numeric_limits<float>::infinity();
    const auto volume = raw("a.raw", samplesOf(samples), "11,11,11", "f32");
    EXPECT_EQ(expectAcceptedSoon(joined({"info"}, volume))["nan_count"], 2);
    EXPECT_EQ(exported(volume, "0.25")["manifold"], true);
    const auto mesh = run(joined(joined({"extract"}, volume), {"--isovalue", "0.25", "-o", path("a.obj")}));
    ASSERT_EQ(mesh.exitCode, 0) << mesh.standardError;
    EXPECT_THAT(readText(path("a.obj")), ::testing::Not(::testing::AnyOf(HasSubstr("nan"), HasSubstr("inf"))));
}

TEST_F(BadRaw, B018_TwoZeros) {
    auto samples = ball();
    for (float& sample : samples)
        sample = sample > 0.0f ? sample : 0.0f;
    const auto plain = extract(raw("a.raw", samplesOf(samples), "11,11,11", "f32"), "0");
    for (std::size_t i = 0; i < samples.size(); i += 3)
        samples[i] = samples[i] == 0.0f ? -0.0f : samples[i];
    const auto mixed = extract(raw("b.raw", samplesOf(samples), "11,11,11", "f32"), "0");
    for (const auto* key : {"vertices", "triangles", "components", "euler", "boundary_loops"})
        EXPECT_EQ(plain[key], mixed[key]) << key;
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
    EXPECT_THAT(readText(path("surface.ply")), ::testing::Not(HasSubstr("nan")));
}

TEST_F(BadRaw, B021_Constant) {
    const auto volume = raw("a.raw", std::string(512, '\x05'), "8,8,8", "u8");
    EXPECT_EQ(expectAcceptedSoon(joined({"info"}, volume))["distinct_values"], 1);
    for (const auto* isovalue : {"4", "5", "6"})
        EXPECT_EQ(extract(volume, isovalue)["triangles"], 0) << isovalue;
    for (const auto* kind : {"edges", "metacells"}) {
        expectAcceptedSoon(joined(joined({"build"}, volume), {"-o", path("a.isx"), "--index", kind}));
        EXPECT_EQ(extract({path("a.isx")}, "5")["triangles"], 0) << kind;
    }
}

TEST_F(BadRaw, B022_Checkerboard) {
    std::vector<std::int8_t> samples;
    for (int i = 0; i < 512; ++i)
        samples.push_back(static_cast<std::int8_t>((i + i / 8 + i / 64) % 2 == 0 ? 1 : -1));
    const auto mesh = exported(raw("a.raw", samplesOf(samples), "8,8,8", "i8"), "0");
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
}

TEST_F(BadRaw, B024_SourceThatShrinksMeanwhile) {
    for (const bool removes : {false, true}) {
        const auto volume = noiseVolume(112);
        ProcessOptions options;
        options.timeout = std::chrono::seconds(50);
        options.signalToSend = SIGCONT; // harmless: the moment is what is wanted
        options.signalWhen = [&] {
            if (folder_.names().size() < 2)
                return false;
            fs::resize_file(volume, 4096);
            if (removes)
                fs::remove(volume);
            return true;
        };
        const auto result = run({"build", volume, "-o", path("a.isx"), "--memory", "64M"}, options);
        EXPECT_NE(result.exitCode, 0);
        EXPECT_THAT(result.exitCode, ::testing::AnyOf(3, 4)) << result.standardError;
        EXPECT_THAT(result.standardError, HasSubstr("noise.mha"));
        EXPECT_FALSE(fs::exists(path("a.isx")));
        fs::remove(volume);
        EXPECT_TRUE(folder_.names().empty());
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
        expectRefusedSoon({"info", name, "--raw-dims", "4,4,4", "--raw-type", "u8"}, "regular file");
    ::close(listener);
}

TEST_F(BadRaw, B026_StrangeNames) {
    const std::string bytes = readText(sphereVolume());
    for (const std::string name : {"new\nline.mha", "%s%n%d.mha", "no utf-8 \xff\xfe.mha", "-dash.mha", " spaces .mha",
                                   "\xd7\xa9\xd7\x9c\xd7\x95\xd7\x9d.mha", "quote'\"`$(x).mha"}) {
        folder_.write(name, bytes);
        EXPECT_EQ(expectAcceptedSoon({"info", path(name)})["dims"], OrderedJson({16, 16, 16})) << name;
        folder_.write(name, bytes.substr(0, 900));
        expectRefusedSoon({"info", path(name)}, "isoslider-cli: ");
    }
    expectRefusedSoon({"info", path(std::string(4096, 'a') + ".mha")}, "isoslider-cli: ", 4);
    const ProcessResult dashed = run({"info", "--", "-dash.mha", "--json"});
    EXPECT_NE(dashed.exitCode, 0); // of the cut file: it was found
}

} // namespace
} // namespace isoslider::test
