#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/index/validation/fault_list.h"

namespace isoslider::index {

/// Where the curve of active edges is taken: the thresholds of the histogram's bins (FORMAT.md, "Meta").
class ValueThresholds {
public:
    explicit ValueThresholds(const IndexInfo& info);

    std::size_t count() const { return thresholds_.size(); }
    /// The first threshold above a key; count() if there is none.
    std::size_t firstAbove(std::uint64_t key) const {
        if (!table_.empty())
            return table_[key];
        return static_cast<std::size_t>(std::upper_bound(thresholds_.begin(), thresholds_.end(), key) -
                                        thresholds_.begin());
    }
    /// Compares the curve with what follows from `changes`: how many more edges are active from each threshold on.
    /// REQUIRES: count() changes, and any number after them.
    void compareCurve(std::span<const std::int64_t> changes, const IndexInfo& info, FaultList& faults) const;

private:
    std::vector<std::uint64_t> thresholds_;
    std::vector<std::uint32_t> table_; ///< of 16-bit keys
};

} // namespace isoslider::index
