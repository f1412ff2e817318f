#include "ui/model/session/volume_stamp.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/content_hash.h"
#include "core/base/file_stamp.h"
#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "ui/model/path_text.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

Result<StampedFile> stampOf(const fs::path& file, const fs::path& name) {
    const auto stamp = stampFile(file);
    if (!stamp.isOk())
        return stamp.error();
    return StampedFile{name, stamp.value()};
}

} // namespace

Result<VolumeStamp> VolumeStamp::of(const fs::path& volume, const std::vector<fs::path>& dataFiles) {
    std::error_code error;
    VolumeStamp stamp;
    stamp.volume_ = fs::absolute(volume, error).lexically_normal();
    if (error)
        return systemError(error.value(), "cannot look at", volume);
    std::vector<fs::path> files{stamp.volume_};
    const bool isSeries = isFolder(volume);
    if (isSeries) {
        auto found = filesBelow(stamp.volume_);
        if (!found.isOk())
            return std::move(found).error();
        files = std::move(found).value();
    }
    for (const fs::path& file : dataFiles)
        if (!isSeries) // whose files are all there already
            files.push_back(fs::absolute(file, error).lexically_normal());
    stamp.root_ = isSeries ? stamp.volume_ : stamp.volume_.parent_path();
    for (const fs::path& file : files) {
        auto one = stampOf(file, file.lexically_relative(stamp.root_));
        if (!one.isOk())
            return std::move(one).error();
        stamp.files_.push_back(std::move(one).value());
    }
    return stamp;
}

std::vector<fs::path> VolumeStamp::files() const {
    std::vector<fs::path> files;
    for (const StampedFile& file : files_)
        files.push_back(root_ / file.path);
    return files;
}

bool VolumeStamp::looksLike(const VolumeStamp& other) const {
    return std::equal(files_.begin(), files_.end(), other.files_.begin(), other.files_.end(),
                      [](const StampedFile& a, const StampedFile& b) {
                          return a.path == b.path && isUntouched(a.stamp, b.stamp) && a.stamp.isSettled &&
                                 b.stamp.isSettled;
                      });
}

bool VolumeStamp::couldBe(const VolumeStamp& other) const {
    return std::equal(
        files_.begin(), files_.end(), other.files_.begin(), other.files_.end(),
        [](const StampedFile& a, const StampedFile& b) { return a.path == b.path && a.stamp.size == b.stamp.size; });
}

Status VolumeStamp::hash(const JobControl& job) {
    for (std::size_t i = 0; i < files_.size(); ++i) {
        StampedFile& file = files_[i];
        const double share = 1.0 / static_cast<double>(files_.size());
        const auto found =
            hashFile(root_ / file.path, job.part(static_cast<double>(i) * share, static_cast<double>(i + 1) * share));
        if (!found.isOk())
            return found.error();
        const auto after = stampOf(root_ / file.path, file.path);
        if (!after.isOk())
            return after.error();
        if (!isUntouched(after.value().stamp, file.stamp))
            return makeError(ErrorCode::InvalidArgument, "changed while it was read", root_ / file.path);
        file.hash = found.value();
    }
    return {};
}

bool VolumeStamp::hasContentOf(const VolumeStamp& other) const {
    return std::equal(files_.begin(), files_.end(), other.files_.begin(), other.files_.end(),
                      [](const StampedFile& a, const StampedFile& b) {
                          return a.path == b.path && a.stamp.size == b.stamp.size && a.hash == b.hash;
                      });
}

std::string VolumeStamp::toText() const {
    nlohmann::json files = nlohmann::json::array();
    for (const StampedFile& file : files_)
        files.push_back({{"path", bytesText(file.path.native())},
                         {"size", file.stamp.size},
                         {"modified", file.stamp.modified},
                         {"changed", file.stamp.changed},
                         {"settled", file.stamp.isSettled},
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
            const FileStamp found{file.at("size").get<std::uint64_t>(), file.at("modified").get<std::int64_t>(),
                                  file.at("changed").get<std::int64_t>(), file.at("settled").get<bool>()};
            stamp.files_.push_back({*path, found, file.at("xxh3").get<std::uint64_t>()});
        }
        return stamp;
    } catch (const nlohmann::json::exception&) {
        return std::nullopt;
    }
}

} // namespace isoslider::model
