#include "ui/model/index_cache.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <system_error>
#include <vector>

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

/// Changes when the index format does, so that old cache entries are simply not found.
constexpr std::string_view kKeyVersion = "isx1";
constexpr std::size_t kMostCompanions = 4096;

/// FNV-1a, 64 bits: names a cache entry, protects nothing.
std::uint64_t hashOf(std::string_view text) {
    std::uint64_t hash = 14695981039346656037ULL;
    for (const char character : text)
        hash = (hash ^ static_cast<unsigned char>(character)) * 1099511628211ULL;
    return hash;
}

std::string stampOf(const fs::path& file) {
    std::error_code ignored;
    const auto size = fs::file_size(file, ignored);
    const auto time = fs::last_write_time(file, ignored).time_since_epoch().count();
    return file.filename().string() + ":" + std::to_string(size) + ":" + std::to_string(time) + ";";
}

/// Files that the volume's samples may lie in: those sharing its stem, or all of a folder.
std::string companionStamps(const fs::path& volume) {
    std::error_code error;
    const bool isFolder = fs::is_directory(volume, error);
    std::vector<std::string> stamps;
    for (fs::directory_iterator entry(isFolder ? volume : volume.parent_path(), error), end;
         !error && entry != end && stamps.size() < kMostCompanions; entry.increment(error)) {
        std::error_code ignored;
        const bool belongs = isFolder || entry->path().stem() == volume.stem();
        if (belongs && entry->is_regular_file(ignored))
            stamps.push_back(stampOf(entry->path()));
    }
    std::sort(stamps.begin(), stamps.end());
    std::string all;
    for (const auto& stamp : stamps)
        all += stamp;
    return all;
}

} // namespace

fs::path IndexCache::pathForFile(const fs::path& volume, std::string_view layout) const {
    std::error_code error;
    auto absolute = fs::weakly_canonical(volume, error);
    if (error)
        absolute = volume;
    std::string key = absolute.string() + "|" + companionStamps(absolute) + "|";
    key += layout;
    return pathForKey(absolute.stem().string(), std::move(key));
}

fs::path IndexCache::pathForSample(std::string_view name) const {
    return pathForKey(name, "sample:" + std::string(name));
}

fs::path IndexCache::pathForKey(std::string_view stem, std::string key) const {
    key += kKeyVersion;
    char hash[17];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(hashOf(key)));
    return folder_ / (std::string(stem.substr(0, 64)) + "-" + hash + ".isx");
}

} // namespace isoslider::model
