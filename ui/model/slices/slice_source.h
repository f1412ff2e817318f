#pragma once

#include <memory>

#include "core/extract/slices/slice_sampler.h"
#include "ui/model/session/dataset.h"

namespace isoslider::model {

/// The samples of a volume whose index is there. For a job. Errors: those of opening an index.
Result<std::shared_ptr<extract::SliceSampler>> openSamples(const Dataset& dataset);

} // namespace isoslider::model
