#include "preprocess/resume/completed_build.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/base/byte_codec.h"
#include "core/base/content_hash.h"
#include "core/base/state_archive.h"
#include "core/index/index_reader.h"
#include "preprocess/index_builds.h"

namespace isoslider::preprocess {
namespace {

constexpr std::string_view kBuiltMagic = "ISOBUILT";
constexpr std::uint64_t kMostBytes = 1u << 20;
constexpr std::size_t kMostTextBytes = 1u << 16;
constexpr std::uint64_t kEndBytes = 1u << 16;

// Of the first and the last of so many bytes: where an index states what it is. What is appended changes nothing of it.
std::optional<std::uint64_t> hashOfEnds(const RandomAccessFile& file, std::uint64_t bytes) {
    if (file.sizeBytes() < bytes)
        return std::nullopt;
    ContentHash hash;
    std::vector<std::byte> end(std::min(bytes, kEndBytes));
    for (const std::uint64_t offset : {std::uint64_t{0}, bytes - end.size()}) {
        if (!file.readExactlyAt(offset, end).isOk())
            return std::nullopt;
        hash.add(end);
    }
    return hash.value();
}

} // namespace

CompletedBuild::CompletedBuild(const std::filesystem::path& indexPath, BuildIdentity identity,
                               const BuildOptions& options)
    : index_(indexPath), identity_(std::move(identity)), fileSystem_(fileSystemOf(options)) {}

std::optional<BuildReport> CompletedBuild::find() const {
    const auto bytes = readWholeFile(checkpointPath(index_), kMostBytes, fileSystem_);
    if (!bytes.isOk())
        return std::nullopt;
    const auto body = checkedBody(bytes.value(), kBuiltMagic);
    if (!body)
        return std::nullopt;
    ByteReader in(*body);
    if (in.getString(kMostTextBytes) != checkpointVersion() || in.getString(kMostTextBytes) != identity_.input ||
        in.getString(kMostTextBytes) != identity_.parameters)
        return std::nullopt;
    const auto indexBytes = in.get<std::uint64_t>(), ends = in.get<std::uint64_t>();
    BuildReport report;
    StateArchive state(std::span(bytes.value()).last(in.remaining()));
    state(report.forecast);
    const auto file = fileSystem_.openForReading(index_);
    if (in.hasFailed() || state.hasFailed() || !file.isOk() || hashOfEnds(*file.value(), indexBytes) != ends)
        return std::nullopt;
    const auto reader = index::IndexReader::open(index_, fileSystem_);
    if (!reader.isOk())
        return std::nullopt;
    report.info = reader.value()->info();
    report.isResumed = true;
    return report;
}

void CompletedBuild::note(const BuildReport& report) const {
    const auto index = fileSystem_.openForReading(index_);
    const auto ends = index.isOk() ? hashOfEnds(*index.value(), report.info.indexBytes) : std::nullopt;
    if (!ends)
        return;
    DiskForecast forecast = report.forecast;
    StateArchive state;
    state(forecast);
    std::vector<std::byte> body;
    ByteWriter out(body);
    out.putString(checkpointVersion());
    out.putString(identity_.input);
    out.putString(identity_.parameters);
    out.put<std::uint64_t>(report.info.indexBytes);
    out.put<std::uint64_t>(*ends);
    out.putBytes(state.bytes());
    (void)writeChecked(checkpointPath(index_), kBuiltMagic, body, fileSystem_);
}

void forgetCompletedBuild(const std::filesystem::path& indexPath, FileSystem& fileSystem) {
    const std::filesystem::path path = checkpointPath(indexPath);
    const auto file = fileSystem.openForReading(path);
    std::string start(kBuiltMagic.size(), '\0');
    if (!file.isOk() || !file.value()->readExactlyAt(0, std::as_writable_bytes(std::span(start))).isOk())
        return;
    if (start == kBuiltMagic) // else it is the checkpoint of a build that another program has begun since
        (void)fileSystem.removeFile(path);
}

} // namespace isoslider::preprocess
