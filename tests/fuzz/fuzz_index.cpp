#include <algorithm>
#include <optional>
#include <vector>

#include "core/base/byte_codec.h"
#include "core/extract/slide_engine.h"
#include "core/grid/scalar_key.h"
#include "core/index/format/block_codec.h"
#include "core/index/index_reader.h"
#include "core/index/sample_store.h"
#include "core/index/validation/index_validation.h"
#include "tests/fuzz/fuzz_support.h"
#include "tests/fuzz/fuzz_targets.h"

namespace isoslider::fuzz {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::int64_t kMaxSlid = 1 << 14; ///< samples of a volume
constexpr std::uint64_t kMaxChunks = 64;
constexpr std::size_t kMaxPages = 64;

bool isWithin(std::uint64_t offset, std::uint64_t size, std::uint64_t end) {
    return offset <= end && size <= end - offset;
}

/// Sums over the chunks of a group, in its table, and over the table.
void repairGroup(Bytes& file, index::ChunkGroupEntry& group, std::uint64_t chunks, const index::Preamble& preamble) {
    const std::uint64_t tableAt = group.offset + group.chunkBytes;
    const std::span<std::byte> bytes(file);
    if (!isWithin(tableAt, chunks * index::kGroupEntryBytes, preamble.metaOffset))
        return;
    const auto sumAt = [&](std::uint64_t offset, std::uint64_t size) {
        return isWithin(offset, size, bytes.size())
                   ? index::pageChecksum(bytes.subspan(offset, size), preamble.seed, offset)
                   : 0;
    };
    std::uint64_t at = group.offset;
    for (std::uint64_t i = 0; i < chunks; ++i) {
        std::byte* const entry = bytes.data() + tableAt + i * index::kGroupEntryBytes;
        const auto size = loadLittle<std::uint16_t>(entry);
        storeLittle<std::uint64_t>(entry + 2, sumAt(at, size));
        at += size;
    }
    group.checksum = sumAt(tableAt, chunks * index::kGroupEntryBytes);
}

void appendMeta(Bytes& file, index::Preamble preamble, std::span<const std::byte> meta) {
    file.resize(preamble.metaOffset);
    file.insert(file.end(), meta.begin(), meta.end());
    preamble.metaBytes = meta.size();
    preamble.metaChecksum = index::metaChecksum(meta);
    preamble.fileBytes = file.size();
    const Bytes head = index::encodePreamble(preamble);
    std::copy(head.begin(), head.end(), file.begin());
}

/// The file with all its checksums made right, as a forger would: by themselves they end nearly every mutation.
std::optional<Bytes> withRightChecksums(std::span<const std::byte> input) {
    if (input.size() < index::kPreambleBytes)
        return std::nullopt;
    Bytes file(input.begin(), input.end());
    ByteReader in(input.subspan(sizeof index::kIndexMagic + 4));
    index::Preamble preamble;
    preamble.metaOffset = std::clamp<std::uint64_t>(in.get<std::uint64_t>(), index::kPreambleBytes, file.size());
    preamble.seed = loadLittle<std::uint64_t>(input.data() + 48);
    const Bytes metaBytes(file.begin() + static_cast<std::ptrdiff_t>(preamble.metaOffset), file.end());
    appendMeta(file, preamble, metaBytes);
    preamble = index::decodePreamble(file, file.size(), "input.isx").value();
    auto decoded = index::decodeMeta(metaBytes, preamble, "input.isx");
    if (!decoded.isOk())
        return file;
    index::IndexMeta& meta = decoded.value();
    const auto mend = [&](auto& part) {
        part.checksum =
            index::pageChecksum(std::span(file).subspan(part.offset, part.bytes), preamble.seed, part.offset);
    };
    const std::uint64_t chunks = index::ChunkGrid(meta.info.geometry.dims).chunkCount();
    for (std::size_t i = 0; i < meta.chunkGroups.size(); ++i)
        repairGroup(file, meta.chunkGroups[i],
                    std::min<std::uint64_t>(index::kGroupChunks, chunks - i * index::kGroupChunks), preamble);
    for (index::LevelDirectory& level : meta.levels)
        std::ranges::for_each(level.pages, mend);
    appendMeta(file, preamble, index::encodeMeta(meta));
    return file;
}

void requireGood(const Status& status) {
    if (!status.isOk())
        requireGoodError(status.error());
}

template <class Value>
void readChunks(const index::IndexReader& reader) {
    const index::SampleStore store(reader);
    std::vector<Value> values(index::SampleStore::kChunkSamples);
    std::uint64_t bytesRead = 0;
    for (const index::ChunkIndex chunk :
         firstIds<index::ChunkIndex>(std::min<std::uint64_t>(store.chunks().chunkCount(), kMaxChunks)))
        requireGood(store.read<Value>(chunk, std::span<Value, index::SampleStore::kChunkSamples>(values), bytesRead));
}

/// Every part that a page entry or a chunk names, decoded on its own.
template <class Sample>
void readParts(const index::IndexReader& reader) {
    std::size_t left = kMaxPages;
    Bytes bytes;
    for (const index::LevelDirectory& level : reader.meta().levels)
        for (const index::PageEntry& page : level.pages) {
            if (left-- == 0)
                return;
            Status status = reader.readPage(page, bytes);
            index::DecodedPage<KeyOf<Sample>> decoded;
            if (status.isOk())
                status = index::decodePage<KeyOf<Sample>>(bytes, reader.grid(), decoded, "input.isx");
            requireGood(status);
        }
    readChunks<Sample>(reader);
}

/// A few long and short moves, then the surface.
void slide(const std::filesystem::path& path) {
    extract::SlideOptions options;
    options.readsAhead = false; // what it reads, the next move reads too
    auto opened = extract::SlideEngine::open(path, options);
    if (!opened.isOk())
        return requireGoodError(opened.error());
    extract::SlideEngine& engine = *opened.value();
    const double min = engine.info().min, range = engine.info().max - min;
    for (const double part : {0.5, 0.75, 0.25, 0.26, 1.5, 0.0}) {
        const auto moved = engine.slideTo(min + part * range);
        if (!moved.isOk())
            return requireGoodError(moved.error());
        const extract::SurfaceMesh mesh = engine.mesh().value();
        for (const auto vertex : mesh.triangles)
            ISO_REQUIRE(vertex < mesh.positions.size(), std::to_string(vertex));
    }
}

void readIndex(std::span<const std::byte> bytes) {
    const auto path = writeInput("input.isx", bytes);
    const auto reader = index::IndexReader::open(path);
    if (!reader.isOk())
        return requireGoodError(reader.error());
    const index::IndexInfo& info = reader.value()->info();
    if (pointCount(info.geometry.dims) > kMaxSlid)
        return;
    visitScalarType(info.type, [&](auto sample) { readParts<decltype(sample)>(*reader.value()); });
    slide(path);
    index::ValidationOptions full;
    full.isFull = true;
    full.mostFaults = 4;
    if (const auto report = index::validateIndex(path, full); !report.isOk())
        requireGoodError(report.error());
}

} // namespace

void fuzzIndex(std::span<const std::byte> bytes) {
    readIndex(bytes);
    if (const auto forged = withRightChecksums(bytes); forged && !std::ranges::equal(*forged, bytes))
        readIndex(*forged);
}

} // namespace isoslider::fuzz
