// A reader of the index format in another language, written from FORMAT.md alone, against the program.

#include <fmt/format.h>

#include "tests/cli/cli_fixture.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {
namespace {

class SecondReader : public CliTest {
protected:
    void SetUp() override {
        const auto python =
            runProcess("/usr/bin/env", {"python3", "-c", "import sys; sys.exit(sys.version_info < (3, 6))"});
        if (python.exitCode != 0 || runProcess("/usr/bin/env", {"zstd", "--version"}).exitCode != 0)
            GTEST_SKIP() << "needs python3 and the zstd program";
    }
    OrderedJson read(const std::string& index, std::vector<std::string> words) const {
        words.insert(words.begin(),
                     {"python3", std::string(test::sourceFolder()) + "/tests/format/read_index.py", index});
        ProcessOptions options;
        options.timeout = std::chrono::minutes(2);
        const auto result = runProcess("/usr/bin/env", words, options);
        EXPECT_EQ(result.exitCode, 0) << result.standardError;
        return OrderedJson::parse(result.standardOutput, nullptr, false);
    }
    void expectTheSame(const std::string& index, const std::string& volume, const std::vector<std::string>& raw,
                       const std::vector<std::string>& isovalues) const {
        const auto facts = read(index, {"facts"});
        const auto stats = runJson({"stats", index});
        for (const char* key : {"kind", "dims", "scalar_type", "distinct_values", "index_bytes", "hidden_corners"})
            EXPECT_EQ(facts[key], stats[key]) << key;
        ASSERT_EQ(facts["levels"].size(), stats["levels"].size());
        for (std::size_t level = 0; level < facts["levels"].size(); ++level)
            EXPECT_EQ(facts["levels"][level]["edges"], facts["levels"][level]["stated_edges"]) << level;
        std::vector<std::string> words{"active"};
        words.insert(words.end(), isovalues.begin(), isovalues.end());
        const auto active = read(index, words);
        for (std::size_t i = 0; i < isovalues.size(); ++i) {
            std::vector<std::string> extract{"extract", volume, "--isovalue", isovalues[i], "--no-check"};
            extract.insert(extract.end(), raw.begin(), raw.end());
            EXPECT_EQ(active[i], runJson(extract)["active_edges"]) << isovalues[i];
        }
    }
};

TEST_F(SecondReader, FindsTheEdgesOfFloats) {
    const std::vector<std::string> isovalues{"5", "2.5", "-1", "9.75"};
    const std::string volume = sphereVolume();
    expectTheSame(edgesIndex(), volume, {}, isovalues);
    expectTheSame(sphereIndex(), volume, {}, isovalues);
}

TEST_F(SecondReader, FindsTheEdgesOfBytesAndIntegers) {
    for (const char* type : {"u8", "i8", "i16", "u16", "i32"}) {
        const std::size_t width = std::string_view(type).substr(1) == "8" ? 1 : std::string_view(type) == "i32" ? 4 : 2;
        std::string samples(static_cast<std::size_t>(19 * 17 * 18) * width, '\0');
        unsigned state = 5;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            state = state * 1664525u + 1013904223u;
            // Smooth in x, noise in the lowest byte, small numbers.
            samples[i] = static_cast<char>(i % width == 0 ? (i / width % 19) * 9 + (state >> 28) : 0);
        }
        const std::string volume = folder_.write(std::string(type) + ".raw", samples).string();
        const std::vector<std::string> raw{"--raw-dims", "19,17,18", "--raw-type", type};
        for (const char* kind : {"edges", "metacells"}) {
            const std::string index = path(fmt::format("{}_{}.isx", type, kind));
            std::vector<std::string> build{"build", volume, "-o", index, "--index", kind};
            build.insert(build.end(), raw.begin(), raw.end());
            ASSERT_EQ(run(build).exitCode, 0);
            expectTheSame(index, volume, raw, {"17", "60.5", "100"});
        }
    }
}

TEST_F(SecondReader, RefusesWhatIsNoIndex) {
    const auto result =
        runProcess("/usr/bin/env", {"python3", std::string(test::sourceFolder()) + "/tests/format/read_index.py",
                                    sphereVolume(), "facts"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(result.standardError, "read_index.py: not an index\n");
}

} // namespace
} // namespace isoslider::test
