#include "ui/model/slices/slice_source.h"

namespace isoslider::model {
namespace {

/// The volume that an index of edges was built from, if it still lies beside it.
Result<std::shared_ptr<const ScalarGrid>> volumeOf(const Dataset& dataset, const SessionServices& services,
                                                   const JobControl& job) {
    const Error none = makeError(ErrorCode::InvalidArgument, kNoSamples);
    if (!dataset.index || dataset.index->sourceName.empty())
        return none;
    // A name only: it was read from a file.
    const auto path = dataset.indexPath.parent_path() / std::filesystem::path(dataset.index->sourceName).filename();
    auto source = services.volumes.open(path, dataset.readOptions);
    if (!source.isOk() || source.value()->info().geometry != dataset.geometry ||
        source.value()->info().type != dataset.type || dataset.sampleBytes() > services.wholeVolumeBytes)
        return none;
    auto grid = services.volumes.read(*source.value(), path, job);
    if (!grid.isOk())
        return grid.isCancelled() ? cancelledError() : none;
    return std::shared_ptr<const ScalarGrid>(std::move(grid).value());
}

bool holdsSamples(const Dataset& dataset) { return !dataset.index || dataset.index->kind != index::IndexKind::Edges; }

} // namespace

Result<std::shared_ptr<extract::SliceSampler>> openSamples(const Dataset& dataset, const SessionServices& services,
                                                           const JobControl& job) {
    if (!holdsSamples(dataset)) {
        auto volume = volumeOf(dataset, services, job);
        if (!volume.isOk())
            return std::move(volume).error();
        return std::shared_ptr<extract::SliceSampler>(extract::makeSliceSampler(std::move(volume).value()));
    }
    auto sampler = extract::openSliceSampler(dataset.indexPath);
    if (!sampler.isOk())
        return sampler.error();
    return std::shared_ptr<extract::SliceSampler>(std::move(sampler).value());
}

Result<std::shared_ptr<index::SampleBlocks>> openBlocks(const Dataset& dataset, const SessionServices& services,
                                                        const JobControl& job) {
    if (holdsSamples(dataset))
        return index::openSampleBlocks(dataset.indexPath);
    auto volume = volumeOf(dataset, services, job);
    if (!volume.isOk())
        return std::move(volume).error();
    return index::makeSampleBlocks(std::move(volume).value());
}

} // namespace isoslider::model
