#include "core/topology/stored_topology.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core/base/byte_codec.h"
#include "core/grid/scalar_key.h"
#include "core/index/format/byte_planes.h"
#include "core/index/format/index_format.h"
#include "core/index/format/zigzag.h"
#include "core/index/index_appendix.h"

namespace isoslider::topology {
namespace {

// Events in pages of a thousand, by columns of bytes; a directory tells where each page begins, and the counts there.
// FORMAT.md, "Topology".
constexpr std::uint32_t kKindOfEvents = 1, kKindOfCounts = 2; // of appendix; of the latter pages hold steps of counts
constexpr std::size_t kPageEvents = 1024;
constexpr std::size_t kMostPageBytes = std::size_t{1} << 20;
constexpr std::size_t kWideColumns = 3, kNarrowColumns = 9;
constexpr int kPlanes = 8 * kWideColumns + 4 * kNarrowColumns;
constexpr unsigned kPlaceBits = 21; // half grid steps along an axis

struct Page {
    double firstIsovalue = 0.0;
    std::uint64_t offset = 0, checksum = 0; ///< from the first page on
    std::uint32_t bytes = 0, events = 0;
    SurfaceCounts before;
};

void put(ByteWriter& out, const SurfaceCounts& counts) {
    for (const std::int64_t count : {counts.components, counts.euler, counts.loops, counts.voids})
        out.put<std::uint64_t>(static_cast<std::uint64_t>(count));
}
SurfaceCounts getCounts(ByteReader& in) {
    SurfaceCounts counts;
    for (std::int64_t* count : {&counts.components, &counts.euler, &counts.loops, &counts.voids})
        *count = static_cast<std::int64_t>(in.get<std::uint64_t>());
    return counts;
}

// What an event changes of each count, as unsigned numbers that are small: one for each narrow column but the last.
std::array<std::int64_t, 4> changesOf(const TopologyEvent& event) {
    return {event.above.components - event.below.components, event.above.euler - event.below.euler,
            event.above.loops - event.below.loops, event.above.voids - event.below.voids};
}

std::int32_t changeOf(std::uint32_t code) { return static_cast<std::int32_t>(index::unzigzag(code)); }

struct Columns {
    std::array<std::vector<std::uint64_t>, kWideColumns> wide; ///< isovalue's key from the last one, persistence, place
    std::array<std::vector<std::uint32_t>, kNarrowColumns> narrow; ///< four changes, four of pieces, kind
};

std::vector<std::byte> encodePage(const std::vector<TopologyEvent>& events) {
    Columns columns;
    std::uint64_t last = 0;
    for (const TopologyEvent& event : events) {
        const std::uint64_t key = keyOf(event.isovalue);
        columns.wide[0].push_back(key - last);
        last = key;
        columns.wide[1].push_back(std::bit_cast<std::uint64_t>(event.persistence));
        std::uint64_t place = 0;
        for (unsigned a = 0; a < 3; ++a)
            place |= static_cast<std::uint64_t>(std::llround(2.0 * static_cast<double>(event.position[a])))
                     << (kPlaceBits * a);
        columns.wide[2].push_back(place);
        const auto changes = changesOf(event);
        for (std::size_t c = 0; c < changes.size(); ++c)
            columns.narrow[c].push_back(index::zigzag(static_cast<std::uint32_t>(changes[c])));
        columns.narrow[4].push_back(event.pieces.births);
        columns.narrow[5].push_back(event.pieces.deaths);
        columns.narrow[6].push_back(event.pieces.joins);
        columns.narrow[7].push_back(event.pieces.splits);
        columns.narrow[8].push_back(static_cast<std::uint32_t>(event.kind));
    }
    std::vector<std::byte> page;
    index::PlaneWriter planes(page, kPlanes);
    for (const auto& column : columns.wide)
        planes.addColumn(column, 8);
    for (const auto& column : columns.narrow)
        planes.addColumn(column, 4);
    return page;
}

Result<std::vector<TopologyEvent>> decodePage(const Page& page, std::span<const std::byte> bytes,
                                              const std::string& path) {
    index::PlaneReader planes(bytes, path, page.offset);
    ISO_TRY(planes.beginPlanes(0, kPlanes));
    Columns columns;
    for (auto& column : columns.wide)
        ISO_TRY(planes.readColumn(column, page.events, 8));
    for (auto& column : columns.narrow)
        ISO_TRY(planes.readColumn(column, page.events, 4));
    std::vector<TopologyEvent> events(page.events);
    std::uint64_t key = 0;
    SurfaceCounts counts = page.before;
    for (std::size_t i = 0; i < events.size(); ++i) {
        TopologyEvent& event = events[i];
        const std::uint64_t before = key;
        key += columns.wide[0][i];
        event.isovalue = sampleOfKey<double>(key);
        event.persistence = std::bit_cast<double>(columns.wide[1][i]);
        if (!std::isfinite(event.isovalue) || (i > 0 && key <= before) || !(event.persistence >= 0.0) ||
            !std::isfinite(event.persistence))
            return planes.corrupt("events do not ascend");
        for (unsigned a = 0; a < 3; ++a)
            event.position[a] =
                0.5f * static_cast<float>(columns.wide[2][i] >> (kPlaceBits * a) & ((1u << kPlaceBits) - 1));
        if (columns.narrow[8][i] > static_cast<std::uint32_t>(EventKind::BodySaddle))
            return planes.corrupt("kind of an event");
        event.kind = static_cast<EventKind>(columns.narrow[8][i]);
        event.pieces = {columns.narrow[4][i], columns.narrow[5][i], columns.narrow[6][i], columns.narrow[7][i]};
        event.below = counts;
        counts.components += changeOf(columns.narrow[0][i]);
        counts.euler += changeOf(columns.narrow[1][i]);
        counts.loops += changeOf(columns.narrow[2][i]);
        counts.voids += changeOf(columns.narrow[3][i]);
        event.above = counts;
    }
    return events;
}

class StoredTopology final : public TopologySummary {
public:
    static Result<std::shared_ptr<const TopologySummary>> open(index::Appendix appendix, const std::string& path) {
        auto stored = std::make_shared<StoredTopology>();
        const auto damaged = [&] { return makeError(ErrorCode::Corruption, "topology of the index is damaged", path); };
        ByteReader in(appendix.directory);
        const auto kind = in.get<std::uint32_t>();
        if (kind != kKindOfEvents && kind != kKindOfCounts)
            return makeError(ErrorCode::UnsupportedVersion, "topology of the index is of a later version", path);
        stored->hasEvents_ = kind == kKindOfEvents;
        stored->areCountsExact_ = in.get<std::uint8_t>() != 0;
        const auto pages = in.get<std::uint64_t>();
        if (in.hasFailed() || pages > appendix.directory.size() / 64)
            return damaged();
        constexpr std::int64_t kMostCounted = std::int64_t{1} << 50;
        for (std::uint64_t i = 0; i < pages; ++i) {
            Page page;
            page.firstIsovalue = in.get<double>();
            page.offset = in.get<std::uint64_t>();
            page.checksum = in.get<std::uint64_t>();
            page.bytes = in.get<std::uint32_t>();
            page.events = in.get<std::uint32_t>();
            page.before = getCounts(in);
            const bool isInBody = page.offset <= appendix.bodyBytes && page.bytes <= appendix.bodyBytes - page.offset;
            if (!isInBody || page.bytes > kMostPageBytes || page.events == 0 || page.events > kPageEvents ||
                !std::isfinite(page.firstIsovalue) ||
                (i > 0 && !(page.firstIsovalue > stored->pages_.back().firstIsovalue)))
                return damaged();
            for (const std::int64_t count :
                 {page.before.components, page.before.euler, page.before.loops, page.before.voids})
                if (count > kMostCounted || count < -kMostCounted)
                    return damaged();
            stored->eventCount_ += page.events;
            stored->pages_.push_back(page);
        }
        const auto isovalues = in.get<std::uint32_t>();
        if (in.hasFailed() || isovalues > in.remaining() / 40)
            return damaged();
        for (std::uint32_t i = 0; i < isovalues; ++i) {
            auto& curves = stored->curves_;
            curves.isovalues.push_back(in.get<double>());
            SurfaceMeasures at;
            for (double* measure : {&at.area, &at.volume, &at.triangles, &at.gradient}) {
                *measure = in.get<double>();
                if (std::isnan(*measure))
                    return damaged();
            }
            curves.measures.push_back(at);
            if (!std::isfinite(curves.isovalues.back()) || (i > 0 && !(curves.isovalues[i] > curves.isovalues[i - 1])))
                return damaged();
        }
        if (in.hasFailed() || in.remaining() != 0)
            return damaged();
        stored->file_ = std::move(appendix.file);
        stored->bodyOffset_ = appendix.bodyOffset;
        stored->path_ = path;
        return std::shared_ptr<const TopologySummary>(std::move(stored));
    }

    std::uint64_t eventCount() const override { return eventCount_; }
    bool areCountsExact() const override { return areCountsExact_; }
    bool hasEvents() const override { return hasEvents_; }
    const MeasureCurves& curves() const override { return curves_; }

    Result<SurfaceCounts> at(double isovalue) const override {
        const auto next = std::partition_point(pages_.begin(), pages_.end(),
                                               [&](const Page& page) { return page.firstIsovalue < isovalue; });
        if (next == pages_.begin())
            return pages_.empty() ? SurfaceCounts() : pages_.front().before;
        const Page& page = *std::prev(next);
        const std::lock_guard lock(mutex_);
        if (recent_ != &page) {
            auto events = read(page);
            if (!events.isOk())
                return std::move(events).error();
            recentEvents_ = std::move(events).value();
            recent_ = &page;
        }
        const auto event = std::partition_point(recentEvents_.begin(), recentEvents_.end(),
                                                [&](const TopologyEvent& e) { return e.isovalue < isovalue; });
        return event == recentEvents_.begin() ? page.before : std::prev(event)->above;
    }

    Status visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const override {
        return visitPagesFrom(pages_.begin(), visit);
    }

    Status visitEventsFrom(double isovalue, const std::function<bool(const TopologyEvent&)>& visit) const override {
        auto page = std::partition_point(pages_.begin(), pages_.end(),
                                         [&](const Page& one) { return one.firstIsovalue <= isovalue; });
        if (page != pages_.begin())
            --page; // which begins at or below it
        return visitPagesFrom(page,
                              [&](const TopologyEvent& event) { return event.isovalue < isovalue || visit(event); });
    }

private:
    Status visitPagesFrom(std::vector<Page>::const_iterator page,
                          const std::function<bool(const TopologyEvent&)>& visit) const {
        for (; page != pages_.end(); ++page) {
            const auto events = read(*page);
            if (!events.isOk())
                return events.error();
            for (const TopologyEvent& event : events.value())
                if (!visit(event))
                    return {};
        }
        return {};
    }

    Result<std::vector<TopologyEvent>> read(const Page& page) const {
        std::vector<std::byte> bytes(page.bytes);
        ISO_TRY(file_->readExactlyAt(bodyOffset_ + page.offset, bytes));
        if (index::pageChecksum(bytes, 0, page.offset) != page.checksum)
            return makeError(ErrorCode::Corruption, "topology page fails its checksum", path_,
                             bodyOffset_ + page.offset);
        return decodePage(page, bytes, path_);
    }

    std::unique_ptr<RandomAccessFile> file_;
    std::uint64_t bodyOffset_ = 0;
    std::string path_;
    bool areCountsExact_ = true, hasEvents_ = true;
    std::uint64_t eventCount_ = 0;
    std::vector<Page> pages_;
    MeasureCurves curves_;
    mutable std::mutex mutex_; // of what follows: the page that was asked last
    mutable const Page* recent_ = nullptr;
    mutable std::vector<TopologyEvent> recentEvents_;
};

} // namespace

Status storeTopology(const index::IndexReader& index, const TopologySummary& summary, bool replaces,
                     FileSystem& fileSystem) {
    std::vector<std::byte> body;
    std::vector<Page> pages;
    std::vector<TopologyEvent> events;
    const auto endPage = [&] {
        if (events.empty())
            return;
        Page page;
        page.firstIsovalue = events.front().isovalue;
        page.before = events.front().below;
        page.events = static_cast<std::uint32_t>(events.size());
        const std::vector<std::byte> bytes = encodePage(events);
        page.offset = body.size();
        page.bytes = static_cast<std::uint32_t>(bytes.size());
        page.checksum = index::pageChecksum(bytes, 0, page.offset);
        body.insert(body.end(), bytes.begin(), bytes.end());
        pages.push_back(page);
        events.clear();
    };
    ISO_TRY(summary.visitEvents([&](const TopologyEvent& event) {
        events.push_back(event);
        if (events.size() == kPageEvents)
            endPage();
        return true;
    }));
    endPage();
    std::vector<std::byte> directory;
    ByteWriter out(directory);
    out.put<std::uint32_t>(summary.hasEvents() ? kKindOfEvents : kKindOfCounts);
    out.put<std::uint8_t>(summary.areCountsExact() ? 1 : 0);
    out.put<std::uint64_t>(pages.size());
    for (const Page& page : pages) {
        out.put<double>(page.firstIsovalue);
        out.put<std::uint64_t>(page.offset);
        out.put<std::uint64_t>(page.checksum);
        out.put<std::uint32_t>(page.bytes);
        out.put<std::uint32_t>(page.events);
        put(out, page.before);
    }
    const MeasureCurves& curves = summary.curves();
    out.put<std::uint32_t>(static_cast<std::uint32_t>(curves.isovalues.size()));
    for (std::size_t i = 0; i < curves.isovalues.size(); ++i) {
        out.put<double>(curves.isovalues[i]);
        const SurfaceMeasures& at = curves.measures[i];
        for (const double measure : {at.area, at.volume, at.triangles, at.gradient})
            out.put<double>(measure);
    }
    return index::writeAppendix(index, body, directory, replaces, fileSystem);
}

Result<std::shared_ptr<const TopologySummary>> openTopology(const std::filesystem::path& index,
                                                            FileSystem& fileSystem) {
    auto appendix = index::readAppendix(index, fileSystem);
    if (!appendix.isOk())
        return std::move(appendix).error();
    if (!appendix.value())
        return std::shared_ptr<const TopologySummary>();
    return StoredTopology::open(std::move(*appendix.value()), index.string());
}

} // namespace isoslider::topology
