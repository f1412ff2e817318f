#include "core/topology/paged_topology.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <tbb/parallel_for.h>

namespace isoslider::topology {

std::uint64_t PagedTopology::eventCount() const {
    std::uint64_t count = 0;
    for (const EventPage& page : pages_)
        count += page.events;
    return count;
}

Result<SurfaceCounts> PagedTopology::at(double isovalue) const {
    const auto next = std::partition_point(pages_.begin(), pages_.end(),
                                           [&](const EventPage& page) { return page.firstIsovalue < isovalue; });
    if (next == pages_.begin())
        return pages_.empty() ? SurfaceCounts() : pages_.front().before;
    const EventPage& page = *std::prev(next);
    const auto place = static_cast<std::size_t>(std::distance(pages_.begin(), next)) - 1;
    const std::lock_guard lock(recent_->mutex);
    if (recent_->page != place) {
        auto events = read(page);
        if (!events.isOk())
            return std::move(events).error();
        recent_->events = std::move(events).value();
        recent_->page = place;
    }
    const auto event = std::partition_point(recent_->events.begin(), recent_->events.end(),
                                            [&](const TopologyEvent& e) { return e.isovalue < isovalue; });
    return event == recent_->events.begin() ? page.before : std::prev(event)->above;
}

Status PagedTopology::visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const {
    return visitPagesFrom(pages_.begin(), visit);
}

Status PagedTopology::visitEventsFrom(double isovalue, const std::function<bool(const TopologyEvent&)>& visit) const {
    auto page = std::partition_point(pages_.begin(), pages_.end(),
                                     [&](const EventPage& one) { return one.firstIsovalue <= isovalue; });
    if (page != pages_.begin())
        --page; // which begins at or below it
    return visitPagesFrom(page, [&](const TopologyEvent& event) { return event.isovalue < isovalue || visit(event); });
}

Result<std::optional<std::pair<double, double>>> PagedTopology::ends() const {
    if (pages_.empty())
        return std::optional<std::pair<double, double>>();
    const auto last = read(pages_.back());
    if (!last.isOk())
        return last.error();
    return std::optional(std::pair(pages_.front().firstIsovalue, last.value().back().isovalue));
}

// Pages are decoded on all threads, ahead of the visit: more of them the longer it goes on.
Status PagedTopology::visitPagesFrom(std::vector<EventPage>::const_iterator page,
                                     const std::function<bool(const TopologyEvent&)>& visit) const {
    constexpr std::ptrdiff_t kMostAhead = 32;
    using Page = Result<std::vector<TopologyEvent>>;
    std::vector<Page> decoded;
    for (std::ptrdiff_t ahead = 1; page != pages_.end(); ahead = std::min(2 * ahead, kMostAhead)) {
        const std::ptrdiff_t count = std::min(ahead, std::distance(page, pages_.end()));
        decoded.assign(static_cast<std::size_t>(count), Page(std::vector<TopologyEvent>()));
        tbb::parallel_for(std::ptrdiff_t{0}, count,
                          [&](std::ptrdiff_t i) { decoded[static_cast<std::size_t>(i)] = read(page[i]); });
        page += count;
        for (const Page& events : decoded) {
            if (!events.isOk())
                return events.error();
            for (const TopologyEvent& event : events.value())
                if (!visit(event))
                    return {};
        }
    }
    return {};
}

Result<std::vector<TopologyEvent>> PagedTopology::read(const EventPage& page) const {
    const auto bytes = bytesOf(page);
    if (!bytes.isOk())
        return bytes.error();
    return decodeEvents(page, bytes.value(), path_);
}

} // namespace isoslider::topology
