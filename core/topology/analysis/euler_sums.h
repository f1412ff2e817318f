#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <tuple>
#include <vector>

#include "core/grid/scalar_type.h"
#include "core/topology/analysis/packed_cause.h"

namespace isoslider::topology {

/// Adds up changes of the Euler number at each isovalue: those of samples, and those of saddles, each with the cause
/// that most is due to. Among equal samples most of them cancel out.
template <class Sample>
class EulerSums {
public:
    EulerSums() { bins_.resize(kIsNarrow ? std::size_t{1} << (8 * sizeof(Sample) % 32) : 0); }

    void addSample(Sample sample, Point point, int euler) {
        if (euler == 0)
            return;
        if constexpr (kIsNarrow) {
            Bin& bin = bins_[static_cast<std::size_t>(static_cast<std::int64_t>(sample) - kLeast)];
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
            if (bins_[i].euler != 0)
                changes_.push_back({static_cast<double>(static_cast<std::int64_t>(i) + kLeast),
                                    Cause::vertex(bins_[i].point), static_cast<std::int32_t>(bins_[i].euler)});
        std::sort(changes_.begin(), changes_.end(), [](const EulerChange& a, const EulerChange& b) {
            return std::tuple(a.isovalue, a.cause.isVertex(), -std::abs(a.euler), a.cause) <
                   std::tuple(b.isovalue, b.cause.isVertex(), -std::abs(b.euler), b.cause);
        });
        std::size_t kept = 0;
        for (std::size_t first = 0, next = 0; first < changes_.size(); first = next) {
            EulerChange sum = changes_[first];
            for (next = first + 1; next < changes_.size() && changes_[next].isovalue == sum.isovalue &&
                                   changes_[next].cause.isVertex() == sum.cause.isVertex();
                 ++next)
                sum.euler += changes_[next].euler;
            if (sum.euler != 0)
                changes_[kept++] = sum;
        }
        changes_.resize(kept);
        changes_.shrink_to_fit();
        return std::move(changes_);
    }

private:
    static constexpr bool kIsNarrow = sizeof(Sample) <= 2; // then there is a bin for each value
    static constexpr std::int64_t kLeast =
        kIsNarrow ? static_cast<std::int64_t>(std::numeric_limits<Sample>::lowest()) : 0;
    struct Bin {
        Point point = 0;
        std::int64_t euler = 0;
        int largest = 0;
    };
    std::vector<Bin> bins_;
    std::vector<EulerChange> changes_;
};

} // namespace isoslider::topology
