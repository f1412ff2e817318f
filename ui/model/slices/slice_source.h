#pragma once

#include <memory>

#include "core/extract/slices/slice_sampler.h"
#include "core/index/sample_blocks.h"
#include "ui/model/session/session_services.h"

namespace isoslider::model {

/// Why there are no slices of an index of edges.
inline constexpr const char* kNoSamples =
    "The index of edges holds no samples. Open the volume itself to see its slices.";

/// The samples of a volume whose index is there: the index's, or for one of edges those of the volume that it was built
/// from, if that still lies beside it. For a job. Errors: InvalidArgument with kNoSamples, Cancelled, those of opening
/// an index.
Result<std::shared_ptr<extract::SliceSampler>> openSamples(const Dataset& dataset, const SessionServices& services,
                                                           const JobControl& job);
/// The same, by place.
Result<std::shared_ptr<index::SampleBlocks>> openBlocks(const Dataset& dataset, const SessionServices& services,
                                                        const JobControl& job);

} // namespace isoslider::model
