#include "core/topology/topology_summary.h"

#include <algorithm>
#include <iterator>

namespace isoslider::topology {

const char* eventKindName(EventKind kind) {
    switch (kind) {
        case EventKind::Vertex: return "vertex";
        case EventKind::FaceSaddle: return "face_saddle";
        case EventKind::BodySaddle: return "body_saddle";
    }
    return "";
}

SurfaceMeasures MeasureCurves::at(double isovalue) const {
    if (isEmpty())
        return {};
    const auto next = std::lower_bound(isovalues.begin(), isovalues.end(), isovalue);
    const auto place = static_cast<std::size_t>(next - isovalues.begin());
    if (place == 0)
        return measures.front();
    if (place == isovalues.size())
        return measures.back();
    const SurfaceMeasures &a = measures[place - 1], &b = measures[place];
    const double t = (isovalue - isovalues[place - 1]) / (isovalues[place] - isovalues[place - 1]);
    const auto between = [t](double from, double to) { return from * (1.0 - t) + to * t; };
    return {between(a.area, b.area), between(a.volume, b.volume), between(a.triangles, b.triangles),
            between(a.gradient, b.gradient)};
}

Status TopologySummary::visitEventsFrom(double isovalue, const std::function<bool(const TopologyEvent&)>& visit) const {
    return visitEvents([&](const TopologyEvent& event) { return event.isovalue < isovalue || visit(event); });
}

Result<std::vector<TopologyEvent>> TopologySummary::mostPersistent(std::size_t count) const {
    // A heap whose top is the least of those kept: one pass, memory for `count`.
    std::vector<TopologyEvent> kept;
    const auto isMore = [](const TopologyEvent& a, const TopologyEvent& b) {
        return a.persistence != b.persistence ? a.persistence > b.persistence : a.isovalue < b.isovalue;
    };
    ISO_TRY(visitEvents([&](const TopologyEvent& event) {
        if (kept.size() == count && (count == 0 || !isMore(event, kept.front())))
            return count > 0;
        if (kept.size() == count) {
            std::pop_heap(kept.begin(), kept.end(), isMore);
            kept.pop_back();
        }
        kept.push_back(event);
        std::push_heap(kept.begin(), kept.end(), isMore);
        return true;
    }));
    std::sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.isovalue < b.isovalue; });
    return kept;
}

} // namespace isoslider::topology
