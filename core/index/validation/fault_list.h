#pragma once

#include <mutex>
#include <vector>

#include "core/index/index_reader.h"
#include "core/index/validation/index_validation.h"

namespace isoslider::index {

/// Collects faults of an index, and states where in the box and on the isovalue axis its parts lie. Any thread.
class FaultList {
public:
    FaultList(const IndexReader& reader, std::size_t most) : reader_(reader), most_(most) {}

    void add(IndexFault fault);
    std::uint64_t count() const { return count_; }
    std::vector<IndexFault> take();

    /// The scalar of a key, as a range of one page or block.
    std::optional<std::array<double, 2>> isovalues(std::uint64_t firstKey, std::uint64_t lastKey) const;
    /// What bricks first to last cover, in their order with x fastest.
    PointBox boxOfBricks(std::uint64_t first, std::uint64_t last) const;
    PointBox boxOfChunks(std::uint64_t first, std::uint64_t last) const;

private:
    const IndexReader& reader_;
    std::size_t most_;
    std::uint64_t count_ = 0;
    std::vector<IndexFault> faults_;
    std::mutex mutex_;
};

/// Adds an error that reading a part has ended with; hands on all but Corruption.
Status addOrPassOn(FaultList& faults, const Error& error, IndexFault fault);

} // namespace isoslider::index
