#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/grid/scalar_type.h"
#include "core/topology/analysis/isovalue_order.h"
#include "core/topology/analysis/isovalue_sums.h"
#include "core/topology/analysis/packed_cause.h"

namespace isoslider::topology {

/// Adds up changes of the Euler number at each isovalue: those of samples, and those of saddles, as sumUp() does. Among
/// equal samples most of them cancel out.
template <class Sample>
class EulerSums {
public:
    /// Of about so many samples: a bin for each value must be worth it.
    explicit EulerSums(std::int64_t samples) { bins_.resize(kIsNarrow && samples >= kValues / 2 ? kValues : 0); }

    void addSample(Sample sample, Point point, int euler) {
        if (euler == 0)
            return;
        if (!bins_.empty()) {
            Bin& bin = bins_[binOf(sample)];
            bin.point = std::min(bin.point, point);
            bin.euler += euler;
        } else {
            changes_.push_back({static_cast<double>(sample), Cause::vertex(point), euler});
        }
    }
    void addSaddle(double isovalue, Cause cause, int euler) {
        if (euler != 0)
            changes_.push_back({isovalue, cause, euler});
    }

    /// Ascending; of one isovalue at most one of samples and one of saddles, but for large ones.
    std::vector<EulerChange> take() {
        for (std::size_t i = 0; i < bins_.size(); ++i) {
            std::int64_t rest = bins_[i].euler;
            for (bool isThere = bins_[i].point != kNone; isThere; isThere = rest != 0) {
                const std::int64_t part = std::clamp(rest, -EulerChange::kMost, EulerChange::kMost);
                changes_.push_back(
                    {static_cast<double>(static_cast<std::int64_t>(i) + kLeast), Cause::vertex(bins_[i].point), part});
                rest -= part;
            }
        }
        IsovalueOrder().sort(changes_);
        sumUp(changes_);
        changes_.shrink_to_fit();
        return std::move(changes_);
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
    static constexpr Point kNone = ~Point{0};
    struct Bin {
        Point point = kNone;
        std::int64_t euler = 0;
    };
    std::vector<Bin> bins_;
    std::vector<EulerChange> changes_;
};

} // namespace isoslider::topology
