#include "core/topology/index_topology.h"

#include "core/index/sample_store.h"
#include "core/topology/topology_analysis.h"

namespace isoslider::topology {

Result<std::shared_ptr<const TopologySummary>> analyseIndex(const std::filesystem::path& index, const JobControl& job) {
    const auto reader = index::IndexReader::open(index);
    if (!reader.isOk())
        return reader.error();
    if (reader.value()->info().kind != index::IndexKind::Metacells)
        return makeError(ErrorCode::InvalidArgument, "an index of edges holds no samples; give the volume",
                         index.string());
    const auto grid = index::readSamples(*reader.value(), job.part(0.0, 0.3));
    if (!grid.isOk())
        return grid.error();
    auto curve = analyseTopology(planesOf(*grid.value()), {}, job.part(0.3, 1.0));
    if (!curve.isOk())
        return std::move(curve).error();
    return std::shared_ptr<const TopologySummary>(std::make_shared<TopologyCurve>(std::move(curve).value()));
}

} // namespace isoslider::topology
