#pragma once

#include <cstdint>

#include "core/grid/value_distribution.h"
#include "core/index/index_reader.h"

namespace isoslider::index {

/// Of the samples of an index: of all, if they are at most `mostSamples`, and otherwise of about that many, in chunks
/// spread over the volume. Of a list of bricks, which has none, as far as its histogram tells. Reads and decodes the
/// chunks once per pass; memory below 8 MB a thread. Errors: IoError, Corruption, Cancelled.
Result<ValueDistribution> distributionOf(const IndexReader& reader, std::uint64_t mostSamples,
                                         const JobControl& job = {});
/// Of all samples of an index, exactly; of a list of bricks as far as its histogram tells. Reads and decodes the chunks
/// once. Errors: IoError, Corruption, Cancelled.
Result<ValueSpread> spreadOf(const IndexReader& reader, const JobControl& job = {});

} // namespace isoslider::index
