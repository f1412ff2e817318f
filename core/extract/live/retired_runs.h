#pragma once

#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "core/extract/live/run_arena.h"

namespace isoslider::extract {

/// What a brick has had of the arenas.
struct RetiredRuns {
    ArenaRun vertices, indices, inner, points;
};

/// Runs that pictures up to a version refer to. Lists go round: their memory, asked for and given back at every move,
/// would be cleared by the system each time.
class RetiredList {
public:
    /// Takes over what is in `runs` and leaves it empty. REQUIRES: versions never descend. Throws std::bad_alloc.
    void add(std::uint32_t version, std::vector<RetiredRuns>& runs) {
        if (runs.empty())
            return;
        lists_.push_back({version, {}});
        if (!spare_.empty()) {
            lists_.back().runs = std::move(spare_.back());
            spare_.pop_back();
        }
        std::swap(lists_.back().runs, runs);
    }
    void add(std::uint32_t version, const RetiredRuns& runs) {
        if (lists_.empty() || lists_.back().version != version)
            lists_.push_back({version, {}});
        lists_.back().runs.push_back(runs);
    }
    /// Calls release(runs) for the lists of versions up to `oldest`, which are forgotten then.
    template <class Release>
    void releaseUntil(std::uint32_t oldest, const Release& release) {
        while (!lists_.empty() && lists_.front().version <= oldest) {
            std::vector<RetiredRuns> runs = std::move(lists_.front().runs);
            lists_.pop_front();
            release(runs);
            runs.clear();
            if (spare_.size() < kMostSpare)
                spare_.push_back(std::move(runs));
        }
    }
    void clear() noexcept {
        lists_.clear();
        spare_.clear();
    }

private:
    struct Retired {
        std::uint32_t version;
        std::vector<RetiredRuns> runs;
    };
    static constexpr std::size_t kMostSpare = 8;

    std::deque<Retired> lists_; ///< versions ascend
    std::vector<std::vector<RetiredRuns>> spare_;
};

} // namespace isoslider::extract
