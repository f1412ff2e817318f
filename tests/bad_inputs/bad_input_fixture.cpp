#include "tests/bad_inputs/bad_input_fixture.h"
#include "core/base/machine.h"
#include "tests/support/sanitizers.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace isoslider::test {
namespace {

#if ISO_HAS_SANITIZER
constexpr int kSlowness = 6; // of sanitized code, and its shadow memory
#else
constexpr int kSlowness = 1;
#endif

} // namespace

std::vector<std::string> joined(std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

void BadInputTest::expectSmall(const ProcessResult& result) const {
    static const std::uint64_t usual = [this] {
        const std::string volume = sphereVolume("usual.mha");
        const std::uint64_t peak = run({"info", volume}).peakRssBytes;
        std::filesystem::remove(volume);
        return peak;
    }();
    EXPECT_LE(result.processorTime, std::chrono::seconds(1) * kSlowness);
    // A forked child begins with what this program holds, and its largest size remembers that.
    const std::uint64_t allowed = usual + (std::uint64_t{64} << 20) * kSlowness;
    EXPECT_LE(result.peakRssBytes, std::max(allowed, isoslider::peakRssBytes()));
}

void BadInputTest::expectRefusedSoon(const std::vector<std::string>& arguments, std::string_view saying,
                                     int exitCode) const {
    SCOPED_TRACE(fmt::format("isoslider-cli {}", fmt::join(arguments, " ")));
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exitCode, exitCode) << result.standardError;
    EXPECT_EQ(result.standardOutput, "");
    EXPECT_EQ(std::count(result.standardError.begin(), result.standardError.end(), '\n'), 1) << result.standardError;
    EXPECT_THAT(result.standardError, ::testing::HasSubstr(std::string(saying)));
    EXPECT_THAT(result.standardError, ::testing::Not(::testing::HasSubstr("crashes its reader")));
    expectSmall(result);
}

void BadInputTest::expectFileRefused(const std::string& name, const std::string& bytes, std::string_view saying) const {
    folder_.write(name, bytes);
    expectRefusedSoon({"info", path(name)}, saying);
}

OrderedJson BadInputTest::expectAcceptedSoon(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    SCOPED_TRACE(fmt::format("isoslider-cli {}", fmt::join(arguments, " ")));
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.standardError;
    expectSmall(result);
    auto json = OrderedJson::parse(result.standardOutput, nullptr, false);
    EXPECT_TRUE(json.is_object()) << result.standardOutput;
    return json;
}

std::vector<std::string> BadInputTest::raw(const std::string& name, const std::string& bytes, const std::string& dims,
                                           const std::string& type) const {
    folder_.write(name, bytes);
    return {path(name), "--raw-dims", dims, "--raw-type", type};
}

} // namespace isoslider::test
