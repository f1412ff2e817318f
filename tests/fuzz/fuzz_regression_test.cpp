#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fuzz/fuzz_targets.h"
#include "tests/support/test_paths.h"

// Every target over its seeds and over what fuzzing has found once, with any compiler: a promise that is broken aborts.

namespace isoslider::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> filesIn(const char* kind, std::string_view target) {
    std::vector<fs::path> files;
    std::error_code none;
    for (const auto& entry :
         fs::directory_iterator(fs::path(test::sourceFolder()) / "tests/fuzz" / kind / target, none))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

class FuzzTargets : public ::testing::TestWithParam<NamedTarget> {
protected:
    static void runOver(const std::vector<fs::path>& files) {
        for (const fs::path& path : files) {
            std::ifstream file(path, std::ios::binary);
            const std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
            SCOPED_TRACE(path.string());
            GetParam().run(std::as_bytes(std::span(bytes)));
        }
    }
};

TEST_P(FuzzTargets, KeepPromisesOnNothing) { GetParam().run({}); }

TEST_P(FuzzTargets, KeepPromisesOnSeeds) {
    const auto files = filesIn("seeds", GetParam().name);
    EXPECT_FALSE(files.empty());
    runOver(files);
}

TEST_P(FuzzTargets, KeepPromisesOnEarlierFindings) { runOver(filesIn("regressions", GetParam().name)); }

// Half a file is what an interrupted copy leaves.
TEST_P(FuzzTargets, KeepPromisesOnSeedsCutShort) {
    for (const fs::path& path : filesIn("seeds", GetParam().name)) {
        std::ifstream file(path, std::ios::binary);
        std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
        for (int eighths = 7; eighths > 0; --eighths)
            GetParam().run(std::as_bytes(std::span(bytes)).first(bytes.size() * static_cast<std::size_t>(eighths) / 8));
    }
}

INSTANTIATE_TEST_SUITE_P(Readers, FuzzTargets, ::testing::ValuesIn(kFuzzTargets),
                         [](const auto& target) { return std::string(target.param.name); });

} // namespace
} // namespace isoslider::fuzz
