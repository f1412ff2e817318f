#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <span>
#include <vector>

#include "core/grid/scalar_type.h"
#include "core/topology/analysis/isovalue_order.h"
#include "core/topology/analysis/isovalue_sums.h"
#include "core/topology/analysis/packed_cause.h"

namespace isoslider::topology {

/// What changes are added up with; the memory of it serves one layer after the other.
struct EulerWork {
    struct Bin {
        Point point = 0;
        std::int64_t euler = 0;
        int largest = 0;
    };
    std::vector<Bin> bins; ///< all empty where nothing is added up
    std::vector<EulerChange> changes, sorted;
    IsovalueOrder order;
};

/// Adds up changes of the Euler number at each isovalue: those of samples, and those of saddles, each with the cause
/// that most is due to. Among equal samples most of them cancel out.
template <class Sample>
class EulerSums {
public:
    /// Of about so many samples: a bin for each value must be worth it.
    EulerSums(std::int64_t samples, EulerWork& work) : bins_(work.bins), changes_(work.changes), work_(work) {
        bins_.resize(kIsNarrow && samples >= kValues / 2 ? kValues : 0);
        changes_.clear();
    }

    void addSample(Sample sample, Point point, int euler) {
        if (euler == 0)
            return;
        if (!bins_.empty()) {
            EulerWork::Bin& bin = bins_[binOf(sample)];
            if (std::abs(euler) > bin.largest) {
                bin.largest = std::abs(euler);
                bin.point = point;
            }
            bin.euler += euler;
        } else {
            changes_.push_back({static_cast<double>(sample), Cause::vertex(point), euler});
        }
    }
    void addSaddle(double isovalue, Cause cause, int euler) {
        if (euler != 0)
            changes_.push_back({isovalue, cause, euler});
    }

    /// Ascending; of one isovalue at most one of samples and one of saddles.
    std::vector<EulerChange> take() {
        for (std::size_t i = 0; i < bins_.size(); ++i)
            for (std::int64_t rest = bins_[i].euler; rest != 0;) {
                const std::int64_t part = std::clamp(rest, -EulerChange::kMost, EulerChange::kMost);
                changes_.push_back(
                    {static_cast<double>(static_cast<std::int64_t>(i) + kLeast), Cause::vertex(bins_[i].point), part});
                rest -= part;
            }
        std::fill(bins_.begin(), bins_.end(), EulerWork::Bin());
        const std::span<const std::uint32_t> places = work_.order.of(changes_);
        work_.sorted.resize(changes_.size());
        for (std::size_t i = 0; i < places.size(); ++i)
            work_.sorted[i] = changes_[places[i]];
        sumUp(work_.sorted);
        return {work_.sorted.begin(), work_.sorted.end()};
    }

private:
    static constexpr bool kIsNarrow = sizeof(Sample) <= 2; // then there may be a bin for each value
    static constexpr std::int64_t kValues = std::int64_t{1} << (8 * sizeof(Sample) % 32);
    static constexpr std::int64_t kLeast =
        kIsNarrow ? static_cast<std::int64_t>(std::numeric_limits<Sample>::lowest()) : 0;
    static std::size_t binOf(Sample sample) {
        if constexpr (kIsNarrow)
            return static_cast<std::size_t>(static_cast<std::int64_t>(sample) - kLeast);
        return 0;
    }

    std::vector<EulerWork::Bin>& bins_;
    std::vector<EulerChange>& changes_;
    EulerWork& work_;
};

} // namespace isoslider::topology
