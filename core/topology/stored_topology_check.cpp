#include "core/topology/stored_topology_check.h"

#include <cmath>
#include <limits>

#include "core/topology/stored_topology.h"

namespace isoslider::topology {
namespace {

index::IndexFault faultOf(std::string problem, double isovalue) {
    index::IndexFault fault;
    fault.part = "topology";
    fault.problem = std::move(problem);
    if (std::isfinite(isovalue))
        fault.isovalues = {isovalue, isovalue};
    return fault;
}

bool isNoSurface(const SurfaceCounts& counts) {
    return counts.components == 0 && counts.euler == 0 && counts.loops == 0;
}

bool isDamage(const Error& error) {
    return error.code == ErrorCode::Corruption || error.code == ErrorCode::UnsupportedVersion;
}

} // namespace

Result<StoredTopologyCheck> checkStoredTopology(const std::filesystem::path& index, const JobControl& job,
                                                FileSystem& fileSystem) {
    StoredTopologyCheck check;
    double last = -std::numeric_limits<double>::infinity();
    const auto refuse = [&](std::string problem) { check.faults.push_back(faultOf(std::move(problem), last)); };
    const auto stored = openTopology(index, fileSystem);
    if (!stored.isOk()) {
        if (!isDamage(stored.error()))
            return stored.error();
        refuse("cannot be read: " + stored.error().message);
        return check;
    }
    if (!stored.value())
        return check;
    check.isThere = true;
    check.hasEvents = stored.value()->hasEvents();
    SurfaceCounts before;
    const Status visited = stored.value()->visitEvents([&](const TopologyEvent& event) {
        if (check.events % 1024 == 0 && job.isStopRequested())
            return false;
        const bool isFirst = check.events++ == 0;
        if (!isFirst && !(event.isovalue > last))
            refuse("has events out of order");
        last = event.isovalue;
        if (isFirst ? !isNoSurface(event.below) : !(event.below == before))
            refuse("has an event that does not begin with the counts before it");
        before = event.above;
        return check.faults.size() < 16; // one misses, and all later ones may
    });
    if (job.isStopRequested())
        return cancelledError();
    if (!visited.isOk()) {
        if (!isDamage(visited.error()))
            return visited.error();
        refuse("cannot be read: " + visited.error().message);
    } else if (check.faults.empty() && !isNoSurface(before)) {
        refuse("ends with a surface");
    }
    if (check.events != stored.value()->eventCount() && check.faults.empty())
        refuse("has another number of events than it states");
    return check;
}

} // namespace isoslider::topology
