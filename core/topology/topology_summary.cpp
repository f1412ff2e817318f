#include "core/topology/topology_summary.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
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

Result<std::optional<std::pair<double, double>>> TopologySummary::ends() const {
    std::optional<std::pair<double, double>> found;
    ISO_TRY(visitEvents([&](const TopologyEvent& event) {
        found = {found ? found->first : event.isovalue, event.isovalue};
        return true;
    }));
    return found;
}

namespace {

// The events of the greatest weight, of equal ones the first, while events come one after the other. The weight of an
// event is known once the next change of each kind that it changes has come: so at most one for each kind waits.
class MostNotable {
public:
    /// REQUIRES: count > 0.
    explicit MostNotable(std::size_t count) : count_(count) {}

    void add(const TopologyEvent& event) {
        Waiting now{seen_++, {event, event.persistence}, 0};
        const std::array<bool, kKinds> changes{event.below.handles() != event.above.handles(),
                                               event.below.voids != event.above.voids,
                                               event.below.loops != event.above.loops};
        for (std::size_t kind = 0; kind < kKinds; ++kind)
            if (changes[kind]) {
                since_[kind] = end(kind, [&](double isovalue) { return distance(isovalue, event.isovalue); });
                now.kinds |= 1u << kind;
            }
        first_ = now.place == 0 ? event.isovalue : first_;
        last_ = event.isovalue;
        if (now.kinds != 0)
            waiting_.push_back(now);
        else
            keep(now);
    }
    /// Ascending by isovalue.
    std::vector<WeightedEvent> take() {
        for (std::size_t kind = 0; kind < kKinds; ++kind) // if it is the only one, nothing is nearer than the ends
            end(kind, [this](double) { return distance(first_, last_); });
        std::sort(kept_.begin(), kept_.end(), [](const Waiting& a, const Waiting& b) { return a.place < b.place; });
        std::vector<WeightedEvent> events;
        for (const Waiting& kept : kept_)
            events.push_back(kept.event);
        return events;
    }

private:
    static constexpr std::size_t kKinds = 3; // tunnels, voids, loops
    static constexpr double kFar = std::numeric_limits<double>::max();
    struct Waiting {
        std::size_t place = 0;
        WeightedEvent event;
        unsigned kinds = 0; ///< a bit for each of which it is the last one
    };

    static double distance(double from, double to) { return std::min(to - from, kFar); } // of doubles from end to end
    static bool isMoreNotable(const Waiting& a, const Waiting& b) {
        return a.event.weight != b.event.weight ? a.event.weight > b.event.weight : a.place < b.place;
    }

    // Nothing is waited for any more by the last change of a kind; returns how far from it the next is, by its
    // isovalue.
    template <class Distance>
    double end(std::size_t kind, const Distance& toNext) {
        const auto found = std::find_if(waiting_.begin(), waiting_.end(),
                                        [kind](const Waiting& each) { return (each.kinds >> kind & 1u) != 0; });
        if (found == waiting_.end())
            return kFar;
        const double until = toNext(found->event.event.isovalue);
        found->event.weight = std::max(found->event.weight, std::min(since_[kind], until));
        found->kinds &= ~(1u << kind);
        if (found->kinds == 0) {
            keep(*found);
            waiting_.erase(found);
        }
        return until;
    }
    // A heap, the least notable on top.
    void keep(const Waiting& event) {
        if (kept_.size() == count_ && !isMoreNotable(event, kept_.front()))
            return;
        kept_.push_back(event);
        std::push_heap(kept_.begin(), kept_.end(), isMoreNotable);
        if (kept_.size() > count_) {
            std::pop_heap(kept_.begin(), kept_.end(), isMoreNotable);
            kept_.pop_back();
        }
    }

    std::size_t count_;
    std::size_t seen_ = 0;
    std::vector<Waiting> waiting_, kept_;
    std::array<double, kKinds> since_{}; ///< distance of the last of each kind from the one before it
    double first_ = 0.0, last_ = 0.0;
};

} // namespace

Result<std::vector<WeightedEvent>> TopologySummary::mostNotable(std::size_t count) const {
    if (!hasEvents() || count == 0)
        return std::vector<WeightedEvent>();
    MostNotable notable(count);
    ISO_TRY(visitEvents([&](const TopologyEvent& event) {
        notable.add(event);
        return true;
    }));
    return notable.take();
}

} // namespace isoslider::topology
