#include "core/topology/analysis/domain_boundary.h"

#include <limits>
#include <utility>

#include <tbb/parallel_invoke.h>

namespace isoslider::topology {

Status DomainBoundary::add(const BoundaryPart& part) {
    euler_ += part.euler;
    isManifold_ = isManifold_ && part.isManifold;
    tbb::parallel_invoke([&] { above_.add(part); }, [&] { below_.add(part); });
    ISO_TRY(above_.graph().status);
    return below_.graph().status;
}

Result<SideChanges> DomainBoundary::take(Side side, double span) {
    return (side == Side::Above ? above_ : below_).graph().take(span);
}

std::uint32_t DomainBoundary::Components::addNode(Point point, double scalar) {
    graph.seeds.push_back({scalar, std::numeric_limits<double>::quiet_NaN(), point});
    return nodes() - 1;
}

std::vector<std::uint32_t> DomainBoundary::Components::settle(std::vector<double>& opens) {
    ComponentHistory settled;
    std::vector<std::uint32_t> parts = settleComponents(graph, opens, settled, order);
    if (status.isOk())
        status = sums.add(settled);
    return parts;
}

Result<SideChanges> DomainBoundary::Components::take(double span) {
    ComponentHistory history;
    finishComponents(std::move(graph), span, history);
    ISO_TRY(status);
    ISO_TRY(sums.add(history));
    return sums.take();
}

} // namespace isoslider::topology
