#include "ui/model/session/index_cache.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <span>
#include <system_error>
#include <vector>

#include "core/base/content_hash.h"
#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/index/level_store.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

/// Changes when the index format or what names an entry does, so that old entries are simply not found.
constexpr std::string_view kKeyVersion = "isx3";
constexpr std::string_view kRecordSuffix = ".source";
constexpr std::size_t kMostRecordBytes = 32u << 20;
constexpr std::size_t kMostRecords = 4096; // looked through for a volume that has moved
constexpr std::string_view kIndexSuffix = ".isx";
constexpr std::string_view kUseSuffix = ".used"; // its time is that of the last use
/// An unfinished index that was written to since then is being built.
constexpr std::int64_t kBuildPauseNs = std::int64_t{600} * 1'000'000'000;

fs::path recordOf(fs::path index) { return index += kRecordSuffix; }
fs::path useNoteOf(fs::path index) { return index += kUseSuffix; }

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

/// An index with everything that lies beside it: record, time of its last use, an unfinished build of it.
struct Entry {
    std::vector<fs::path> files;
    std::uint64_t bytes = 0;
    std::int64_t lastTouchedNs = 0;
    bool isBeingBuilt = false;
};

/// By the path of the index, which itself need not be there.
std::map<fs::path, Entry> entriesBelow(const fs::path& folder) {
    std::map<fs::path, Entry> entries;
    const auto files = listFiles(folder);
    if (!files.isOk())
        return entries;
    const std::int64_t now = std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
    for (const fs::path& file : files.value()) {
        const std::string name = file.filename().string();
        const std::size_t end = name.rfind(kIndexSuffix);
        if (end == std::string::npos)
            continue; // none of ours
        const std::string_view rest = std::string_view(name).substr(end + kIndexSuffix.size());
        const auto stamp = stampFile(file);
        if ((!rest.empty() && rest.front() != '.') || !stamp.isOk())
            continue;
        Entry& entry = entries[folder / name.substr(0, end + kIndexSuffix.size())];
        entry.files.push_back(file);
        entry.bytes += stamp.value().size;
        entry.lastTouchedNs = std::max(entry.lastTouchedNs, stamp.value().modified);
        entry.isBeingBuilt |= rest.ends_with(".partial") && now - stamp.value().modified < kBuildPauseNs;
    }
    return entries;
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
        (void)defaultFileSystem().renameDurably(index::LevelStore::pathFor(index), index::LevelStore::pathFor(here));
        forget(index);
        (void)defaultFileSystem().removeFile(useNoteOf(index));
        return true;
    }
    return false;
}

void IndexCache::forget(const fs::path& index) { static_cast<void>(defaultFileSystem().removeFile(recordOf(index))); }

Status IndexCache::record(const fs::path& index, VolumeStamp volume, std::string_view layout, const JobControl& job) {
    ISO_TRY(volume.hash(job));
    return writeRecord(index, volume, layout);
}

IndexCache::Usage IndexCache::usage() const {
    Usage usage;
    for (const auto& [index, entry] : entriesBelow(folder_)) {
        ++usage.indexes;
        usage.bytes += entry.bytes;
    }
    return usage;
}

void IndexCache::noteUse(const fs::path& index) {
    (void)writeWholeFile(useNoteOf(index), "\n"); // or an index is taken for older than it is
}

IndexCache::Usage IndexCache::trim(const fs::path& inUse) const { return shrink(limitBytes(), inUse); }

IndexCache::Usage IndexCache::clear(const fs::path& inUse) const { return shrink(0, inUse); }

IndexCache::Usage IndexCache::shrink(std::uint64_t mostBytes, const fs::path& inUse) const {
    const auto entries = entriesBelow(folder_);
    Usage left;
    std::vector<const Entry*> removable;
    for (const auto& [index, entry] : entries) {
        ++left.indexes;
        left.bytes += entry.bytes;
        if (index != inUse && !entry.isBeingBuilt)
            removable.push_back(&entry);
    }
    std::sort(removable.begin(), removable.end(),
              [](const Entry* a, const Entry* b) { return a->lastTouchedNs < b->lastTouchedNs; });
    for (const Entry* entry : removable) {
        if (left.bytes <= mostBytes)
            break;
        // A program that has it open reads on: the bytes go when it closes the file.
        const bool isGone = std::all_of(entry->files.begin(), entry->files.end(), [](const fs::path& file) {
            return defaultFileSystem().removeFile(file).isOk();
        });
        if (!isGone)
            continue;
        --left.indexes;
        left.bytes -= entry->bytes;
    }
    return left;
}

} // namespace isoslider::model
