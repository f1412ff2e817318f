#include "ui/model/volume_stamp.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <chrono>

#include <nlohmann/json.hpp>

#include "core/base/content_hash.h"
#include "core/base/file_system.h"
#include "ui/model/path_text.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostFiles = 100'000;
/// Within so long of a change a file may change again without its times showing it: their steps are those of the
/// kernel's clock, of old file systems even two seconds.
constexpr std::int64_t kSettledAfterNs = 3'000'000'000;

std::int64_t nanoseconds(const timespec& time) {
    return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

std::int64_t now() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

Result<FileStamp> stampOf(const fs::path& file, const fs::path& name) {
    struct stat found{};
    if (::stat(file.c_str(), &found) != 0)
        return systemError(errno, "cannot look at", file);
    FileStamp stamp;
    stamp.path = name;
    stamp.size = static_cast<std::uint64_t>(found.st_size);
    stamp.modified = nanoseconds(found.st_mtim);
    stamp.changed = nanoseconds(found.st_ctim);
    stamp.isSettled = stamp.changed < now() - kSettledAfterNs;
    return stamp;
}

bool isUntouched(const FileStamp& a, const FileStamp& b) {
    return a.size == b.size && a.modified == b.modified && a.changed == b.changed;
}

Result<std::vector<fs::path>> filesBelow(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error, ignored;
    fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
    for (const fs::recursive_directory_iterator end; !error && entry != end; entry.increment(error)) {
        if (!entry->is_regular_file(ignored))
            continue;
        if (files.size() == kMostFiles)
            return makeError(ErrorCode::InvalidArgument, "holds too many files to know again", folder);
        files.push_back(entry->path());
    }
    if (error)
        return systemError(error.value(), "cannot list", folder);
    std::sort(files.begin(), files.end());
    return files;
}

} // namespace

Result<VolumeStamp> VolumeStamp::of(const fs::path& volume, const std::vector<fs::path>& dataFiles) {
    std::error_code error;
    VolumeStamp stamp;
    stamp.volume_ = fs::absolute(volume, error).lexically_normal();
    if (error)
        return systemError(error.value(), "cannot look at", volume);
    std::vector<fs::path> files{stamp.volume_};
    const bool isFolder = fs::is_directory(volume, error);
    if (isFolder) {
        auto found = filesBelow(stamp.volume_);
        if (!found.isOk())
            return std::move(found).error();
        files = std::move(found).value();
    }
    for (const fs::path& file : dataFiles)
        files.push_back(fs::absolute(file, error).lexically_normal());
    stamp.root_ = isFolder ? stamp.volume_ : stamp.volume_.parent_path();
    for (const fs::path& file : files) {
        auto one = stampOf(file, file.lexically_relative(stamp.root_));
        if (!one.isOk())
            return std::move(one).error();
        stamp.files_.push_back(std::move(one).value());
    }
    return stamp;
}

bool VolumeStamp::looksLike(const VolumeStamp& other) const {
    return std::equal(files_.begin(), files_.end(), other.files_.begin(), other.files_.end(),
                      [](const FileStamp& a, const FileStamp& b) {
                          return a.path == b.path && isUntouched(a, b) && a.isSettled && b.isSettled;
                      });
}

bool VolumeStamp::couldBe(const VolumeStamp& other) const {
    return std::equal(files_.begin(), files_.end(), other.files_.begin(), other.files_.end(),
                      [](const FileStamp& a, const FileStamp& b) { return a.path == b.path && a.size == b.size; });
}

Status VolumeStamp::hash(const JobControl& job) {
    for (std::size_t i = 0; i < files_.size(); ++i) {
        FileStamp& file = files_[i];
        const double share = 1.0 / static_cast<double>(files_.size());
        const auto found = hashFile(root_ / file.path,
                                    job.part(static_cast<double>(i) * share, static_cast<double>(i + 1) * share));
        if (!found.isOk())
            return found.error();
        const auto after = stampOf(root_ / file.path, file.path);
        if (!after.isOk())
            return after.error();
        if (!isUntouched(after.value(), file))
            return makeError(ErrorCode::InvalidArgument, "changed while it was read", root_ / file.path);
        file.hash = found.value();
    }
    return {};
}

bool VolumeStamp::hasContentOf(const VolumeStamp& other) const {
    return std::equal(files_.begin(), files_.end(), other.files_.begin(), other.files_.end(),
                      [](const FileStamp& a, const FileStamp& b) {
                          return a.path == b.path && a.size == b.size && a.hash == b.hash;
                      });
}

std::string VolumeStamp::toText() const {
    nlohmann::json files = nlohmann::json::array();
    for (const FileStamp& file : files_)
        files.push_back({{"path", bytesText(file.path.native())},
                         {"size", file.size},
                         {"modified", file.modified},
                         {"changed", file.changed},
                         {"settled", file.isSettled},
                         {"xxh3", file.hash}});
    return nlohmann::json{{"version", 1}, {"volume", bytesText(volume_.native())}, {"files", files}}.dump(1) + "\n";
}

std::optional<VolumeStamp> VolumeStamp::fromText(const std::string& text) {
    const auto json = nlohmann::json::parse(text, nullptr, false);
    if (!json.is_object() || json.value("version", nlohmann::json()) != 1)
        return std::nullopt;
    try { // whatever is not there or of another kind
        VolumeStamp stamp;
        const auto volume = bytesFromText(json.at("volume").get<std::string>());
        if (!volume)
            return std::nullopt;
        stamp.volume_ = *volume;
        for (const auto& file : json.at("files")) {
            const auto path = bytesFromText(file.at("path").get<std::string>());
            if (!path)
                return std::nullopt;
            stamp.files_.push_back({*path, file.at("size").get<std::uint64_t>(), file.at("modified").get<std::int64_t>(),
                                    file.at("changed").get<std::int64_t>(), file.at("settled").get<bool>(),
                                    file.at("xxh3").get<std::uint64_t>()});
        }
        return stamp;
    } catch (const nlohmann::json::exception&) {
        return std::nullopt;
    }
}

} // namespace isoslider::model
