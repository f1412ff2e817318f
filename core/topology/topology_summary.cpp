#include "core/topology/topology_summary.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <utility>

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

namespace {

// Weights of events that come one after the other, each known once the next change of its kind is.
class Weighing {
public:
    void add(const TopologyEvent& event) {
        const std::size_t at = weights_.size();
        weights_.push_back(event.persistence);
        const std::array<bool, 3> changes{event.below.handles() != event.above.handles(),
                                          event.below.voids != event.above.voids,
                                          event.below.loops != event.above.loops};
        for (std::size_t kind = 0; kind < changes.size(); ++kind) {
            if (!changes[kind])
                continue;
            const Last& last = last_[kind];
            const double since = last.isThere ? distance(last.isovalue, event.isovalue) : kFar;
            if (last.isThere)
                raise(last.event, std::min(last.since, since));
            last_[kind] = {true, at, event.isovalue, since};
        }
        first_ = at == 0 ? event.isovalue : first_;
        end_ = event.isovalue;
    }
    std::vector<double> take() {
        for (const Last& last : last_)
            if (last.isThere) // the last of its kind; if it is the only one, nothing is nearer than the ends
                raise(last.event, std::min(last.since, distance(first_, end_)));
        return std::move(weights_);
    }

private:
    static constexpr double kFar = std::numeric_limits<double>::max();
    struct Last {
        bool isThere = false;
        std::size_t event = 0;
        double isovalue = 0.0;
        double since = 0.0; ///< distance to the one before
    };

    static double distance(double from, double to) { return std::min(to - from, kFar); } // of doubles from end to end
    void raise(std::size_t event, double weight) { weights_[event] = std::max(weights_[event], weight); }

    std::vector<double> weights_;
    std::array<Last, 3> last_{};
    double first_ = 0.0, end_ = 0.0;
};

} // namespace

Result<std::vector<WeightedEvent>> TopologySummary::mostNotable(std::size_t count) const {
    if (!hasEvents())
        return std::vector<WeightedEvent>();
    Weighing weighing;
    ISO_TRY(visitEvents([&](const TopologyEvent& event) {
        weighing.add(event);
        return true;
    }));
    const std::vector<double> weights = weighing.take();
    std::vector<WeightedEvent> kept;
    if (count == 0 || weights.empty())
        return kept;
    // The least weight that is kept, and how many of that very weight: of equal ones the first.
    double least = 0.0;
    std::size_t ofLeast = weights.size();
    if (count < weights.size()) {
        std::vector<double> sorted = weights;
        const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(count - 1);
        std::nth_element(sorted.begin(), last, sorted.end(), std::greater<>());
        least = *last;
        const auto isMore = [least](double weight) { return weight > least; };
        ofLeast = count - static_cast<std::size_t>(std::count_if(weights.begin(), weights.end(), isMore));
    }
    std::size_t at = 0;
    ISO_TRY(visitEvents([&](const TopologyEvent& event) {
        const double weight = weights[at++];
        if (weight > least || (weight == least && ofLeast > 0)) {
            ofLeast -= weight == least ? 1 : 0;
            kept.push_back({event, weight});
        }
        return true;
    }));
    return kept;
}

} // namespace isoslider::topology
