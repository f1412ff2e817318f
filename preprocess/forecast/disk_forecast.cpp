#include "preprocess/forecast/disk_forecast.h"

#include <string>

namespace isoslider::preprocess {
namespace {

std::string mebibytes(std::uint64_t bytes) {
    constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;
    return bytes < kMebibyte ? std::to_string(bytes) + " bytes" : std::to_string(bytes / kMebibyte) + " MiB";
}

Error noRoom(const std::string& what, std::uint64_t needed, std::uint64_t free, const std::filesystem::path& folder) {
    return makeError(ErrorCode::OutOfSpace,
                     "not enough free space: " + what + " about " + mebibytes(needed) + ", " + mebibytes(free) +
                         (free == 1 ? " is free" : " are free"),
                     folder.empty() ? std::string(".") : folder.string());
}

std::uint64_t spread(std::uint64_t value) {
    value = (value + 1) * 0x9e3779b97f4a7c15u;
    value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9u;
    return value ^ value >> 31;
}

} // namespace

Status checkRoom(const DiskForecast& needed, const std::filesystem::path& indexPath,
                 const std::filesystem::path& temporaryPath, FileSystem& fileSystem) {
    const auto target = linkTarget(indexPath);
    const std::filesystem::path folder = (target.isOk() ? target.value() : indexPath).parent_path();
    const std::filesystem::path temporaryFolder = temporaryPath.parent_path();
    const auto room = fileSystem.space(folder), temporaryRoom = fileSystem.space(temporaryFolder);
    const bool isShared =
        room.isOk() && temporaryRoom.isOk() && room.value().fileSystemId == temporaryRoom.value().fileSystemId;
    // Temporary files are gone when the topology comes.
    const std::uint64_t temporary = isShared ? needed.temporaryBytes : 0;
    const std::uint64_t atOnce = needed.indexBytes + std::max(temporary, needed.topologyBytes);
    if (room.isOk() && atOnce > room.value().freeBytes)
        return noRoom(atOnce == needed.indexBytes        ? "the index needs"
                      : temporary > needed.topologyBytes ? "index and temporary files need"
                                                         : "the index and its topology need",
                      atOnce, room.value().freeBytes, folder);
    if (!isShared && temporaryRoom.isOk() && needed.temporaryBytes > temporaryRoom.value().freeBytes)
        return noRoom("temporary files need", needed.temporaryBytes, temporaryRoom.value().freeBytes, temporaryFolder);
    return {};
}

std::uint64_t SpreadSample::at(std::uint64_t run, std::uint64_t variation) const {
    const auto begin = [this](std::uint64_t i) { return total_ / count_ * i + total_ % count_ * i / count_; };
    return begin(run) + spread(run + (variation << 32)) % (begin(run + 1) - begin(run));
}

} // namespace isoslider::preprocess
