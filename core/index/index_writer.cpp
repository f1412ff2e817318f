#include "core/index/index_writer.h"

#include "core/base/byte_codec.h"
#include "core/base/check.h"
#include "core/index/format/chunk_table.h"

namespace isoslider::index {

Result<std::unique_ptr<IndexWriter>> IndexWriter::create(const std::filesystem::path& path, std::uint64_t seed,
                                                         FileSystem& fileSystem) {
    auto file = AtomicFile::create(path, fileSystem);
    if (!file.isOk())
        return std::move(file).error();
    // Room for the preamble; zeros are not a magic, so the partial file can never be opened.
    const std::vector<std::byte> blank(kPreambleBytes);
    ISO_TRY(file.value()->writeAll(blank));
    return std::unique_ptr<IndexWriter>(new IndexWriter(std::move(file).value(), seed));
}

Status IndexWriter::append(std::span<const std::byte> bytes) {
    constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    return buffer_.size() < kBufferBytes ? Status() : flush();
}

Status IndexWriter::flush() {
    ISO_TRY(file_->writeAll(buffer_));
    buffer_.clear();
    return {};
}

Status IndexWriter::addPage(SkipLevel level, PageEntry entry, std::span<const std::byte> bytes) {
    if (levels_.size() <= level.index())
        levels_.resize(level.index() + 1);
    entry.offset = sizeBytes();
    entry.bytes = static_cast<std::uint32_t>(bytes.size());
    entry.checksum = pageChecksum(bytes, seed_, entry.offset);
    ISO_TRY(append(bytes));
    levels_[level.index()].pages.push_back(entry);
    return {};
}

Status IndexWriter::addChunk(std::span<const std::byte> chunk) {
    ISO_CHECK(chunk.size() <= 0xffff);
    const std::uint64_t offset = sizeBytes();
    if (groupTable_.empty())
        groupOffset_ = offset;
    putChunkPlace(groupTable_, {offset, static_cast<std::uint16_t>(chunk.size()), pageChecksum(chunk, seed_, offset)});
    ISO_TRY(append(chunk));
    chunkBytes_ += chunk.size();
    return groupTable_.size() == kGroupChunks * kGroupEntryBytes ? endGroup() : Status();
}

Status IndexWriter::endGroup() {
    const std::uint64_t tableAt = sizeBytes();
    groups_.push_back({groupOffset_, tableAt - groupOffset_, pageChecksum(groupTable_, seed_, tableAt)});
    ISO_TRY(append(groupTable_));
    groupTable_.clear();
    return {};
}

void IndexWriter::endBlock(SkipLevel level, std::uint64_t firstKey, std::uint64_t lastKey) {
    if (levels_.size() <= level.index())
        levels_.resize(level.index() + 1);
    LevelDirectory& directory = levels_[level.index()];
    const std::uint64_t firstPage =
        directory.blocks.empty() ? 0 : directory.blocks.back().firstPage + directory.blocks.back().pageCount;
    directory.blocks.push_back({firstKey, lastKey, firstPage, directory.pages.size() - firstPage});
}

Result<IndexInfo> IndexWriter::finish(IndexMeta meta) {
    levels_.resize(meta.info.levels.size());
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        SkipLevelInfo& info = meta.info.levels[i];
        info.points = info.edges = info.bytes = 0;
        for (const PageEntry& page : levels_[i].pages) {
            info.points += page.points;
            info.edges += page.edges;
            info.bytes += page.bytes;
        }
        info.redundantRemoved = i == 0 ? 0 : meta.info.levels[i - 1].edges - info.edges;
    }
    ISO_CHECK(groupTable_.empty());
    meta.chunkGroups = std::move(groups_);
    meta.info.chunkBytes = chunkBytes_;
    meta.levels = std::move(levels_);
    const std::vector<std::byte> bytes = encodeMeta(meta);
    Preamble preamble;
    preamble.minor = minorOf(meta);
    preamble.metaOffset = sizeBytes();
    preamble.metaBytes = bytes.size();
    preamble.metaChecksum = metaChecksum(bytes);
    preamble.fileBytes = preamble.metaOffset + preamble.metaBytes;
    preamble.seed = seed_;
    ISO_TRY(append(bytes));
    ISO_TRY(flush());
    ISO_TRY(file_->writeAt(0, encodePreamble(preamble)));
    ISO_TRY(file_->publish());
    meta.info.indexBytes = preamble.fileBytes;
    meta.info.formatMajor = preamble.major;
    return meta.info;
}

} // namespace isoslider::index
