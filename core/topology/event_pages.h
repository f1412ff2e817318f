#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/topology/topology_event.h"

namespace isoslider::topology {

/// Some events in a row, coded.
struct EventPage {
    static constexpr std::size_t kMostEvents = 1024;

    double firstIsovalue = 0.0;
    std::uint64_t offset = 0; ///< from the first page on
    std::uint32_t bytes = 0, events = 0;
    SurfaceCounts before;
};

/// Events in pages of a thousand, by columns of bytes: some 13 bytes each, a tenth of what they take otherwise.
/// FORMAT.md, "Topology".
struct EventPages {
    std::vector<EventPage> pages;
    std::vector<std::vector<std::byte>> bytes; ///< of each page: in one piece they would be held twice when it grows
};

/// The events of a page. `path` is named in errors. Errors: Corruption.
Result<std::vector<TopologyEvent>> decodeEvents(const EventPage& page, std::span<const std::byte> bytes,
                                                const std::string& path);

} // namespace isoslider::topology
