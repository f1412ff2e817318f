#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/job_control.h"
#include "core/grid/gradient.h"
#include "core/index/format/chunk_codec.h"
#include "core/index/index_writer.h"
#include "core/volume_io/sources/volume_source.h"

namespace isoslider::preprocess {

/// The samples from `begin` on as a chunk. REQUIRES: `view` holds them.
template <class Sample>
std::vector<std::byte> encodeSamples(const SampleView<Sample>& view, const std::array<std::int64_t, 3>& begin,
                                     const index::ChunkExtent& extent);

/// Planes of the volume in memory at once, and what is encoded side by side besides.
inline constexpr std::int64_t kSlabPlanes = index::kChunkSide;

/// Appends all samples to an index: one pass over the volume, a slab of chunks after the other, from `firstSlab` on.
/// Calls `betweenSlabs(next)` before each but the first. Errors: those of the source, of the writer and of
/// `betweenSlabs`, Cancelled.
template <class Sample>
Status writeSamples(io::VolumeSource& source, index::IndexWriter& writer, std::int64_t firstSlab, const JobControl& job,
                    const std::function<Status(std::int64_t next)>& betweenSlabs);

} // namespace isoslider::preprocess
