// An hour of use, by hand: see tests/README.md.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "tests/soak/soak.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::test {
namespace {

struct SoakOptions {
    double minutes = 60.0;
    int side = 128;
    std::uint32_t seed = 1;
    std::vector<std::filesystem::path> volumes;
};

bool parse(int argc, char** argv, SoakOptions& options) {
    for (int i = 1; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (!word.starts_with("--")) {
            options.volumes.emplace_back(argv[i]);
            continue;
        }
        if (++i == argc)
            return false;
        if (word == "--minutes")
            options.minutes = std::atof(argv[i]);
        else if (word == "--side")
            options.side = std::atoi(argv[i]);
        else if (word == "--seed")
            options.seed = static_cast<std::uint32_t>(std::atoi(argv[i]));
        else
            return false;
    }
    return options.minutes > 0.0 && options.side >= 8;
}

int run(SoakOptions options) {
    const TemporaryFolder folder;
    if (options.volumes.empty())
        options.volumes = writeSoakVolumes(folder.path(), options.side);
    Soak soak(folder.path(), options.volumes, options.seed);
    const auto begin = std::chrono::steady_clock::now();
    std::optional<SoakRound> first;
    bool hasGrown = false;
    std::printf("seed %u\n%6s %9s %7s %13s %13s %12s %8s\n", options.seed, "round", "seconds", "moves", "resident KiB",
                "in use KiB", "descriptors", "threads");
    while (std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(60.0 * options.minutes)) {
        const auto round = soak.round();
        if (!round.isOk()) {
            std::fprintf(stderr, "session_soak: %s\n", round.error().line().c_str());
            return 1;
        }
        const SoakRound& now = round.value();
        std::printf("%6d %9.2f %7d %13llu %13llu %12d %8d\n", now.number, now.seconds, now.moves,
                    static_cast<unsigned long long>(now.residentBytes / 1024),
                    static_cast<unsigned long long>(now.heapBytes / 1024), now.descriptors, now.threads);
        std::fflush(stdout);
        if (!first)
            first = now;
        if (const std::string growth = growthOf(*first, now); !growth.empty()) {
            std::fprintf(stderr, "session_soak: round %d: %s\n", now.number, growth.c_str());
            hasGrown = true;
        }
    }
    return hasGrown ? 1 : 0;
}

} // namespace
} // namespace isoslider::test

int main(int argc, char** argv) {
    isoslider::test::SoakOptions options;
    if (!isoslider::test::parse(argc, argv, options)) {
        std::fprintf(stderr, "usage: session_soak [--minutes 60] [--side 128] [--seed 1] [VOLUME...]\n");
        return 2;
    }
    return isoslider::test::run(std::move(options));
}
