#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/isovalue_order.h"
#include "core/topology/analysis/packed_cause.h"

namespace isoslider::topology {

/// Changes of one isovalue become one or two: of grid points and of saddles; with the cause that most is due to.
/// REQUIRES: in the order of isovalues, whichever.
void sumUp(std::vector<ComponentChange>& changes);
void sumUp(std::vector<EulerChange>& changes); // more where they are large

/// Changes that come part by part, summed up by isovalue time and again: they take as much memory as there are
/// isovalues. O(n log n) in those that come.
template <class Change>
class IsovalueSums {
public:
    /// Room for so many isovalues: a vector that grows is held twice for a while.
    void reserve(double count) { sorted_.reserve(static_cast<std::size_t>(count)); }
    /// In any order.
    void add(const std::vector<Change>& changes) {
        recent_.insert(recent_.end(), changes.begin(), changes.end());
        if (recent_.size() > std::max(kFew, sorted_.size() / 3))
            merge();
    }
    std::size_t count() const { return sorted_.size() + recent_.size(); }
    /// Ascending.
    std::vector<Change> take() {
        merge();
        recent_.shrink_to_fit();
        return std::exchange(sorted_, {});
    }

private:
    static constexpr std::size_t kFew = std::size_t{1} << 15;

    void merge() {
        IsovalueOrder().sort(recent_);
        sumUp(recent_);
        // In place, from the greatest down.
        std::size_t here = sorted_.size(), there = recent_.size(), to = here + there;
        if (sorted_.capacity() < to)
            sorted_.reserve(to + here / 4);
        sorted_.resize(to);
        while (there > 0) {
            const bool isHere = here > 0 && sorted_[here - 1].isovalue > recent_[there - 1].isovalue;
            sorted_[--to] = isHere ? sorted_[--here] : recent_[--there];
        }
        sumUp(sorted_);
        recent_.clear();
    }

    std::vector<Change> sorted_; ///< at most two of an isovalue
    std::vector<Change> recent_;
};

} // namespace isoslider::topology
