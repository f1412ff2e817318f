#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/scratch_file.h"
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
    /// The bytes of a page: in one piece they would be held twice when it grows.
    struct Bytes {
        std::vector<std::byte> held; ///< empty: in `scratch`
        std::uint64_t offset = 0; ///< there
    };
    std::vector<EventPage> pages;
    std::vector<Bytes> bytes; ///< of each
    std::shared_ptr<const ScratchFile> scratch; ///< null: all are held

    /// Errors: those of ScratchFile::readAt.
    Result<std::vector<std::byte>> bytesOf(std::size_t page) const;
};

/// The events of a page. `path` is named in errors. Errors: Corruption.
Result<std::vector<TopologyEvent>> decodeEvents(const EventPage& page, std::span<const std::byte> bytes,
                                                const std::string& path);

} // namespace isoslider::topology
