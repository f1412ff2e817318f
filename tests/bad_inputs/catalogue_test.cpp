// The catalogue of bad inputs has 113 cases; each has a test that bears its number.
#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {
namespace {

constexpr int kCases = 113;

/// Numbers in the names of tests, "TEST_F(RawInputs, B001_...)", and in the labels of their parameters, {"B027...".
std::set<int> casesWithTests() {
    const std::regex name(R"((?:TEST(?:_F|_P)?\(\w+,\s*|\{\s*")((?:B\d{3}_?)+))");
    const std::regex number(R"(B(\d{3}))");
    std::set<int> cases;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::string(test::sourceFolder()) + "/tests")) {
        if (entry.path().extension() != ".cpp")
            continue;
        const std::string text = readText(entry.path());
        for (std::sregex_iterator found(text.begin(), text.end(), name), end; found != end; ++found) {
            const std::string numbers = (*found)[1];
            for (std::sregex_iterator one(numbers.begin(), numbers.end(), number); one != end; ++one)
                cases.insert(std::stoi((*one)[1]));
        }
    }
    return cases;
}

TEST(BadInputCatalogue, EveryCaseHasATest) {
    const auto cases = casesWithTests();
    for (int i = 1; i <= kCases; ++i)
        EXPECT_TRUE(cases.contains(i)) << "B" << i;
}

} // namespace
} // namespace isoslider::test
