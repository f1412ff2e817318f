#include "ui/model/session/index_cache.h"

#include <cstdio>
#include <span>
#include <system_error>

#include "core/base/content_hash.h"
#include "core/base/file_system.h"
#include "core/base/folders.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

/// Changes when the index format or what names an entry does, so that old entries are simply not found.
constexpr std::string_view kKeyVersion = "isx3";
constexpr std::string_view kRecordSuffix = ".source";
constexpr std::size_t kMostRecordBytes = 32u << 20;
constexpr std::size_t kMostRecords = 4096; // looked through for a volume that has moved

fs::path recordOf(fs::path index) { return index += kRecordSuffix; }

/// Layout, line break, stamp.
std::optional<VolumeStamp> readRecord(const fs::path& index, std::string_view layout) {
    const auto bytes = readWholeFile(recordOf(index), kMostRecordBytes);
    if (!bytes.isOk())
        return std::nullopt;
    const std::string text(reinterpret_cast<const char*>(bytes.value().data()), bytes.value().size());
    const std::string start = std::string(layout) + "\n";
    return text.starts_with(start) ? VolumeStamp::fromText(text.substr(start.size())) : std::nullopt;
}

Status writeRecord(const fs::path& index, const VolumeStamp& stamp, std::string_view layout) {
    return writeWholeFile(recordOf(index), std::string(layout) + "\n" + stamp.toText());
}

} // namespace

fs::path IndexCache::pathForFile(const fs::path& volume, std::string_view layout) const {
    const auto resolved = canonicalPath(volume);
    const fs::path& absolute = resolved.isOk() ? resolved.value() : volume;
    std::string key = absolute.string() + "|";
    key += layout;
    return pathForKey(absolute.stem().string(), std::move(key));
}

fs::path IndexCache::pathForSample(std::string_view name) const {
    return pathForKey(name, "sample:" + std::string(name));
}

fs::path IndexCache::pathForKey(std::string_view stem, std::string key) const {
    key += kKeyVersion;
    ContentHash keyHash;
    keyHash.add(std::as_bytes(std::span(key)));
    char hash[17];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(keyHash.value()));
    return folder_ / (std::string(stem.substr(0, 64)) + "-" + hash + ".isx");
}

IndexCache::Finding IndexCache::find(const VolumeStamp& volume, std::string_view layout, const JobControl& job) const {
    const fs::path index = pathForFile(volume.volume(), layout);
    if (!isPresent(index))
        return takeMoved(volume, layout, job) ? Finding::Fresh : Finding::None;
    const auto recorded = readRecord(index, layout);
    if (!recorded)
        return Finding::None;
    if (recorded->looksLike(volume))
        return Finding::Fresh;
    if (!recorded->couldBe(volume))
        return Finding::Stale;
    VolumeStamp present = volume;
    if (!present.hash(job).isOk())
        return Finding::None;
    if (!present.hasContentOf(*recorded))
        return Finding::Stale;
    (void)writeRecord(index, present, layout); // or the bytes are read again the next time
    return Finding::Fresh;
}

bool IndexCache::takeMoved(const VolumeStamp& volume, std::string_view layout, const JobControl& job) const {
    const auto indexes = listFiles(folder_);
    if (!indexes.isOk())
        return false;
    std::size_t seen = 0;
    std::optional<VolumeStamp> present; // with hashes, once they are needed
    for (const fs::path& index : indexes.value()) {
        if (index.extension() != ".isx")
            continue;
        if (++seen > kMostRecords)
            break;
        const auto recorded = readRecord(index, layout);
        if (!recorded || !recorded->couldBe(volume) || isPresent(recorded->volume()))
            continue;
        if (!present) {
            present = volume;
            if (!present->hash(job).isOk())
                return false;
        }
        const fs::path here = pathForFile(volume.volume(), layout);
        if (!present->hasContentOf(*recorded) || !writeRecord(here, *present, layout).isOk())
            continue;
        if (!defaultFileSystem().renameDurably(index, here).isOk())
            return false;
        forget(index);
        return true;
    }
    return false;
}

void IndexCache::forget(const fs::path& index) { static_cast<void>(defaultFileSystem().removeFile(recordOf(index))); }

Status IndexCache::record(const fs::path& index, VolumeStamp volume, std::string_view layout, const JobControl& job) {
    ISO_TRY(volume.hash(job));
    return writeRecord(index, volume, layout);
}

} // namespace isoslider::model
