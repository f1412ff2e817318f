#include "ui/model/slices/slice_source.h"

namespace isoslider::model {

Result<std::shared_ptr<extract::SliceSampler>> openSamples(const Dataset& dataset) {
    auto sampler = extract::openSliceSampler(dataset.indexPath);
    if (!sampler.isOk())
        return sampler.error();
    return std::shared_ptr<extract::SliceSampler>(std::move(sampler).value());
}

} // namespace isoslider::model
