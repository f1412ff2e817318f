#include "ui/model/session/index_cache.h"

#include <cstdio>
#include <span>
#include <system_error>

#include "core/base/content_hash.h"
#include "core/base/file_system.h"

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
    std::error_code error;
    auto absolute = fs::weakly_canonical(volume, error);
    if (error)
        absolute = volume;
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
    std::error_code error;
    if (!fs::exists(index, error))
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
    std::error_code error, ignored;
    std::size_t seen = 0;
    std::optional<VolumeStamp> present; // with hashes, once they are needed
    for (fs::directory_iterator entry(folder_, error), end; !error && entry != end && seen < kMostRecords;
         entry.increment(error)) {
        const fs::path& index = entry->path();
        if (index.extension() != ".isx")
            continue;
        ++seen;
        const auto recorded = readRecord(index, layout);
        if (!recorded || !recorded->couldBe(volume) || fs::exists(recorded->volume(), ignored))
            continue;
        if (!present) {
            present = volume;
            if (!present->hash(job).isOk())
                return false;
        }
        const fs::path here = pathForFile(volume.volume(), layout);
        if (!present->hasContentOf(*recorded) || !writeRecord(here, *present, layout).isOk())
            continue;
        fs::rename(index, here, error);
        if (error)
            return false;
        fs::remove(recordOf(index), ignored);
        return true;
    }
    return false;
}

void IndexCache::forget(const fs::path& index) {
    std::error_code ignored;
    fs::remove(recordOf(index), ignored);
}

Status IndexCache::record(const fs::path& index, VolumeStamp volume, std::string_view layout, const JobControl& job) {
    ISO_TRY(volume.hash(job));
    return writeRecord(index, volume, layout);
}

} // namespace isoslider::model
