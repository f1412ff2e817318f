#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <vector>

#include <tbb/task_group.h>

#include "core/topology/event_pages.h"
#include "core/topology/topology_event.h"

namespace isoslider::topology {

/// Codes pages while further events are added, on other threads where there are any.
class EventCoder {
public:
    ~EventCoder();

    /// REQUIRES: isovalues ascend; each begins with the counts that the one before it ends with. Positions are kept to
    /// half a grid step.
    void add(const TopologyEvent& event);
    /// All that were added.
    EventPages take();

private:
    void endPage();

    static constexpr int kMostWaiting = 16; ///< pages that are not coded yet

    std::vector<TopologyEvent> events_; ///< of the page to come
    std::vector<EventPage> pages_; ///< but for offsets and bytes
    std::deque<std::vector<std::byte>> bytes_; ///< stay where they are
    std::atomic<int> waiting_ = 0;
    tbb::task_group coding_;
};

} // namespace isoslider::topology
