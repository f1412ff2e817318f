// What the system allows a program: files open at once, and bytes of a file (FORMAT.md, "Limits").

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "tests/cli/cli_fixture.h"
#include "tests/support/sanitizers.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {

using ::testing::HasSubstr;
using Words = std::vector<std::string>;

class CliLimits : public CliTest {
protected:
    ProcessResult runWithin(const std::string& limit, const Words& words) const {
        Words all{limit, test::builtFile("isoslider-cli")};
        all.insert(all.end(), words.begin(), words.end());
        return runProcess("/usr/bin/prlimit", all, {.workingFolder = folder_.path()});
    }
    void SetUp() override {
        if (!std::filesystem::exists("/usr/bin/prlimit"))
            GTEST_SKIP() << "prlimit is not installed";
    }
    static void expectOneLine(const ProcessResult& result, const std::string& saying) {
        EXPECT_EQ(result.exitCode, 4) << result.standardError;
        EXPECT_EQ(result.standardOutput, "");
        EXPECT_THAT(result.standardError, HasSubstr(saying));
        EXPECT_EQ(std::count(result.standardError.begin(), result.standardError.end(), '\n'), 1);
    }
};

TEST_F(CliLimits, NeedsFewOpenFiles) {
    if (kHasSanitizers)
        GTEST_SKIP() << "the sanitizer opens files itself";
    constexpr int kStreams = 3;
    const auto volume = sphereVolume(), index = sphereIndex();
    for (const auto& [words, most] : {std::pair<Words, int>{{"extract", index, "--isovalue", "5", "-o", "out.ply"}, 2},
                                      {{"build", volume, "-o", "out.isx", "--index", "edges"}, 6},
                                      {{"build", volume, "-o", "out.isx"}, 6}}) {
        SCOPED_TRACE(fmt::format("{}", fmt::join(words, " ")));
        const auto before = folder_.names();
        int files = 1;
        for (; files < most; ++files) {
            const auto result = runWithin(fmt::format("--nofile={}", kStreams + files), words);
            if (result.exitCode == 0)
                break;
            expectOneLine(result, "Too many open files");
            EXPECT_EQ(folder_.names(), before);
        }
        EXPECT_GT(files, 1) << "the limit does not hold";
        EXPECT_EQ(runWithin(fmt::format("--nofile={}", kStreams + most), words).exitCode, 0);
        std::filesystem::remove(folder_ / "out.isx");
        std::filesystem::remove(folder_ / "out.ply");
    }
}

TEST_F(CliLimits, EndsWhereFilesEnd) {
    const auto volume = sphereVolume();
    for (const Words& words : {Words{"build", volume, "--no-topology", "-o", "out.isx"},
                               {"extract", volume, "--isovalue", "5", "-o", "out.ply"}}) {
        const auto out = folder_ / words.back();
        ASSERT_EQ(run(words).exitCode, 0);
        const auto bytes = std::filesystem::file_size(out);
        const auto before = folder_.names();
        EXPECT_EQ(runWithin(fmt::format("--fsize={}", bytes), words).exitCode, 0);
        const auto whole = readText(out);
        expectOneLine(runWithin(fmt::format("--fsize={}", bytes - 1), words), "File too large");
        EXPECT_EQ(folder_.names(), before);
        EXPECT_TRUE(readText(out) == whole) << "the earlier file stays";
    }
}

} // namespace isoslider::test
