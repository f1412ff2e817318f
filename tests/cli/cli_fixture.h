#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/process_runner.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::test {

using OrderedJson = nlohmann::ordered_json;

/// Runs the real isoslider-cli in a separate folder.
class CliTest : public ::testing::Test {
protected:
    ProcessResult run(const std::vector<std::string>& arguments, const ProcessOptions& options = {}) const;
    /// Runs with --json, expects exit 0 and one object on standard output.
    OrderedJson runJson(std::vector<std::string> arguments) const;
    /// Expects the exit code, an empty standard output and one line that begins with the program's name.
    void expectRefusal(const std::vector<std::string>& arguments, int exitCode, std::string_view saying = "") const;

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    /// 16^3 samples of type f32: 10 - distance to the middle. At 5 a sphere of radius 5.
    std::string sphereVolume(const std::string& name = "sphere.mha") const;
    /// The same samples without a header, and the options that describe them.
    std::string rawSphere(const std::string& name = "sphere.raw") const;
    std::vector<std::string> rawOptions() const { return {"--raw-dims", "16,16,16", "--raw-type", "f32"}; }
    /// Builds an index of sphereVolume() with the program.
    std::string sphereIndex(const std::string& name = "sphere.isx") const;
    /// The same of edges; `further`: options of the build.
    std::string edgesIndex(const std::string& name = "edges.isx", const std::vector<std::string>& further = {}) const;
    /// side^3 samples of type f32, all different, at random: much work in little room.
    std::string noiseVolume(std::int64_t side, const std::string& name = "noise.mha") const;

    TemporaryFolder folder_;
};

std::vector<std::string> keysOf(const OrderedJson& object);

/// f32 samples of a cube of `side` grid points, x fastest.
std::string floatSamples(std::int64_t side, const std::function<float(int x, int y, int z)>& valueAt);
std::string metaImage(std::int64_t side, std::string_view elementType, std::string_view samples);

} // namespace isoslider::test
