#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include <tbb/task_group.h>

#include "core/topology/event_pages.h"
#include "core/topology/topology_event.h"

namespace isoslider::topology {

/// Codes pages while further events are added, on other threads where there are any.
class EventCoder {
public:
    /// Pages that take more than `mostHeldBytes` go to `scratch`, if there is one.
    explicit EventCoder(std::shared_ptr<ScratchFile> scratch = {}, std::size_t mostHeldBytes = 0)
        : scratch_(std::move(scratch)), mostHeldBytes_(mostHeldBytes) {}
    ~EventCoder();

    /// REQUIRES: isovalues ascend; each begins with the counts that the one before it ends with. Positions are kept to
    /// half a grid step.
    void add(const TopologyEvent& event);
    /// All that were added. Errors: those of ScratchFile::append.
    Result<EventPages> take();

private:
    struct Coded {
        EventPages::Bytes bytes;
        std::uint32_t size = 0;
        Status status;
    };
    void endPage();
    void code(const std::vector<TopologyEvent>& events, Coded& to);

    static constexpr int kMostWaiting = 16; ///< pages that are not coded yet

    std::vector<TopologyEvent> events_; ///< of the page to come
    std::vector<EventPage> pages_; ///< but for offsets and bytes
    std::deque<Coded> coded_; ///< of each page; stay where they are
    std::shared_ptr<ScratchFile> scratch_;
    std::size_t mostHeldBytes_;
    std::atomic<std::size_t> heldBytes_ = 0; ///< and of what is in the file
    std::atomic<int> waiting_ = 0;
    tbb::task_group coding_;
};

} // namespace isoslider::topology
