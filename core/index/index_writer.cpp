#include "core/index/index_writer.h"

namespace isoslider::index {

Result<std::unique_ptr<IndexWriter>> IndexWriter::create(const std::filesystem::path& path, std::uint64_t seed, FileSystem& fileSystem) {
    auto file = AtomicFile::create(path, fileSystem);
    if (!file.isOk())
        return std::move(file).error();
    // Room for the preamble; zeros are not a magic, so the partial file can never be opened.
    const std::vector<std::byte> blank(kPreambleBytes);
    ISO_TRY(file.value()->writeAll(blank));
    return std::unique_ptr<IndexWriter>(new IndexWriter(std::move(file).value(), seed));
}

Status IndexWriter::addPage(int level, PageEntry entry, std::span<const std::byte> bytes) {
    if (levels_.size() <= static_cast<std::size_t>(level))
        levels_.resize(static_cast<std::size_t>(level) + 1);
    entry.offset = file_->sizeBytes();
    entry.bytes = static_cast<std::uint32_t>(bytes.size());
    entry.checksum = pageChecksum(bytes, seed_, entry.offset);
    ISO_TRY(file_->writeAll(bytes));
    levels_[static_cast<std::size_t>(level)].pages.push_back(entry);
    return {};
}

Status IndexWriter::addHiddenPage(HiddenPageEntry entry, std::span<const std::byte> bytes) {
    entry.offset = file_->sizeBytes();
    entry.bytes = static_cast<std::uint32_t>(bytes.size());
    entry.checksum = pageChecksum(bytes, seed_, entry.offset);
    ISO_TRY(file_->writeAll(bytes));
    hiddenPages_.push_back(entry);
    return {};
}

void IndexWriter::endBlock(int level, std::uint64_t firstKey, std::uint64_t lastKey) {
    if (levels_.size() <= static_cast<std::size_t>(level))
        levels_.resize(static_cast<std::size_t>(level) + 1);
    LevelDirectory& directory = levels_[static_cast<std::size_t>(level)];
    const std::uint64_t firstPage = directory.blocks.empty() ? 0 : directory.blocks.back().firstPage + directory.blocks.back().pageCount;
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
    meta.levels = std::move(levels_);
    meta.hiddenPages = std::move(hiddenPages_);
    countHiddenCorners(meta);
    const std::vector<std::byte> bytes = encodeMeta(meta);
    Preamble preamble;
    preamble.metaOffset = file_->sizeBytes();
    preamble.metaBytes = bytes.size();
    preamble.metaChecksum = metaChecksum(bytes);
    preamble.fileBytes = preamble.metaOffset + preamble.metaBytes;
    preamble.seed = seed_;
    ISO_TRY(file_->writeAll(bytes));
    ISO_TRY(file_->writeAt(0, encodePreamble(preamble)));
    ISO_TRY(file_->publish());
    meta.info.indexBytes = preamble.fileBytes;
    return meta.info;
}

} // namespace isoslider::index
