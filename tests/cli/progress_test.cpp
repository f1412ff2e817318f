// The progress bar, and commands on a terminal, which is where it is drawn.

#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <ctime>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "app/cli/progress_bar.h"
#include "tests/cli/cli_fixture.h"
#include "tests/support/sanitizers.h"
#include "tests/support/test_paths.h"

namespace isoslider::cli {
namespace {

TEST(ProgressBar, RoundsWhatIsLeftUp) {
    EXPECT_EQ(durationText(0.2), "5 s");
    EXPECT_EQ(durationText(41.0), "45 s");
    EXPECT_EQ(durationText(94.0), "95 s");
    EXPECT_EQ(durationText(100.0), "2 min");
    EXPECT_EQ(durationText(3500.0), "59 min");
    EXPECT_EQ(durationText(3660.0), "1 h 10 min");
    EXPECT_EQ(durationText(7200.0), "2 h 0 min");
    EXPECT_EQ(durationText(100000.0), "27 h 50 min");
}

class CliTerminal : public test::CliTest {
protected:
    struct Ended {
        int exitCode = -1;
        std::string shown; ///< all that the terminal was sent
        double seconds = 0.0; ///< of processor time, from `typed` to the end: a busy machine changes it little
    };
    /// Runs the program on a separate terminal. Once the bar has been drawn, `typed` is typed there.
    Ended runOnTerminal(std::vector<std::string> arguments, const std::string& typed = {}) const {
        arguments.insert(arguments.begin(), test::builtFile("isoslider-cli"));
        std::vector<char*> words;
        for (std::string& argument : arguments)
            words.push_back(argument.data());
        words.push_back(nullptr);
        int terminal = -1;
        const pid_t process = ::forkpty(&terminal, nullptr, nullptr, nullptr);
        if (process == 0) {
            ::execv(words.front(), words.data());
            ::_exit(127);
        }
        Ended ended;
        bool hasTyped = false;
        double usedBefore = 0.0;
        std::array<char, 4096> buffer;
        for (ssize_t got = 0; (got = ::read(terminal, buffer.data(), buffer.size())) > 0;) { // an error at its end
            ended.shown.append(buffer.data(), static_cast<std::size_t>(got));
            if (!hasTyped && !typed.empty() && ended.shown.find('%') != std::string::npos) {
                clockid_t clock{};
                timespec used{};
                if (::clock_getcpuclockid(process, &clock) == 0 && ::clock_gettime(clock, &used) == 0)
                    usedBefore = static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
                hasTyped = ::write(terminal, typed.data(), typed.size()) == static_cast<ssize_t>(typed.size());
            }
        }
        int status = 0;
        rusage use{};
        ::wait4(process, &status, 0, &use);
        ::close(terminal);
        for (const timeval& part : {use.ru_utime, use.ru_stime})
            ended.seconds += static_cast<double>(part.tv_sec) + 1e-6 * static_cast<double>(part.tv_usec);
        ended.seconds -= usedBefore;
        ended.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        return ended;
    }
    std::vector<std::string> building(const char* kind, std::int64_t side) const {
        return {"build", noiseVolume(side), "-o", path("a.isx"), "--index", kind};
    }
    static constexpr std::int64_t kBigSide = test::kHasSanitizers ? 64 : 128; ///< some seconds of work
};

TEST_F(CliTerminal, ShowsABarThatIsWipedAtTheEnd) {
    const auto ended = runOnTerminal(building("metacells", 64));
    EXPECT_EQ(ended.exitCode, 0) << ended.shown;
    const std::size_t bar = ended.shown.find("\r\x1b[K["), last = ended.shown.rfind("\r\x1b[K");
    ASSERT_NE(bar, std::string::npos) << ended.shown;
    EXPECT_NE(ended.shown.find(" %  ", bar), std::string::npos);
    EXPECT_EQ(ended.shown.find(" %  ", last), std::string::npos) << "the report follows on a clean line";
    EXPECT_GT(ended.shown.size(), last + 20);
}

TEST_F(CliTerminal, ShowsNoneWhereItIsNotWanted) {
    for (const char* option : {"--quiet", "--json"}) {
        auto words = building("metacells", 48);
        words.emplace_back(option);
        const auto ended = runOnTerminal(words);
        EXPECT_EQ(ended.exitCode, 0);
        EXPECT_EQ(ended.shown.find('\x1b'), std::string::npos) << option;
    }
    EXPECT_EQ(run(building("metacells", 48)).standardError, "") << "standard error is no terminal";
}

// Control-C, as a terminal sends it.
TEST_F(CliTerminal, EndsABuildWithinASecond) {
    for (const char* kind : {"edges", "metacells"})
        for (const bool resumes : {false, true}) {
            auto words = building(kind, kBigSide);
            if (resumes)
                words.emplace_back("--resume");
            const auto ended = runOnTerminal(words, "\x03");
            SCOPED_TRACE(kind);
            EXPECT_EQ(ended.exitCode, 130) << ended.shown;
            EXPECT_LT(ended.seconds, (test::kHasSanitizers ? 10.0 : 1.0) * std::thread::hardware_concurrency());
            EXPECT_NE(ended.shown.find("interrupted"), std::string::npos);
            const std::vector<std::string> nothing{"noise.mha"};
            if (!resumes) {
                EXPECT_EQ(folder_.names(), nothing);
            }
            for (const char* left : {"a.isx.partial", "a.isx.resume", "a.isx.spill"})
                std::filesystem::remove(folder_ / left);
        }
}

} // namespace
} // namespace isoslider::cli
