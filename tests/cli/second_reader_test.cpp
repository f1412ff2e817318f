// A reader of the index format in another language, written from FORMAT.md alone, against the program.

#include <array>
#include <bit>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/grid/scalar_key.h"
#include "core/index/format/block_codec.h"
#include "core/index/index_reader.h"
#include "core/index/sample_store.h"
#include "tests/cli/cli_fixture.h"
#include "tests/support/result_matchers.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {
namespace {

template <class Key>
std::string recordsOf(const index::IndexReader& reader, std::size_t level) {
    std::string text;
    std::vector<std::byte> bytes;
    index::DecodedPage<Key> decoded;
    const auto* const page = &decoded;
    for (const index::PageEntry& place : reader.meta().levels[level].pages) {
        EXPECT_THAT(reader.readPage(place, bytes), IsOk());
        EXPECT_THAT(index::decodePage<Key>(bytes, reader.grid(), decoded, "page"), IsOk());
        std::size_t entry = 0;
        for (std::size_t i = 0; i < page->pointCount(); ++i) {
            text += fmt::format("{} {} {}", page->form(i), page->ids[i], page->keys[i]);
            if (page->hasNormals())
                text += fmt::format(" {}", page->normals[i]);
            for (unsigned rest = page->masks[i]; rest != 0; rest &= rest - 1) {
                const int e = std::countr_zero(rest);
                text += fmt::format(" {} {}", e, page->hasFarKeys(i) ? page->farKeys[entry] : page->rising[i] >> e & 1);
                if (page->hasNormals())
                    text += fmt::format(" {}", page->farNormals[entry]);
                entry += page->hasFarKeys(i) ? 1 : 0;
            }
            text += '\n';
        }
    }
    return text;
}

std::string rowsOf(std::span<const std::byte> bytes, std::size_t rowBytes) {
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        text += fmt::format("{:02x}", std::to_integer<unsigned>(bytes[i]));
        if ((i + 1) % rowBytes == 0)
            text += '\n';
    }
    return text;
}

class SecondReader : public CliTest {
protected:
    void SetUp() override {
        const auto python =
            runProcess("/usr/bin/env", {"python3", "-c", "import sys; sys.exit(sys.version_info < (3, 6))"});
        if (python.exitCode != 0 || runProcess("/usr/bin/env", {"zstd", "--version"}).exitCode != 0)
            GTEST_SKIP() << "needs python3 and the zstd program";
    }
    OrderedJson read(const std::string& index, std::vector<std::string> words) const {
        return OrderedJson::parse(textOf(index, std::move(words)), nullptr, false);
    }
    std::string textOf(const std::string& index, std::vector<std::string> words) const {
        words.insert(words.begin(),
                     {"python3", std::string(test::sourceFolder()) + "/tests/format/read_index.py", index});
        ProcessOptions options;
        options.timeout = std::chrono::minutes(2);
        const auto result = runProcess("/usr/bin/env", words, options);
        EXPECT_EQ(result.exitCode, 0) << result.standardError;
        return result.standardOutput;
    }
    /// Every record of every level and every sample, as the program reads them.
    void expectAllTheSame(const std::string& index) const {
        SCOPED_TRACE(index);
        const auto opened = index::IndexReader::open(index);
        ASSERT_THAT(opened, IsOk());
        const index::IndexReader& reader = *opened.value();
        visitScalarType(reader.info().type, [&](auto sample) {
            using Key = KeyOf<decltype(sample)>;
            for (std::size_t level = 0; level < reader.meta().levels.size(); ++level)
                EXPECT_TRUE(textOf(index, {"records", std::to_string(level)}) == recordsOf<Key>(reader, level))
                    << "level " << level;
        });
        const auto grid = index::readSamples(reader);
        ASSERT_THAT(grid, IsOk());
        const auto rowBytes =
            static_cast<std::size_t>(grid.value()->dims()[0]) * scalarTypeSizeBytes(grid.value()->type());
        EXPECT_TRUE(textOf(index, {"samples"}) == rowsOf(grid.value()->bytes(), rowBytes));
    }
    void expectTheSame(const std::string& index, const std::string& volume, const std::vector<std::string>& raw,
                       const std::vector<std::string>& isovalues) const {
        const auto facts = read(index, {"facts"});
        const auto stats = runJson({"stats", index});
        for (const char* key : {"kind", "dims", "scalar_type", "distinct_values", "index_bytes"})
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
    for (const std::string& index : {edgesIndex(), sphereIndex()}) {
        expectTheSame(index, volume, {}, isovalues);
        expectAllTheSame(index);
    }
    expectAllTheSame(edgesIndex("merged.isx", {"--lod-error", "0.5c"}));
}

TEST_F(SecondReader, FindsTheEdgesOfBytesAndIntegers) {
    // Several bricks along each axis; several chunks along one: reading takes its time.
    const std::vector<std::pair<const char*, std::array<std::size_t, 3>>> grids{
        {"u8", {18, 10, 9}}, {"i8", {9, 18, 10}}, {"i16", {10, 9, 18}}, {"u16", {17, 9, 9}}, {"i32", {9, 9, 17}}};
    for (const auto& [type, dims] : grids) {
        const std::size_t width = std::string_view(type).substr(1) == "8" ? 1 : std::string_view(type) == "i32" ? 4 : 2;
        std::string samples(dims[0] * dims[1] * dims[2] * width, '\0');
        unsigned state = 5;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            state = state * 1664525u + 1013904223u;
            // Smooth in x, noise in the lowest byte, small numbers.
            samples[i] = static_cast<char>(i % width == 0 ? (i / width % dims[0]) * 9 + (state >> 28) : 0);
        }
        const std::string volume = folder_.write(std::string(type) + ".raw", samples).string();
        const std::vector<std::string> raw{"--raw-dims", fmt::format("{},{},{}", dims[0], dims[1], dims[2]),
                                           "--raw-type", type};
        for (const char* kind : {"edges", "metacells"}) {
            const std::string index = path(fmt::format("{}_{}.isx", type, kind));
            std::vector<std::string> build{"build", volume, "-o", index, "--index", kind};
            build.insert(build.end(), raw.begin(), raw.end());
            ASSERT_EQ(run(build).exitCode, 0);
            expectTheSame(index, volume, raw, {"17", "60.5", "100"});
            expectAllTheSame(index);
        }
    }
}

TEST_F(SecondReader, ReadsIndexesOfEachVersion) {
    for (const char* name : {"golden_v4_metacells", "golden_v4_1_topology", "golden_v5_metacells",
                             "golden_v5_1_topology", "golden_v6", "golden_v6_metacells", "golden_v6_merged",
                             "golden_v6_2", "golden_v7", "golden_v7_metacells", "golden_v7_merged", "golden_v7_2"})
        expectAllTheSame(fmt::format("{}/tests/data/{}.isx", test::sourceFolder(), name));
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
