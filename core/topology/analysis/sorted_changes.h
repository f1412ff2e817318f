#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/scratch_file.h"

namespace isoslider::topology {

/// Changes in a scratch file, isovalues ascending.
struct ChangeRun {
    std::uint64_t offset = 0, changes = 0;
};

/// Changes with ascending isovalues, taken from the first on: those of several runs in a scratch file and of one in
/// memory. Where the file fails to be read they end: status() reports it. O(log runs) each.
template <class Change>
class SortedChanges {
    static_assert(std::is_trivially_copyable_v<Change>);

public:
    SortedChanges() = default;
    /// `bufferBytes`: memory for all that is read ahead. REQUIRES: `scratch` outlives this, where there are runs.
    SortedChanges(std::vector<Change> changes, std::span<const ChangeRun> runs = {},
                  const ScratchFile* scratch = nullptr, std::size_t bufferBytes = 0)
        : scratch_(scratch) {
        constexpr std::size_t kLeast = 4096, kMost = 65536; // of a run
        if (!runs.empty())
            mostRead_ = std::clamp(bufferBytes / runs.size(), kLeast, kMost) / sizeof(Change);
        for (const ChangeRun& run : runs)
            sources_.push_back({{}, 0, run});
        sources_.push_back({std::move(changes), 0, {}}); // they came last
        for (std::size_t s = 0; s < sources_.size(); ++s) {
            read(sources_[s]);
            heap_.push_back({sources_[s].isovalue(), s});
        }
        std::make_heap(heap_.begin(), heap_.end());
    }

    /// Of the next ones; infinite after all of them.
    double isovalue() const { return heap_.empty() ? kNone : heap_.front().isovalue; }
    /// Calls `function` for the next ones if they are of this isovalue. Those of different runs are not summed up.
    template <class Function>
    void takeAt(double isovalue, const Function& function) {
        while (this->isovalue() == isovalue && isovalue < kNone) {
            Source& source = sources_[heap_.front().source];
            do {
                function(source.changes[source.at++]);
                read(source);
            } while (source.isovalue() == isovalue);
            heap_.front().isovalue = source.isovalue();
            sinkFirst();
        }
    }
    const Status& status() const { return status_; }

private:
    static constexpr double kNone = std::numeric_limits<double>::infinity();
    struct Source {
        std::vector<Change> changes;
        std::size_t at = 0;
        ChangeRun rest; ///< not read yet

        double isovalue() const { return at < changes.size() ? changes[at].isovalue : kNone; }
    };
    struct Next {
        double isovalue;
        std::size_t source;
        // The least on top; of equal ones that of the first source.
        bool operator<(const Next& other) const {
            return isovalue != other.isovalue ? isovalue > other.isovalue : source > other.source;
        }
    };

    // The first of the heap has become a later one; sources at their ends stay, after all others.
    void sinkFirst() {
        const Next first = heap_.front();
        std::size_t at = 0;
        for (std::size_t below = 1; below < heap_.size(); below = 2 * at + 1) {
            below += below + 1 < heap_.size() && heap_[below] < heap_[below + 1] ? 1 : 0;
            if (!(first < heap_[below]))
                break;
            heap_[at] = heap_[below];
            at = below;
        }
        heap_[at] = first;
    }
    void read(Source& source) {
        if (source.at < source.changes.size() || source.rest.changes == 0)
            return;
        const auto count = std::min<std::uint64_t>(source.rest.changes, mostRead_);
        source.changes.resize(count);
        source.at = 0;
        if (status_.isOk())
            status_ = scratch_->readAt(source.rest.offset, std::as_writable_bytes(std::span(source.changes)));
        if (!status_.isOk()) {
            source = {};
            return;
        }
        source.rest = {source.rest.offset + count * sizeof(Change), source.rest.changes - count};
    }

    const ScratchFile* scratch_ = nullptr;
    std::size_t mostRead_ = 0; ///< changes of a run
    std::vector<Source> sources_;
    std::vector<Next> heap_; ///< of all sources; the next one comes first
    Status status_;
};

} // namespace isoslider::topology
