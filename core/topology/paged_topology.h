#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/topology/event_pages.h"
#include "core/topology/topology_summary.h"

namespace isoslider::topology {

/// A summary whose events lie in pages, wherever these are. The page that was asked for last is kept decoded.
class PagedTopology : public TopologySummary {
public:
    std::uint64_t eventCount() const override;
    Result<SurfaceCounts> at(double isovalue) const override;
    bool areCountsExact() const override { return areCountsExact_; }
    bool hasEvents() const override { return hasEvents_; }
    Status visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const override;
    Status visitEventsFrom(double isovalue, const std::function<bool(const TopologyEvent&)>& visit) const override;
    Result<std::optional<std::pair<double, double>>> ends() const override;
    const MeasureCurves& curves() const override { return curves_; }

    const std::vector<EventPage>& pages() const { return pages_; }
    /// A page as coded. Errors: IoError, Corruption.
    virtual Result<std::vector<std::byte>> bytesOf(const EventPage& page) const = 0;

protected:
    std::string path_; ///< named in errors
    bool areCountsExact_ = true, hasEvents_ = true;
    std::vector<EventPage> pages_; ///< firstIsovalue ascends
    MeasureCurves curves_;

private:
    Result<std::vector<TopologyEvent>> read(const EventPage& page) const;
    Status visitPagesFrom(std::vector<EventPage>::const_iterator page,
                          const std::function<bool(const TopologyEvent&)>& visit) const;

    /// The page that was asked for last, by its place.
    struct Recent {
        std::mutex mutex;
        std::size_t page = SIZE_MAX;
        std::vector<TopologyEvent> events;
    };
    std::shared_ptr<Recent> recent_ = std::make_shared<Recent>();
};

} // namespace isoslider::topology
