#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "tests/unit/ui/main_thread_queue.h"
#include "ui/model/session/session.h"

namespace isoslider::test {

/// What the process holds once a round is over and its volume is closed.
struct SoakRound {
    int number = 0; ///< from 1
    double seconds = 0.0;
    int moves = 0;
    std::uint64_t residentBytes = 0;
    std::uint64_t heapBytes = 0; ///< in use; 0 where the allocator does not report it
    int descriptors = 0;
    int threads = 0;
};

/// What of a later round is more than the first one left; empty if memory is flat and nothing stays open. The first
/// round fills caches and pools that stay.
std::string growthOf(const SoakRound& first, const SoakRound& later);

/// One session, as the window has it, without a window: volumes are opened in turn, slid through, jumped about in,
/// exported and closed, in one process. Indexes are built into a cache below `folder`; each round one of them again.
class Soak {
public:
    Soak(std::filesystem::path folder, std::vector<std::filesystem::path> volumes, std::uint32_t seed);
    ~Soak();

    /// Errors: whatever the session reports; IoError where something never ends, or files stay open.
    Result<SoakRound> round();

private:
    Status visit(const std::filesystem::path& volume, bool isBuiltAgain);
    Status move(double isovalue);
    Status exportMesh();
    Status waitFor(const std::string& what, const std::function<bool()>& isDone);
    void forgetIndexes();

    std::filesystem::path folder_;
    std::vector<std::filesystem::path> volumes_;
    std::mt19937 random_;
    MainThreadQueue queue_;
    std::unique_ptr<model::Session> session_;
    model::Subscription subscription_;
    std::string problem_; ///< the first error that the session reported
    int idleDescriptors_ = 0; ///< before any volume was opened
    int rounds_ = 0;
    int moves_ = 0;
};

/// Three volumes of different types and shapes, `side` grid points along their longest axis, written to `folder`.
std::vector<std::filesystem::path> writeSoakVolumes(const std::filesystem::path& folder, int side);

} // namespace isoslider::test
