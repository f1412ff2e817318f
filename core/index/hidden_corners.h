#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "core/index/format/hidden_corner_codec.h"
#include "core/index/index_reader.h"

namespace isoslider::index {

/// The scalars of hidden corners, looked up by cell. Pages are read when they are first asked for, and kept:
/// memory in proportion to the bricks looked at. Any number of threads at once; what is kept is
/// found without a lock, and of those that miss the same page one reads it.
class HiddenCorners {
public:
    /// Reads nothing. `reader` must outlive this.
    explicit HiddenCorners(const IndexReader& reader);
    ~HiddenCorners();
    HiddenCorners(const HiddenCorners&) = delete;
    HiddenCorners& operator=(const HiddenCorners&) = delete;

    /// The scalar at `corner` (0 to 7, numbered as in cell_numbering.h) of a cell, exactly the sample. Nothing
    /// when it is not stored: then the cell has no tunnel at the isovalues where that corner is hidden.
    /// O(log P) when no page covers the brick, else O(log P + log 4096). Errors: IoError, Corruption; the
    /// next call tries again.
    Result<std::optional<double>> find(BrickIndex brick, LocalPoint cell, int corner) const;

    /// Encoded bytes read so far.
    std::uint64_t bytesRead() const { return bytesRead_.load(std::memory_order_relaxed); }
    /// Of the pages kept.
    std::uint64_t memoryBytes() const;
    /// Forgets the pages kept. REQUIRES: no other thread is looking.
    void clear();

private:
    Result<const HiddenPage*> load(std::size_t index) const;

    const IndexReader& reader_;
    mutable std::vector<std::atomic<const HiddenPage*>> pages_; // null: not read yet
    mutable std::array<std::mutex, 16> loading_; ///< by page
    mutable std::atomic<std::uint64_t> bytesRead_ = 0;
};

} // namespace isoslider::index
