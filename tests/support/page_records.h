#pragma once

#include <bit>
#include <vector>

#include "core/index/format/block_codec.h"

namespace isoslider::test {

/// The records of a page, to be changed and encoded again. Where it states directions only, far keys next to the
/// record's own stand in for those at the other ends.
template <class Key>
std::vector<index::PointRecord<Key>> recordsOf(const index::DecodedPage<Key>& page) {
    std::vector<index::PointRecord<Key>> records(page.pointCount());
    std::size_t entry = 0;
    for (std::size_t i = 0; i < records.size(); ++i) {
        index::PointRecord<Key>& record = records[i];
        record.key = page.keys[i];
        record.setId(PointId(page.ids[i]));
        record.edgeMask = page.masks[i];
        record.form = page.form(i);
        for (unsigned rest = record.edgeMask; rest != 0; rest &= rest - 1) {
            const int e = std::countr_zero(rest);
            record.farKeys[e] = page.hasFarKeys(i)
                                    ? page.farKeys[entry++]
                                    : static_cast<Key>(record.key + ((page.rising[i] >> e & 1) != 0 ? 1 : -1));
        }
    }
    return records;
}

} // namespace isoslider::test
