#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/index/format/block_codec.h"
#include "core/index/format/totals_page.h"

namespace isoslider::index {

/// What a walk needs of a page: which edges become active, and which inactive, when the isovalue rises past a record's
/// key (PAPER 2: E+, E-). Each edge has two records, one where it rises and one where it falls; so of an edge that a
/// walk passes both ends of the changes add up to nothing, and nobody needs to know where its other end is.
///
/// A page that is taken whole can do without its records: what they add up to by brick, its totals, is an eighteenth of
/// them in a block of a higher level, where neighbours meet.
///
/// Of a list of bricks a record's only bit stands for the brick. Where cells are merged, an edge that carries a vertex
/// on a leaf edge is one upwards from its lower point; leaves are left out.
template <class Key>
struct ChangePage {
    std::vector<Key> keys;
    std::vector<std::uint32_t> idsLow;
    std::vector<std::uint16_t> idsHigh;
    std::vector<std::uint8_t> rising, falling; ///< of the record's edges, as in a point record's mask
    std::size_t entries = 0; ///< set bits of both
    std::vector<BrickTotal> totals; ///< where records are not kept
    bool hasTotals = false;
    std::size_t distinctKeys = 0; ///< likewise; runs of equal ones in a page of a higher level

    std::size_t recordCount() const { return keys.size(); }
    PointId id(std::size_t i) const { return PointId(std::uint64_t{idsLow[i]} | std::uint64_t{idsHigh[i]} << 32); }
    std::size_t entriesOf(std::size_t i) const {
        return static_cast<std::size_t>(std::popcount(static_cast<unsigned>(rising[i] | falling[i])));
    }
    /// What the arrays take, which may have held a larger page before.
    std::size_t memoryBytes() const {
        return keys.capacity() * sizeof(Key) + idsLow.capacity() * sizeof(std::uint32_t) +
               idsHigh.capacity() * sizeof(std::uint16_t) + rising.capacity() + falling.capacity() +
               totals.capacity() * sizeof(BrickTotal);
    }
    /// Set bits of records [begin, end).
    std::size_t entriesOf(std::size_t begin, std::size_t end) const;
    /// Reuses the memory of what was here before.
    void assign(const DecodedPage<Key>& page);
    /// What `records` add up to, in place of these. Reuses the memory of what was here before.
    void assignTotals(const ChangePage& records, std::span<const BrickTotal> sums);
    /// What an interval adds up to whose records nobody has.
    void assignTotals(std::span<const BrickTotal> sums);
};

extern template struct ChangePage<std::uint16_t>;
extern template struct ChangePage<std::uint32_t>;
extern template struct ChangePage<std::uint64_t>;

} // namespace isoslider::index
