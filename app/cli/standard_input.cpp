#include "app/cli/standard_input.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/cli/number_parsing.h"
#include "app/cli/progress_bar.h"
#include "app/cli/standard_streams.h"
#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/index/format/index_format.h"
#include "core/volume_io/formats/format_readers.h"

namespace isoslider::cli {
namespace fs = std::filesystem;
namespace {

constexpr char kInputName[] = "standard input";
constexpr std::size_t kInputBlockBytes = std::size_t{1} << 20;
constexpr std::size_t kStartBytes = std::size_t{1} << 16; // every format is known by fewer
constexpr std::uint64_t kNoEnd = std::numeric_limits<std::uint64_t>::max();

/// Formats whose volume lies in one file.
constexpr std::string_view kVolumeFormats[] = {"mha", "nrrd",   "nii",  "nii.gz",  "vti", "vtr", "vts", "vtu", "vtk",
                                               "mrc", "mrc.gz", "cube", "cube.gz", "dcm", "tif", "nc",  "h5"};
constexpr std::string_view kMeshFormats[] = {"ply", "obj", "stl", "off", "om"};

std::span<const std::string_view> formatsOf(InputContent content) {
    if (content == InputContent::Mesh)
        return kMeshFormats;
    return content == InputContent::Index ? std::span<const std::string_view>() : kVolumeFormats;
}

bool beginsWith(std::span<const std::byte> start, std::string_view magic) {
    return start.size() >= magic.size() && std::memcmp(start.data(), magic.data(), magic.size()) == 0;
}

bool isIndex(std::span<const std::byte> start) {
    return start.size() >= sizeof(index::kIndexMagic) &&
           std::memcmp(start.data(), index::kIndexMagic, sizeof(index::kIndexMagic)) == 0;
}

// Readers of meshes go by the suffix. No text holds a zero, and every binary STL does: the last byte of its count.
std::string_view meshFormatOf(std::span<const std::byte> start) {
    if (beginsWith(start, "ply"))
        return "ply";
    if (beginsWith(start, "OFF") || beginsWith(start, "NOFF") || beginsWith(start, "COFF"))
        return "off";
    if (beginsWith(start, "OM"))
        return "om";
    const bool isText = std::find(start.begin(), start.end(), std::byte{0}) == start.end();
    return beginsWith(start, "solid") || !isText ? "stl" : "obj";
}

// What is packed does not show its format; most such volumes are of NIfTI.
std::string_view volumeFormatOf(std::span<const std::byte> start) {
    return beginsWith(start, "\x1f\x8b") ? "nii.gz" : "";
}

/// One more byte than the samples take, so that a longer input is seen to be so.
std::uint64_t mostBytes(const io::ReadOptions& options) {
    if (!options.raw)
        return kNoEnd;
    std::uint64_t bytes = scalarTypeSizeBytes(options.raw->type);
    for (const std::int64_t size : options.raw->dims)
        if (size <= 0 || __builtin_mul_overflow(bytes, static_cast<std::uint64_t>(size), &bytes))
            return 1; // the reader refuses such dims, whatever follows
    if (__builtin_add_overflow(bytes, options.raw->skipBytes, &bytes) || bytes == kNoEnd)
        return 1;
    return bytes + (options.allowsTrailing ? 0 : 1);
}

Error noRoom(const std::string& what, const fs::path& folder, bool isTemporaryFolder) {
    const char* hint = isTemporaryFolder ? "; TMPDIR names another folder" : "";
    return makeError(ErrorCode::OutOfSpace, fmt::format("{} in {}{}", what, folder.string(), hint), kInputName);
}

/// Only a file states beforehand how long it is.
Status checkRoom(const fs::path& folder, std::uint64_t most) {
    const auto left = inputBytesLeft();
    const auto room = defaultFileSystem().space(folder);
    const std::uint64_t needed = std::min(left.value_or(0), most);
    if (!room.isOk() || needed <= room.value().freeBytes)
        return {};
    return noRoom(
        fmt::format("needs {} while it is read, and {} are free", sizeText(needed), sizeText(room.value().freeBytes)),
        folder, folder == temporaryFolder());
}

} // namespace

void StandardInput::declare(CLI::App& command, std::string& path, InputContent content) {
    path_ = &path;
    content_ = content;
    const auto known = formatsOf(content);
    if (known.empty())
        return;
    const std::string names = fmt::format("{}", fmt::join(known, ", "));
    command
        .add_option_function<std::string>(
            "--input-format",
            [this, known, names](const std::string& text) {
                if (std::find(known.begin(), known.end(), text) == known.end())
                    throw CLI::ValidationError("--input-format",
                                               fmt::format("'{}' is not a format; known: {}", text, names));
                format_ = text;
            },
            "what standard input (-) is, where its first bytes do not state it: " + names)
        ->type_name("FORMAT");
}

Outcome StandardInput::fetch(Session& session) { return fetch(session, {}, temporaryFolder()); }

Outcome StandardInput::fetch(Session& session, const VolumeOptions& volume, const fs::path& parent) {
    if (*path_ != "-")
        return format_.empty() ? Outcome()
                               : Outcome::wrongUsage("--input-format is for standard input (-); a file's name and "
                                                     "content state its format");
    if (isInputTerminal())
        return Outcome::wrongUsage("standard input is a terminal; redirect a file or a pipe to it");
    ProgressBar bar(session.showsProgress, session.stop);
    const Status copied = copy(parent, volume.readOptions(), bar.job());
    bar.wipe();
    // Also for failures later on: the folder is nobody's business.
    if (!folder_.path().empty()) {
        session.shownNames.emplace_back((folder_.path() / kInputName).string() + suffix_, kInputName);
        session.shownNames.emplace_back((folder_.path() / "").string(), "");
    }
    return copied.isOk() ? Outcome() : Outcome(copied.error());
}

Status StandardInput::copy(const fs::path& parent, const io::ReadOptions& options, const JobControl& job) {
    const fs::path folder = parent.empty() ? fs::path(".") : parent;
    const std::uint64_t most = mostBytes(options);
    ISO_TRY(checkRoom(folder, most));
    ISO_TRY(folder_.make(folder, "isoslider-input"));
    std::vector<std::byte> block(static_cast<std::size_t>(std::min<std::uint64_t>(most, kInputBlockBytes)));
    const auto start = std::span(block).first(std::min(block.size(), kStartBytes));
    auto got = readInput(start, job.stop);
    if (!got.isOk())
        return std::move(got).error();
    const auto head = start.first(got.value());
    if (head.empty() && !options.raw) // what should have written it may have failed
        return makeError(ErrorCode::InvalidArgument, "is empty", kInputName);
    std::string format = format_;
    if (format.empty() && !options.raw && !isIndex(head))
        format = content_ == InputContent::Mesh ? meshFormatOf(head) : volumeFormatOf(head);
    suffix_ = format.empty() ? "" : "." + format;
    *path_ = (folder_.path() / (kInputName + suffix_)).string();
    const auto file = defaultFileSystem().create(*path_);
    if (!file.isOk())
        return file.error();
    const double whole = static_cast<double>(head.size() + inputBytesLeft().value_or(0));
    for (std::span<const std::byte> bytes = head; !bytes.empty();) {
        if (const Status written = file.value()->writeAll(bytes); !written.isOk())
            return written.error().code == ErrorCode::OutOfSpace
                       ? noRoom(
                             fmt::format("does not fit: {} have been read, and nothing more is free", sizeText(bytes_)),
                             folder, folder == temporaryFolder())
                       : written;
        if (bytes_ == 0)
            ISO_TRY(checkStart(options, head));
        bytes_ += bytes.size();
        job.report(whole > static_cast<double>(head.size()) ? static_cast<double>(bytes_) / whole : 0.0,
                   fmt::format("reading standard input, {}", sizeText(bytes_)));
        const auto next = std::span(block).first(std::min<std::uint64_t>(block.size(), most - bytes_));
        got = readInput(next, job.stop);
        if (!got.isOk())
            return std::move(got).error();
        bytes = next.first(got.value());
    }
    return file.value()->close();
}

// Before the rest is read, which may be long or without end.
Status StandardInput::checkStart(const io::ReadOptions& options, std::span<const std::byte> start) const {
    if (content_ == InputContent::Mesh || options.raw)
        return {};
    if (isIndex(start)) {
        if (content_ == InputContent::Volume)
            return makeError(ErrorCode::InvalidArgument,
                             "is an index; this command reads one from its file, and only volumes from here",
                             kInputName);
        return {};
    }
    if (content_ == InputContent::Index)
        return makeError(ErrorCode::InvalidArgument, "is not an ISOSLIDER index", kInputName);
    const auto format = io::findFormat(*path_);
    if (format.isOk())
        return {};
    Error error = format.error();
    error.message += ", other formats --input-format";
    return error;
}

} // namespace isoslider::cli
