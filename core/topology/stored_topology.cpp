#include "core/topology/stored_topology.h"

#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/byte_codec.h"
#include "core/index/format/index_format.h"
#include "core/index/index_appendix.h"

namespace isoslider::topology {
namespace {

// Pages of events; a directory states where each begins, and the counts there. FORMAT.md, "Topology".
constexpr std::uint32_t kKindOfEvents = 1, kKindOfCounts = 2; // of appendix; of the latter pages hold steps of counts
constexpr std::size_t kMostPageBytes = std::size_t{1} << 20;

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

class StoredTopology final : public PagedTopology {
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
            EventPage page;
            page.firstIsovalue = in.get<double>();
            page.offset = in.get<std::uint64_t>();
            stored->checksums_.push_back(in.get<std::uint64_t>());
            page.bytes = in.get<std::uint32_t>();
            page.events = in.get<std::uint32_t>();
            page.before = getCounts(in);
            const bool isInBody = page.offset <= appendix.bodyBytes && page.bytes <= appendix.bodyBytes - page.offset;
            if (!isInBody || page.bytes > kMostPageBytes || page.events == 0 || page.events > EventPage::kMostEvents ||
                !std::isfinite(page.firstIsovalue) ||
                (i > 0 && !(page.firstIsovalue > stored->pages_.back().firstIsovalue)))
                return damaged();
            for (const std::int64_t count :
                 {page.before.components, page.before.euler, page.before.loops, page.before.voids})
                if (count > kMostCounted || count < -kMostCounted)
                    return damaged();
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

    Result<std::vector<std::byte>> bytesOf(const EventPage& page) const override {
        std::vector<std::byte> bytes(page.bytes);
        ISO_TRY(file_->readExactlyAt(bodyOffset_ + page.offset, bytes));
        if (index::pageChecksum(bytes, 0, page.offset) != checksums_[static_cast<std::size_t>(&page - pages_.data())])
            return makeError(ErrorCode::Corruption, "topology page fails its checksum", path_,
                             bodyOffset_ + page.offset);
        return bytes;
    }

private:
    std::unique_ptr<RandomAccessFile> file_;
    std::uint64_t bodyOffset_ = 0;
    std::vector<std::uint64_t> checksums_; ///< of the pages
};

} // namespace

Status storeTopology(const index::IndexReader& index, const TopologyCurve& summary, bool replaces,
                     FileSystem& fileSystem) {
    std::vector<std::byte> directory;
    ByteWriter out(directory);
    out.put<std::uint32_t>(summary.hasEvents() ? kKindOfEvents : kKindOfCounts);
    out.put<std::uint8_t>(summary.areCountsExact() ? 1 : 0);
    out.put<std::uint64_t>(summary.pages().size());
    for (std::size_t i = 0; i < summary.pages().size(); ++i) {
        const EventPage& page = summary.pages()[i];
        const auto bytes = summary.bytesOf(page);
        if (!bytes.isOk())
            return bytes.error();
        out.put<double>(page.firstIsovalue);
        out.put<std::uint64_t>(page.offset);
        out.put<std::uint64_t>(index::pageChecksum(bytes.value(), 0, page.offset));
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
    const auto bytesOf = [&](std::size_t page) { return summary.bytesOf(summary.pages()[page]); };
    return index::writeAppendix(index, summary.pages().size(), bytesOf, directory, replaces, fileSystem);
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
