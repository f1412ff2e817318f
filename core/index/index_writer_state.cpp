#include "core/base/check.h"
#include "core/index/index_writer.h"

namespace isoslider::index {

Status IndexWriter::suspend(StateArchive& archive) {
    ISO_TRY(flush());
    ISO_TRY(file_->sync());
    state(archive);
    return {};
}

Result<std::unique_ptr<IndexWriter>> IndexWriter::resume(const std::filesystem::path& path, StateArchive& archive,
                                                         FileSystem& fileSystem) {
    std::unique_ptr<IndexWriter> writer(new IndexWriter(nullptr, 0));
    writer->state(archive);
    if (archive.hasFailed() || writer->resumedBytes_ < kPreambleBytes)
        return makeError(ErrorCode::Corruption, "the state of an unfinished build is damaged", path.string());
    auto file = AtomicFile::resume(path, {}, writer->resumedBytes_, fileSystem);
    if (!file.isOk())
        return std::move(file).error();
    writer->file_ = std::move(file).value();
    // It may have been left between its last write and its renaming, and is unfinished again.
    writer->keepUnfinished();
    ISO_TRY(writer->file_->writeAt(0, std::vector<std::byte>(kPreambleBytes)));
    return writer;
}

void IndexWriter::state(StateArchive& archive) {
    if (!archive.isLoading())
        resumedBytes_ = sizeBytes();
    archive(resumedBytes_);
    archive(seed_);
    std::size_t levels = levels_.size();
    archive(levels);
    if (archive.isLoading())
        levels_.resize(levels <= kMaxSkipLevels ? levels : 0);
    for (LevelDirectory& level : levels_) {
        archive(level.pages);
        archive(level.blocks);
    }
    archive(groups_);
    archive(groupTable_);
    archive(groupOffset_);
    archive(chunkBytes_);
}

} // namespace isoslider::index
