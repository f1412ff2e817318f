#include "core/index/index_reader.h"

#include <algorithm>

#include "core/index/index_appendix.h"

namespace isoslider::index {

Result<std::unique_ptr<IndexReader>> IndexReader::open(const std::filesystem::path& path, FileSystem& fileSystem) {
    auto file = fileSystem.openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    std::unique_ptr<IndexReader> reader(new IndexReader());
    reader->file_ = std::move(file).value();
    reader->disk_ = fileSystem.keepsFiles() ? &fileSystem : nullptr;
    const std::uint64_t fileBytes = reader->file_->sizeBytes();

    std::vector<std::byte> first(static_cast<std::size_t>(std::min<std::uint64_t>(fileBytes, kPreambleBytes)));
    ISO_TRY(reader->file_->readExactlyAt(0, first));
    auto preamble = decodePreamble(first, fileBytes, path.string());
    if (!preamble.isOk())
        return std::move(preamble).error();
    ISO_TRY(checkBehindIndex(*reader->file_, preamble.value().fileBytes));

    std::vector<std::byte> metaBytes(preamble.value().metaBytes);
    ISO_TRY(reader->file_->readExactlyAt(preamble.value().metaOffset, metaBytes));
    if (metaChecksum(metaBytes) != preamble.value().metaChecksum)
        return makeError(ErrorCode::Corruption, "index directory fails its checksum", path.string(),
                         preamble.value().metaOffset);
    auto meta = decodeMeta(metaBytes, preamble.value(), path.string());
    if (!meta.isOk())
        return std::move(meta).error();
    reader->meta_ = std::move(meta).value();
    if (reader->meta_.info.kind == IndexKind::BrickList && reader->disk_ != nullptr)
        return makeError(ErrorCode::Corruption, "index directory is damaged: kind of index", path.string(),
                         preamble.value().metaOffset);
    reader->seed_ = preamble.value().seed;
    reader->metaOffset_ = preamble.value().metaOffset;
    reader->preambleBytes_ = std::move(first);
    reader->grid_ = BrickGrid(reader->meta_.info.geometry.dims);
    return reader;
}

Status IndexReader::readPage(const PageEntry& page, std::vector<std::byte>& bytes) const {
    return readPart(page.offset, page.bytes, page.checksum, bytes);
}

Status IndexReader::readPart(std::uint64_t offset, std::size_t size, std::uint64_t checksum,
                             std::vector<std::byte>& bytes) const {
    bytes.resize(size);
    ISO_TRY(file_->readExactlyAt(offset, bytes));
    if (pageChecksum(bytes, seed_, offset) != checksum)
        return makeError(ErrorCode::Corruption, "index page fails its checksum", pathString(), offset);
    return {};
}

} // namespace isoslider::index
