// Many random grids against the oracle, many moves against fresh extractions; for nights, not for each
// change.
//
//   topology_probe --grids 100000 --moves 1000000 [--seed 1] [--seconds 0]
//
// Each grid has a separate seed, printed with what is wrong; `--grids 1 --moves 0 --seed S` shows it again,
// `--moves 100` for a walk. Exit code 1 when anything was wrong.

#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/property/topology_law.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::test {
namespace {

constexpr std::int64_t kMovesPerWalk = 100;

struct ProbeOptions {
    std::int64_t grids = 1000, moves = 1000, seconds = 0; // 0: no limit
    std::uint64_t seed = 1;
};

struct Tally {
    std::int64_t grids = 0, surfaces = 0, moves = 0, patched = 0, tunnels = 0, faults = 0;
};

TopologyGrid seededGrid(Random& random, std::int64_t longest) {
    const auto kind = static_cast<GridKind>(pickInt(random, 0, kGridKinds - 1));
    const std::int64_t shortest = pickInt(random, 0, 9) == 0 ? 2 : 5;
    return randomTopologyGrid(kind, shortest, longest, random);
}

void report(const char* what, std::uint64_t seed, const TopologyGrid& grid, double isovalue, const std::string& fault,
            Tally& tally) {
    ++tally.faults;
    std::printf("%s seed %" PRIu64 ", %s, isovalue %.17g: %s\n", what, seed, grid.description.c_str(), isovalue,
                fault.c_str());
    std::fflush(stdout);
}

// Zero, where most kinds are at their worst, and three more.
void probeGrid(std::uint64_t seed, Tally& tally) {
    Random random(seed);
    const TopologyGrid grid = seededGrid(random, 9);
    ++tally.grids;
    for (int i = 0; i < 4; ++i) {
        const double isovalue = i == 0 ? 0.0 : topologyIsovalue(grid, random);
        ++tally.surfaces;
        if (const std::string fault = freshFault(grid, isovalue); !fault.empty())
            return report("grid", seed, grid, isovalue, fault, tally);
    }
    tally.tunnels += sweepGrid(grid.scalars, grid.dims, 0.0).tunnels;
}

void probeWalk(std::uint64_t seed, const std::filesystem::path& path, Tally& tally) {
    Random random(seed);
    const TopologyGrid grid = seededGrid(random, pickInt(random, 0, 3) == 0 ? 20 : 10); // up to three bricks along
    TopologyWalker walker(grid, path, static_cast<int>(pickInt(random, 1, 6)), 0.05 + pickUnit(random));
    if (!walker.fault().empty())
        return report("walk", seed, grid, 0.0, walker.fault(), tally);
    for (std::int64_t i = 0; i < kMovesPerWalk; ++i) {
        const double isovalue = walker.nextIsovalue(random);
        ++tally.moves;
        if (const std::string fault = walker.slideFault(isovalue, i % 20 == 0); !fault.empty())
            return report("walk", seed, grid, isovalue, fault + " (move " + std::to_string(i) + ")", tally);
    }
    tally.patched += walker.patchedMoves();
}

bool parse(int argc, char** argv, ProbeOptions& options) {
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::int64_t number = std::strtoll(argv[i + 1], nullptr, 10);
        if (std::strcmp(argv[i], "--grids") == 0)
            options.grids = number;
        else if (std::strcmp(argv[i], "--moves") == 0)
            options.moves = number;
        else if (std::strcmp(argv[i], "--seconds") == 0)
            options.seconds = number;
        else if (std::strcmp(argv[i], "--seed") == 0)
            options.seed = static_cast<std::uint64_t>(number);
        else
            return false;
    }
    return argc % 2 == 1;
}

int run(const ProbeOptions& options) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const auto isTimeUp = [&] {
        return options.seconds > 0 && Clock::now() - start > std::chrono::seconds(options.seconds);
    };
    Tally tally;
    for (std::int64_t i = 0; i < options.grids && !isTimeUp(); ++i)
        probeGrid(options.seed + static_cast<std::uint64_t>(i), tally);
    const TemporaryFolder folder;
    for (std::int64_t i = 0; i * kMovesPerWalk < options.moves && !isTimeUp(); ++i)
        probeWalk(options.seed + static_cast<std::uint64_t>(i), folder / "a.isx", tally);
    std::printf("%" PRId64 " grids, %" PRId64 " surfaces, %" PRId64 " tunnels at zero, ", tally.grids, tally.surfaces,
                tally.tunnels);
    std::printf("%" PRId64 " moves (%" PRId64 " patched): %" PRId64 " faults\n", tally.moves, tally.patched,
                tally.faults);
    return tally.faults == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

} // namespace
} // namespace isoslider::test

int main(int argc, char** argv) {
    isoslider::test::ProbeOptions options;
    if (!isoslider::test::parse(argc, argv, options)) {
        std::fprintf(stderr, "usage: topology_probe [--grids N] [--moves N] [--seed S] [--seconds T]\n");
        return 2;
    }
    return isoslider::test::run(options);
}
