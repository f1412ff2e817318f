#include "preprocess/resume/build_checkpoints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/base/byte_codec.h"
#include "core/base/content_hash.h"
#include "core/base/folders.h"
#include "core/index/format/index_format.h"
#include "preprocess/index_builds.h"

namespace isoslider::preprocess {
namespace {

constexpr std::string_view kMagic = "ISORESUM";
constexpr std::uint32_t kVersion = 2; ///< of all that is in a checkpoint; any change of a state makes another one
constexpr std::size_t kMaxTextBytes = 1u << 16;
constexpr double kTimesAsLong = 50.0; // between checkpoints as one takes

std::filesystem::path targetOf(const std::filesystem::path& indexPath) {
    const auto target = linkTarget(indexPath);
    return target.isOk() ? target.value() : indexPath;
}

std::uint64_t checksumOf(std::span<const std::byte> bytes) {
    ContentHash hash;
    hash.add(bytes);
    return hash.value();
}

} // namespace

std::string checkpointVersion() {
    return std::string(ISOSLIDER_VERSION) + " " + std::to_string(kVersion) + " " + std::to_string(index::kFormatMajor) +
           "." + std::to_string(index::kFormatMinor);
}

Status writeChecked(const std::filesystem::path& path, std::string_view magic, const std::vector<std::byte>& body,
                    FileSystem& fileSystem) {
    std::vector<std::byte> head;
    ByteWriter out(head);
    out.putBytes(std::as_bytes(std::span(magic)));
    out.put<std::uint64_t>(checksumOf(body));
    auto file = AtomicFile::create(path, fileSystem);
    if (!file.isOk())
        return std::move(file).error();
    ISO_TRY(file.value()->writeAll(head));
    ISO_TRY(file.value()->writeAll(body));
    return file.value()->publish();
}

std::optional<std::span<const std::byte>> checkedBody(std::span<const std::byte> bytes, std::string_view magic) {
    ByteReader in(bytes);
    const auto start = in.getBytes(magic.size());
    const auto checksum = in.get<std::uint64_t>();
    if (in.hasFailed() || !std::equal(start.begin(), start.end(), std::as_bytes(std::span(magic)).begin()))
        return std::nullopt;
    const auto body = bytes.last(in.remaining());
    return checksum == checksumOf(body) ? std::optional(body) : std::nullopt;
}

std::filesystem::path checkpointPath(const std::filesystem::path& indexPath) {
    std::filesystem::path path = targetOf(indexPath);
    path += ".resume";
    return path;
}

bool hasCheckpoint(const std::filesystem::path& indexPath) { return isPresent(checkpointPath(indexPath)); }

BuildIdentity BuildIdentity::of(const io::VolumeSource& source, const BuildOptions& options) {
    const GridGeometry& geometry = source.info().geometry;
    std::ostringstream input, parameters;
    input.precision(17);
    parameters.precision(17);
    for (const std::int64_t dim : geometry.dims)
        input << dim << ' ';
    for (int a = 0; a < 3; ++a) {
        input << geometry.spacing[a] << ' ' << geometry.origin[a] << ' ';
        for (int b = 0; b < 3; ++b)
            input << geometry.direction[a][b] << ' ';
    }
    input << scalarTypeName(source.info().type) << ' ' << source.info().lengthUnit << ' ' << source.info().fieldName
          << ' ' << source.filesDigest();
    parameters << index::indexKindName(options.kind) << ' ' << options.mergeError.amount << ' '
               << static_cast<int>(options.mergeError.measure) << ' ' << options.skipLevels << ' '
               << options.redundancyThreshold << ' ' << options.sourceName;
    return {input.str(), parameters.str()};
}

BuildCheckpoints::BuildCheckpoints(const std::filesystem::path& indexPath, BuildIdentity identity,
                                   const BuildOptions& options)
    : path_(checkpointPath(indexPath)),
      saving_(partialPath(path_)),
      partial_(partialPath(targetOf(indexPath))),
      spill_(spillPathOf(indexPath, options)),
      identity_(std::move(identity)),
      fileSystem_(options.fileSystem ? *options.fileSystem : defaultFileSystem()),
      resumes_(options.resumes),
      replacesUnfit_(options.replacesUnfit),
      interval_(options.checkpointSeconds),
      next_(std::chrono::steady_clock::now() +
            std::chrono::duration_cast<std::chrono::steady_clock::duration>(interval_)) {}

BuildCheckpoints::~BuildCheckpoints() {
    if (isOwner_ && (isFinished_ || !resumes_)) {
        (void)fileSystem_.removeFile(path_);
        (void)fileSystem_.removeFile(saving_);
    }
}

void BuildCheckpoints::own(bool goesOn) {
    isOwner_ = true;
    if (goesOn)
        return;
    (void)fileSystem_.removeFile(path_);
    (void)fileSystem_.removeFile(spill_); // this build may sort in memory, or nothing
}

Result<std::optional<std::vector<std::byte>>> BuildCheckpoints::load() const {
    const auto none = [] { return std::optional<std::vector<std::byte>>(); };
    if (!resumes_)
        return none();
    const auto read = readWholeFile(path_, std::numeric_limits<std::uint64_t>::max(), fileSystem_);
    if (!read.isOk())
        return read.error().code == ErrorCode::NotFound ? none()
                                                        : Result<std::optional<std::vector<std::byte>>>(read.error());
    const std::vector<std::byte>& bytes = read.value();
    const auto body = checkedBody(bytes, kMagic);
    if (!body) // one that is not whole is none: the build starts again
        return none();
    ByteReader in(*body);
    const auto refuse = [&](const char* what) -> Result<std::optional<std::vector<std::byte>>> {
        if (replacesUnfit_)
            return none();
        return makeError(ErrorCode::InvalidArgument,
                         std::string("the unfinished build ") + what + "; build without --resume to start again",
                         path_.string());
    };
    if (in.getString(kMaxTextBytes) != checkpointVersion())
        return refuse("was begun by another version of the program");
    if (in.getString(kMaxTextBytes) != identity_.input)
        return refuse("is of another volume, or the volume has changed since");
    if (in.getString(kMaxTextBytes) != identity_.parameters)
        return refuse("was begun with other options");
    // A build that starts again empties the partial file before it removes the checkpoint, and a complete one renames
    // it.
    const std::uint64_t indexBytes = in.get<std::uint64_t>();
    const auto partial = fileSystem_.openForReading(partial_);
    if (!partial.isOk() || partial.value()->sizeBytes() < indexBytes)
        return none();
    return std::optional(
        std::vector<std::byte>(bytes.end() - static_cast<std::ptrdiff_t>(in.remaining()), bytes.end()));
}

bool BuildCheckpoints::isDue() const { return interval_.count() >= 0.0 && std::chrono::steady_clock::now() >= next_; }

Status BuildCheckpoints::save(const std::vector<std::byte>& state, std::uint64_t indexBytes,
                              std::chrono::steady_clock::time_point begin) {
    std::vector<std::byte> body;
    ByteWriter out(body);
    out.putString(checkpointVersion());
    out.putString(identity_.input);
    out.putString(identity_.parameters);
    out.put<std::uint64_t>(indexBytes);
    out.putBytes(state);
    ISO_TRY(writeChecked(path_, kMagic, body, fileSystem_));
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> took = now - begin;
    next_ = now + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                      interval_.count() > 0.0 ? std::max(interval_, kTimesAsLong * took) : interval_);
    return {};
}

} // namespace isoslider::preprocess
