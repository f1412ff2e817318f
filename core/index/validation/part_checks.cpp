#include "core/index/validation/part_checks.h"

#include <algorithm>
#include <string>

#include "core/index/format/chunk_codec.h"
#include "core/index/format/chunk_table.h"

namespace isoslider::index {
namespace {

constexpr std::uint64_t kReportBytes = std::uint64_t{4} << 20; // between two reports of progress

enum class PartKind : std::uint8_t { LevelPage, ChunkGroup };

struct Part {
    std::uint64_t offset = 0, bytes = 0;
    std::uint64_t number = 0; // of the page in its level, of the group
    PartKind kind = PartKind::LevelPage;
    std::uint8_t level = 0;
};

class PartChecks {
public:
    PartChecks(const IndexReader& reader, bool decodes, FaultList& faults, ValidationReport& report)
        : reader_(reader),
          meta_(reader.meta()),
          decodes_(decodes),
          faults_(faults),
          report_(report),
          chunks_(meta_.info.geometry.dims) {
        for (std::size_t level = 0; level < meta_.levels.size(); ++level)
            for (std::size_t i = 0; i < meta_.levels[level].pages.size(); ++i) {
                const PageEntry& page = meta_.levels[level].pages[i];
                parts_.push_back({page.offset, page.bytes, i, PartKind::LevelPage, static_cast<std::uint8_t>(level)});
            }
        for (std::size_t i = 0; i < meta_.chunkGroups.size(); ++i)
            parts_.push_back({meta_.chunkGroups[i].offset, meta_.chunkGroups[i].chunkBytes + tableBytes(i), i,
                              PartKind::ChunkGroup, 0});
        std::sort(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) { return a.offset < b.offset; });
    }

    Status run(const JobControl& job) {
        checkPlaces();
        std::uint64_t done = 0, nextReport = 0, all = 1;
        for (const Part& part : parts_)
            all += part.bytes;
        for (const Part& part : parts_) {
            if (job.isStopRequested())
                return cancelledError();
            if (done >= nextReport) {
                job.report(static_cast<double>(done) / static_cast<double>(all), "reading checksums");
                nextReport = done + kReportBytes;
            }
            ISO_TRY(part.kind == PartKind::ChunkGroup ? checkGroup(part, job) : checkPage(part));
            done += part.bytes;
        }
        report_.bytes += done;
        return {};
    }

private:
    std::uint64_t tableBytes(std::uint64_t group) const { return chunksInGroup(chunks_, group) * kGroupEntryBytes; }

    IndexFault describe(const Part& part) const {
        IndexFault fault;
        fault.offset = part.offset;
        const std::string number = std::to_string(part.number);
        if (part.kind == PartKind::LevelPage) {
            const PageEntry& page = meta_.levels[part.level].pages[part.number];
            fault.part = "page " + number + " of level " + std::to_string(part.level);
            fault.isovalues = faults_.isovalues(page.firstKey, page.lastKey);
        } else {
            fault.part = "table of chunk group " + number;
            const std::uint64_t first = part.number * kGroupChunks;
            fault.box = faults_.boxOfChunks(first, first + chunksInGroup(chunks_, part.number) - 1);
        }
        return fault;
    }

    // Writers leave nothing between parts: what a flipped offset or a lost part leaves there would be found by no
    // checksum.
    void checkPlaces() {
        std::uint64_t end = kPreambleBytes;
        const auto compare = [&](std::uint64_t offset, const auto& makeFault) {
            if (offset == end)
                return;
            IndexFault fault = makeFault();
            fault.problem = offset < end ? "begins inside the part before it"
                                         : "comes after " + std::to_string(offset - end) + " bytes of no part";
            faults_.add(std::move(fault));
        };
        for (const Part& part : parts_) {
            compare(part.offset, [&] { return describe(part); });
            end = std::max(end, part.offset + part.bytes);
        }
        compare(reader_.metaOffset(), [&] {
            IndexFault fault;
            fault.part = "directory";
            fault.offset = reader_.metaOffset();
            return fault;
        });
    }

    Status checkPage(const Part& part) {
        ++report_.pages;
        const PageEntry& page = meta_.levels[part.level].pages[part.number];
        const Status read = reader_.readPart(part.offset, part.bytes, page.checksum, bytes_);
        return read.isOk() ? read : addOrPassOn(faults_, read.error(), describe(part));
    }

    Status checkGroup(const Part& part, const JobControl& job) {
        const ChunkGroupEntry& group = meta_.chunkGroups[part.number];
        const std::uint64_t tableAt = group.offset + group.chunkBytes;
        const std::uint64_t count = chunksInGroup(chunks_, part.number);
        report_.chunks += count;
        const auto describeTable = [&] {
            IndexFault fault = describe(part);
            fault.offset = tableAt;
            return fault;
        };
        if (const Status read = reader_.readPart(tableAt, tableBytes(part.number), group.checksum, bytes_);
            !read.isOk())
            return addOrPassOn(faults_, read.error(), describeTable());
        std::vector<ChunkPlace> places(count);
        if (!getChunkPlaces(bytes_, group.offset, tableAt, places)) {
            IndexFault fault = describeTable();
            fault.problem = "disagrees with the bytes of its chunks";
            faults_.add(std::move(fault));
            return {};
        }
        for (std::uint64_t i = 0; i < count; ++i) {
            if (job.isStopRequested())
                return cancelledError();
            const Status read = reader_.readPart(places[i].offset, places[i].bytes, places[i].checksum, bytes_);
            const std::uint64_t chunk = part.number * kGroupChunks + i;
            const char* const problem = read.isOk() && decodes_ ? problemOfChunk(ChunkIndex(chunk)) : nullptr;
            if (read.isOk() && problem == nullptr)
                continue;
            IndexFault fault;
            fault.part = "chunk " + std::to_string(chunk);
            fault.offset = places[i].offset;
            fault.box = faults_.boxOfChunks(chunk, chunk);
            if (read.isOk()) {
                fault.problem = problem;
                faults_.add(std::move(fault));
            } else {
                ISO_TRY(addOrPassOn(faults_, read.error(), std::move(fault)));
            }
        }
        return {};
    }

    // Of bytes_; null where there is none.
    const char* problemOfChunk(ChunkIndex chunk) {
        const ChunkExtent extent = chunks_.extent(chunk);
        const auto count = static_cast<std::size_t>(extent[0] * extent[1] * extent[2]);
        return visitScalarType(meta_.info.type, [&](auto sample) -> const char* {
            thread_local std::vector<decltype(sample)> samples;
            samples.resize(count);
            return decodeChunk<decltype(sample)>(bytes_, extent, samples) ? nullptr : "cannot be decoded";
        });
    }

    const IndexReader& reader_;
    const IndexMeta& meta_;
    bool decodes_;
    FaultList& faults_;
    ValidationReport& report_;
    ChunkGrid chunks_;
    std::vector<Part> parts_;
    std::vector<std::byte> bytes_;
};

} // namespace

Status checkParts(const IndexReader& reader, bool decodes, FaultList& faults, ValidationReport& report,
                  const JobControl& job) {
    return PartChecks(reader, decodes, faults, report).run(job);
}

} // namespace isoslider::index
