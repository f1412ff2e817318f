#include "tests/cli/cli_fixture.h"
#include "tests/support/test_paths.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

#include <fmt/format.h>

namespace isoslider::test {
namespace {

constexpr std::int64_t kSphereSide = 16;

std::string sphereSamples() {
    return floatSamples(kSphereSide, [](int x, int y, int z) {
        const float middle = 0.5f * static_cast<float>(kSphereSide - 1);
        const float dx = static_cast<float>(x) - middle;
        const float dy = static_cast<float>(y) - middle;
        const float dz = static_cast<float>(z) - middle;
        return 10.0f - std::sqrt(dx * dx + dy * dy + dz * dz);
    });
}

} // namespace

std::string floatSamples(std::int64_t side, const std::function<float(int x, int y, int z)>& valueAt) {
    std::string bytes;
    const int size = static_cast<int>(side);
    for (int z = 0; z < size; ++z)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const float value = valueAt(x, y, z);
                char sample[sizeof value];
                std::memcpy(sample, &value, sizeof value);
                bytes.append(sample, sizeof sample);
            }
    return bytes;
}

std::string metaImage(std::int64_t side, std::string_view elementType, std::string_view samples) {
    return fmt::format("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                       "CompressedData = False\nElementSpacing = 1 1 1\nOffset = 0 0 0\n"
                       "DimSize = {0} {0} {0}\nElementType = {1}\nElementDataFile = LOCAL\n",
                       side, elementType)
        .append(samples);
}

std::vector<std::string> keysOf(const OrderedJson& object) {
    std::vector<std::string> keys;
    for (const auto& item : object.items())
        keys.push_back(item.key());
    return keys;
}

ProcessResult CliTest::run(const std::vector<std::string>& arguments, const ProcessOptions& options) const {
    ProcessOptions here = options;
    if (here.workingFolder.empty())
        here.workingFolder = folder_.path();
    return runProcess(test::builtFile("isoslider-cli"), arguments, here);
}

OrderedJson CliTest::runJson(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    const auto result = run(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.standardError;
    EXPECT_EQ(result.standardError, "");
    EXPECT_EQ(std::count(result.standardOutput.begin(), result.standardOutput.end(), '\n'), 1);
    auto json = OrderedJson::parse(result.standardOutput, nullptr, false);
    EXPECT_TRUE(json.is_object()) << result.standardOutput;
    return json;
}

void CliTest::expectRefusal(const std::vector<std::string>& arguments, int exitCode, std::string_view saying) const {
    const auto result = run(arguments);
    SCOPED_TRACE(fmt::format("isoslider-cli {}", fmt::join(arguments, " ")));
    EXPECT_EQ(result.exitCode, exitCode) << result.standardError;
    EXPECT_EQ(result.signal, 0);
    EXPECT_EQ(result.standardOutput, "");
    EXPECT_THAT(result.standardError, ::testing::StartsWith("isoslider-cli: "));
    EXPECT_THAT(result.standardError, ::testing::HasSubstr(std::string(saying)));
    const auto lines = std::count(result.standardError.begin(), result.standardError.end(), '\n');
    EXPECT_EQ(lines, 1) << result.standardError;
}

std::string CliTest::sphereVolume(const std::string& name) const {
    return folder_.write(name, metaImage(kSphereSide, "MET_FLOAT", sphereSamples())).string();
}

std::string CliTest::rawSphere(const std::string& name) const { return folder_.write(name, sphereSamples()).string(); }

std::string CliTest::sphereIndex(const std::string& name) const {
    const auto result = run({"build", sphereVolume(), "-o", path(name)});
    EXPECT_EQ(result.exitCode, 0) << result.standardError;
    return path(name);
}

std::string CliTest::edgesIndex(const std::string& name, const std::vector<std::string>& further) const {
    std::vector<std::string> arguments{"build", sphereVolume(), "-o", path(name), "--index", "edges"};
    arguments.insert(arguments.end(), further.begin(), further.end());
    const auto result = run(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.standardError;
    return path(name);
}

std::string CliTest::noiseVolume(std::int64_t side, const std::string& name) const {
    std::vector<float> values(static_cast<std::size_t>(side * side * side));
    std::iota(values.begin(), values.end(), 0.0f);
    std::mt19937 random(20031022);
    std::shuffle(values.begin(), values.end(), random);
    const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    return folder_.write(name, metaImage(side, "MET_FLOAT", bytes)).string();
}

} // namespace isoslider::test
