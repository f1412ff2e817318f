#include <algorithm>

#include "core/base/byte_codec.h"
#include "tests/cli/cli_fixture.h"

namespace isoslider::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class CliValidate : public CliTest {
protected:
    /// Turns over one byte of an index; by default of its first part.
    std::string damaged(const std::string& index, std::size_t at = 200) const {
        std::string bytes = readText(index);
        bytes[at] = static_cast<char>(~bytes[at]);
        return folder_.write("damaged.isx", bytes).string();
    }
};

TEST_F(CliValidate, FindsSoundIndexesSound) {
    const auto volume = sphereVolume();
    for (const std::string& index : {sphereIndex(), edgesIndex(), edgesIndex("merged.isx", {"--lod-error", "0.25c"})}) {
        for (const std::vector<std::string>& more :
             {std::vector<std::string>{}, {"--full"}, {"--against", volume}, {"--full", "--against", volume}}) {
            std::vector<std::string> words{"validate", index};
            words.insert(words.end(), more.begin(), more.end());
            const auto json = runJson(words);
            EXPECT_EQ(json["sound"], true);
            EXPECT_EQ(json["fault_count"], 0);
            EXPECT_EQ(json["bytes"], runJson({"stats", index})["index_bytes"]) << "without the appendix";
            EXPECT_GT(json["topology_events"], 0);
        }
        const auto text = run({"validate", index});
        EXPECT_EQ(text.exitCode, 0);
        EXPECT_THAT(text.standardOutput, AllOf(HasSubstr("sound"), HasSubstr("checksums only")));
    }
    EXPECT_EQ(runJson({"validate", sphereIndex(), "--against", volume})["compared"], "samples");
    EXPECT_EQ(runJson({"validate", edgesIndex("merged.isx", {"--lod-error", "1%"}), "--against", volume})["compared"],
              "samples");
}

TEST_F(CliValidate, NamesFaultsAndExitsWithOne) {
    const auto result = run({"validate", damaged(sphereIndex())});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.standardOutput, AllOf(HasSubstr("fails its checksum (at byte "), HasSubstr(": damaged, ")));
    EXPECT_THAT(result.standardError, AllOf(HasSubstr("damaged.isx: "), HasSubstr("fails its checksum")));
    EXPECT_EQ(std::count(result.standardError.begin(), result.standardError.end(), '\n'), 1);
    // Normals come first, and what ends before meta are pages.
    const std::string edges = edgesIndex();
    const auto metaOffset = loadLittle<std::uint64_t>(reinterpret_cast<const std::byte*>(readText(edges).data()) + 16);
    for (const auto& [at, place] :
         {std::pair<std::uint64_t, const char*>{200, "box"}, {metaOffset - 20, "isovalues"}}) {
        const auto json = run({"validate", damaged(edges, at), "--json"});
        EXPECT_EQ(json.exitCode, 1);
        const auto object = OrderedJson::parse(json.standardOutput);
        EXPECT_EQ(object["sound"], false);
        EXPECT_EQ(object["fault_count"], 1);
        EXPECT_EQ(object["faults"][0]["problem"], "fails its checksum");
        EXPECT_EQ(keysOf(object["faults"][0]), (std::vector<std::string>{"part", "problem", "offset", place}));
    }
}

// In reports as in errors: a name does not make a separate line.
TEST_F(CliValidate, EscapesControlCharactersInNames) {
    const std::string index = (folder_.path() / "a\nb.isx").string();
    const auto built = run({"build", sphereVolume(), "-o", index, "--no-topology"});
    ASSERT_EQ(built.exitCode, 0) << built.standardError;
    EXPECT_THAT(built.standardOutput, HasSubstr("/a\\x0ab.isx: "));
    EXPECT_THAT(run({"validate", index}).standardOutput, HasSubstr("/a\\x0ab.isx: sound"));
}

TEST_F(CliValidate, FindsFaultsOfStoredTopology) {
    const auto index = sphereIndex();
    const std::size_t indexBytes = runJson({"stats", index})["index_bytes"];
    const std::size_t all = readText(index).size();
    ASSERT_GT(all, indexBytes + 64);
    // A page of events, then the directory.
    for (const std::size_t offset : {indexBytes + 70, all - 5}) {
        const auto result = run({"validate", damaged(index, offset)});
        EXPECT_EQ(result.exitCode, 1);
        EXPECT_THAT(result.standardOutput, ::testing::AnyOf(HasSubstr("topology page fails its checksum"),
                                                            HasSubstr("appendix fails its checksum")));
    }
}

// Which readers leave alone.
TEST_F(CliValidate, FindsBytesBehindAnIndexThatAreNoTopology) {
    const auto index = sphereIndex();
    const std::size_t indexBytes = runJson({"stats", index})["index_bytes"];
    const std::string whole = readText(index);
    std::string headless = whole;
    headless.replace(indexBytes, 64, 64, '\0');
    const std::string without = whole.substr(0, indexBytes);
    for (const auto& [bytes, saying] : {std::pair(whole + std::string(16, 'x'), "bytes that belong to nothing"),
                                        {whole + std::string(5000, 'x'), "bytes that belong to nothing"},
                                        {headless, "lost its header"},
                                        {headless.substr(0, indexBytes + 100), "is not finished"}}) {
        const auto path = folder_.write("b.isx", bytes).string();
        const auto result = run({"validate", path});
        EXPECT_EQ(result.exitCode, 1);
        EXPECT_THAT(result.standardError, HasSubstr(saying));
        EXPECT_THAT(result.standardOutput, HasSubstr("damaged"));
        EXPECT_EQ(run({"slide", path, "--path", "3,5"}).exitCode, 0) << "an interrupted build leaves an index";
        EXPECT_EQ(run({"topology", path}).exitCode, 0);
    }
    EXPECT_EQ(run({"validate", path("b.isx")}).exitCode, 0) << "topology has been added again";
    EXPECT_EQ(run({"validate", folder_.write("c.isx", without).string()}).exitCode, 0);
}

TEST_F(CliValidate, NamesTheDifferenceToAnotherVolume) {
    const auto other = folder_.write("other.mha", metaImage(16, "MET_FLOAT", floatSamples(16, [](int x, int y, int z) {
                                                                return static_cast<float>(x * y - z);
                                                            })));
    const auto result = run({"validate", sphereIndex(), "--against", other.string()});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.standardOutput, HasSubstr("chunk 0 has other samples than the volume"));
    const auto edges = run({"validate", edgesIndex(), "--against", other.string()});
    EXPECT_EQ(edges.exitCode, 1);
    EXPECT_THAT(edges.standardOutput, HasSubstr("value range is not that of the volume"));
    const auto smaller = noiseVolume(12);
    EXPECT_THAT(run({"validate", sphereIndex(), "--against", smaller}).standardOutput,
                HasSubstr("grid has 16 x 16 x 16 points, the volume 12 x 12 x 12"));
}

TEST_F(CliValidate, FindsAnIndexOfAnotherVolumeSound) {
    const auto sphere = readText(sphereVolume());
    const auto with = [&](const std::string& from, const std::string& to, const std::string& name) {
        std::string bytes = sphere;
        bytes.replace(bytes.find(from), from.size(), to);
        return folder_.write(name, bytes).string();
    };
    const auto integers = folder_.write("integers.mha", metaImage(16, "MET_UCHAR", std::string(16 * 16 * 16, 'a')));
    for (const std::string& index : {sphereIndex(), edgesIndex()}) {
        for (const auto& [volume, saying] :
             {std::pair(noiseVolume(12), "grid has 16 x 16 x 16 points, the volume 12 x 12 x 12"),
              {integers.string(), "scalar type is f32, that of the volume u8"},
              {with("Spacing = 1 1 1", "Spacing = 1 1 2.5", "far.mha"), "spacing 1 1 1, not 1 1 2.5"},
              {with("Offset = 0 0 0", "Offset = 0 7 0", "moved.mha"), "origin 0 0 0, not 0 7 0"},
              {noiseVolume(16, "n.mha"), "other"}}) {
            const auto result = run({"validate", index, "--against", volume});
            EXPECT_EQ(result.exitCode, 1);
            EXPECT_THAT(result.standardOutput, HasSubstr(index + ": sound, but not of " + volume));
            EXPECT_THAT(result.standardError, ::testing::AnyOf(HasSubstr(saying), HasSubstr("value range")));
            EXPECT_THAT(result.standardError, HasSubstr(index + ": is sound, but not of " + volume + ": "));
            const auto json =
                OrderedJson::parse(run({"validate", index, "--against", volume, "--json"}).standardOutput);
            EXPECT_EQ(json["sound"], true);
            EXPECT_EQ(json["differences"], json["fault_count"]);
        }
    }
    const auto both = run({"validate", damaged(sphereIndex()), "--against", noiseVolume(12)});
    EXPECT_EQ(both.exitCode, 1);
    EXPECT_THAT(both.standardOutput, AllOf(HasSubstr("damaged.isx: damaged, "), HasSubstr("fails its checksum"),
                                           HasSubstr("the volume 12")));
}

TEST_F(CliValidate, RefusesWithDifferentWords) {
    expectRefusal({"validate", sphereVolume()}, 3, "not an ISOSLIDER index");
    std::string bytes = readText(sphereIndex());
    bytes[12] = 77;
    expectRefusal({"validate", folder_.write("newer.isx", bytes).string()}, 3, "made by a newer version");
    bytes = readText(path("sphere.isx"));
    bytes[40] = static_cast<char>(bytes[40] ^ 1);
    expectRefusal({"validate", folder_.write("header.isx", bytes).string()}, 3, "header fails its checksum");
    expectRefusal({"validate", path("none.isx")}, 4, "none.isx");
    expectRefusal({"validate", path("sphere.isx"), "--against", path("none.mha")}, 4, "none.mha");
    expectRefusal({"validate"}, 2, "required");
}

} // namespace
} // namespace isoslider::test
