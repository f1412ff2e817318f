#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/isovalue_order.h"
#include "core/topology/analysis/packed_cause.h"
#include "core/topology/analysis/sorted_changes.h"

namespace isoslider::topology {

/// Where changes go that memory does not hold.
struct ChangeStore {
    ScratchFile* scratch = nullptr; ///< none: everything stays in memory
    std::size_t mostBytes = 0; ///< in memory, of one kind of changes
};

/// Changes of one isovalue become one or two: of grid points and of saddles; with the cause that lasts longest, the
/// first of equal ones. Whatever parts they are summed up in, the sums are the same: so those that cancel out stay, as
/// changes by nothing. REQUIRES: in the order of isovalues, whichever.
void sumUp(std::vector<ComponentChange>& changes);
void sumUp(std::vector<EulerChange>& changes); // more where they are large; none lasts
void sumUp(std::vector<ClosedChange>& changes);

/// Changes that come part by part, summed up by isovalue time and again: they take as much memory as there are
/// isovalues, and where that is more than they may take go to a file, run by run. O(n log n) in those that come.
template <class Change>
class IsovalueSums {
public:
    explicit IsovalueSums(const ChangeStore& store = {}) : store_(store) {}

    /// Room for so many isovalues: a vector that grows is held twice for a while.
    void reserve(double count) { sorted_.reserve(static_cast<std::size_t>(count)); }
    /// In any order. Errors: those of ScratchFile::append.
    Status add(const std::vector<Change>& changes) {
        recent_.insert(recent_.end(), changes.begin(), changes.end());
        if (recent_.size() > std::max(fewChanges(), sorted_.size() / 3))
            merge();
        return mayHold(sorted_.size()) ? Status() : spill();
    }
    std::size_t count() const { return sorted_.size() + recent_.size(); }
    /// In the file: those of one isovalue may be in several runs.
    std::uint64_t spilledCount() const { return spilled_; }
    /// All of them, ascending.
    SortedChanges<Change> take() {
        merge();
        std::vector<Change>().swap(recent_);
        return SortedChanges<Change>(std::exchange(sorted_, {}), runs_, store_.scratch, store_.mostBytes / 4);
    }

private:
    static constexpr std::size_t kFew = std::size_t{1} << 15;

    std::size_t fewChanges() const {
        return store_.scratch != nullptr ? std::min(kFew, store_.mostBytes / (2 * sizeof(Change))) : kFew;
    }
    bool mayHold(std::size_t count) const {
        return store_.scratch == nullptr || count * sizeof(Change) <= store_.mostBytes;
    }
    Status spill() {
        auto offset = store_.scratch->append(std::as_bytes(std::span(sorted_)));
        if (!offset.isOk())
            return std::move(offset).error();
        runs_.push_back({offset.value(), sorted_.size()});
        spilled_ += sorted_.size();
        sorted_.clear();
        return {};
    }
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

    ChangeStore store_;
    std::vector<Change> sorted_; ///< at most two of an isovalue
    std::vector<Change> recent_;
    std::vector<ChangeRun> runs_;
    std::uint64_t spilled_ = 0;
};

/// What happens to the components of one side, in the order of isovalues.
struct SideChanges {
    SortedChanges<ComponentChange> births, joins;
    SortedChanges<ClosedChange> reached;
    std::uint64_t lasting = 0; ///< components in the end
};

/// What ComponentHistory has of one side, as it comes.
class HistorySums {
public:
    explicit HistorySums(const ChangeStore& store = {}) : births(store), joins(store), reached(store) {}

    /// Errors: those of ScratchFile::append.
    Status add(const ComponentHistory& history);
    std::size_t sizeBytes() const;
    SideChanges take() { return {births.take(), joins.take(), reached.take(), lasting}; }

    std::uint64_t lasting = 0;
    IsovalueSums<ComponentChange> births, joins;
    IsovalueSums<ClosedChange> reached;
};

} // namespace isoslider::topology
