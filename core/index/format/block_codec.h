#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/grid/normal_codec.h"
#include "core/index/format/point_record.h"

namespace isoslider::index {

/// Records of one page, decoded, as columns. `far*` hold the entries of all records one after the other, each record's
/// in the order of its mask bits.
///
/// Invariants: 1. keys, ids, masks, rising have one length; 2. `entries` are the set bits of all masks; far keys are as
/// many, or with directions as many as the records of other forms have; normals and far normals, which only pages of
/// earlier versions have, are as many as keys and entries; 3. every id lies in the grid and every edge's far end too;
/// 4. in value order keys never decrease; 5. records of other forms have the entries of their form, aligned leaf edges
/// and cells inside the grid, and leaf edges whose ends enclose the interval.
template <class Key>
struct DecodedPage {
    std::vector<Key> keys; ///< with directions and by id, of points: the least key of the page
    std::vector<std::uint64_t> ids; ///< numbers of PointIds
    std::vector<std::uint8_t> masks;
    std::vector<std::uint8_t> rising; ///< of the mask: whose far ends have greater keys; of other forms all or nothing
    std::vector<std::uint8_t> forms; ///< of records (record_form); empty: all are of points
    std::vector<Key> farKeys;
    FarEnds farEnds = FarEnds::Keys;
    std::size_t entries = 0;
    std::vector<NormalCode> normals, farNormals; ///< empty: the page has none

    bool hasNormals() const { return !normals.empty(); }
    std::size_t pointCount() const { return keys.size(); }
    std::uint8_t form(std::size_t i) const { return forms.empty() ? record_form::kPoint : forms[i]; }
    bool hasFarKeys(std::size_t i) const { return farEnds == FarEnds::Keys || form(i) != record_form::kPoint; }
    /// What the arrays take, which may have held a larger page before.
    std::size_t memoryBytes() const {
        return keys.capacity() * sizeof(Key) + ids.capacity() * sizeof(std::uint64_t) + masks.capacity() +
               rising.capacity() + forms.capacity() + normals.capacity() * sizeof(NormalCode) +
               farKeys.capacity() * sizeof(Key) + farNormals.capacity() * sizeof(NormalCode);
    }
};

/// How the records of a page are sorted. Level 0 keeps (key, id) order, so that any isovalue interval
/// is a run of records; higher levels are read whole and keep id order, so that neighbours meet.
enum class PageOrder : std::uint8_t { Value = 0, Id = 1 };

/// No page holds more, so a damaged count never sizes a large allocation.
inline constexpr std::size_t kMaxPagePoints = 1u << 16;

/// Encodes records as FORMAT.md, "Page", states. O(records), deterministic.
/// REQUIRES: 0 < records.size() <= kMaxPagePoints, sorted as `order` states, every mask non-zero.
template <class Key>
std::vector<std::byte> encodePage(std::span<const PointRecord<Key>> records, PageOrder order, FarEnds farEnds,
                                  const BrickGrid& grid);

/// Decodes a page and checks the invariants of DecodedPage against `grid`. Errors: Corruption; `page`
/// is unspecified then. `path` is only for the message. Reuses the vectors' memory.
template <class Key>
Status decodePage(std::span<const std::byte> bytes, const BrickGrid& grid, DecodedPage<Key>& page,
                  const std::string& path);

extern template std::vector<std::byte> encodePage(std::span<const PointRecord<std::uint16_t>>, PageOrder, FarEnds,
                                                  const BrickGrid&);
extern template std::vector<std::byte> encodePage(std::span<const PointRecord<std::uint32_t>>, PageOrder, FarEnds,
                                                  const BrickGrid&);
extern template std::vector<std::byte> encodePage(std::span<const PointRecord<std::uint64_t>>, PageOrder, FarEnds,
                                                  const BrickGrid&);
extern template Status decodePage(std::span<const std::byte>, const BrickGrid&, DecodedPage<std::uint16_t>&,
                                  const std::string&);
extern template Status decodePage(std::span<const std::byte>, const BrickGrid&, DecodedPage<std::uint32_t>&,
                                  const std::string&);
extern template Status decodePage(std::span<const std::byte>, const BrickGrid&, DecodedPage<std::uint64_t>&,
                                  const std::string&);

} // namespace isoslider::index
