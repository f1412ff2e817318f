#include "core/base/folders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider {
namespace {

namespace fs = std::filesystem;

class Folders : public testing::Test {
protected:
    void SetUp() override {
        ASSERT_THAT(makeFolders(folder / "b" / "deep"), test::IsOk());
        folder.write("c", "3");
        folder.write("b/x", "12");
        folder.write("b/deep/y", "1");
        fs::create_symlink(folder / "c", folder / "a");
        fs::create_symlink(folder / "nowhere", folder / "dangling");
    }
    std::vector<std::string> list(const FolderSearch& search) {
        const auto files = listFiles(folder.path(), search);
        EXPECT_THAT(files, test::IsOk());
        std::vector<std::string> names;
        for (const fs::path& file : files.isOk() ? files.value() : std::vector<fs::path>())
            names.push_back(file.lexically_relative(folder.path()).string());
        return names;
    }
    test::TemporaryFolder folder;
};

TEST_F(Folders, ListFilesInOrderToTheDepthAskedFor) {
    using testing::ElementsAre;
    EXPECT_THAT(list({}), ElementsAre("a", "c"));
    EXPECT_THAT(list({1}), ElementsAre("a", "b/x", "c"));
    EXPECT_THAT(list({9}), ElementsAre("a", "b/deep/y", "b/x", "c"));
    EXPECT_EQ(list({9, 2}).size(), 2u);
    EXPECT_THAT(listFiles(folder / "nowhere"), test::HasError(ErrorCode::NotFound));
}

TEST_F(Folders, AnswerQuestions) {
    EXPECT_TRUE(isPresent(folder / "c") && isPresent(folder / "b") && isPresent(folder / "a"));
    EXPECT_FALSE(isPresent(folder / "dangling") || isPresent(folder / "c" / "x"));
    EXPECT_TRUE(isFolder(folder / "b"));
    EXPECT_FALSE(isFolder(folder / "c"));
    EXPECT_TRUE(isPlainFile(folder / "c"));
    EXPECT_FALSE(isPlainFile(folder / "a") || isPlainFile(folder / "b"));
    EXPECT_TRUE(isSameFile(folder / "a", folder / "b" / ".." / "c"));
    EXPECT_FALSE(isSameFile(folder / "a", folder / "b" / "x") || isSameFile(folder / "none", folder / "none"));
    EXPECT_GT(modifiedAt(folder / "c"), modifiedAt(folder / "none"));
    EXPECT_TRUE(isPresent(programFolder()));
    const auto resolved = canonicalPath(folder / "a");
    ASSERT_THAT(resolved, test::IsOk());
    EXPECT_EQ(resolved.value().filename(), "c");
}

TEST_F(Folders, AreMadeOrRefusedInALine) {
    EXPECT_THAT(makeFolders(folder / "b"), test::IsOk());
    const Status below = makeFolders(folder / "c" / "d");
    ASSERT_FALSE(below.isOk());
    EXPECT_THAT(below.error().line(), testing::HasSubstr("cannot make the folder"));
}

} // namespace
} // namespace isoslider
