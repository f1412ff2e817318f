#pragma once

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <QImage>

#include <gtest/gtest.h>

#include "tests/gui/window_fixture.h"
#include "tests/support/process_runner.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {

/// Runs the real program, as a shell runs it, in a home folder of its own.
class ProgramTest : public ::testing::Test {
protected:
    using Environment = std::vector<std::pair<std::string, std::string>>;

    ProcessResult run(const std::vector<std::string>& arguments, const Environment& environment = {}) {
        ProcessOptions options;
        options.timeout = std::chrono::seconds(150);
        const std::string home = folder_.path().string();
        for (const char* name : {"HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_DATA_HOME", "XDG_RUNTIME_DIR"})
            options.environment.emplace_back(name, home);
        options.environment.insert(options.environment.end(), environment.begin(), environment.end());
        return runProcess(test::builtFile("isoslider"), arguments, options);
    }
    /// One line of ours; the platform's plugin may state something about itself.
    static void expectOneLine(const std::string& text) {
        std::istringstream lines(text);
        int count = 0;
        for (std::string line; std::getline(lines, line);)
            count += line.rfind("This plugin does not support", 0) == 0 ? 0 : 1;
        EXPECT_EQ(count, 1) << text;
    }
    static QImage pictureAt(const std::filesystem::path& path) { return QImage(QString::fromStdString(path.string())); }

    TemporaryFolder folder_;
};

} // namespace isoslider::test
