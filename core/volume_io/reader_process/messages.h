#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/byte_codec.h"
#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"

// What the program and its reader process state to each other. Either end takes the other's words with care:
// nothing is believed that has not been checked against a bound.

namespace isoslider::io {

enum class RequestKind : std::uint8_t { Open, List, Prepare, ReadSlab };

/// One request of the program. `path` and `options` are there with Open and List, the planes with ReadSlab.
struct ReaderRequest {
    RequestKind kind = RequestKind::Open;
    std::string path;
    ReadOptions options;
    std::int64_t zBegin = 0;
    std::int64_t zEnd = 0;
};

/// Answers: any number of Progress, then Failed, or what was asked for. After Slab follow the samples.
enum class ReplyKind : std::uint8_t { Progress, Failed, Info, Contents, Slab };

/// Longest message. A series of 65536 slices is listed in less.
inline constexpr std::size_t kMaxMessageBytes = std::size_t{16} << 20;

std::vector<std::byte> encodeRequest(const ReaderRequest& request);
std::optional<ReaderRequest> decodeRequest(std::span<const std::byte> bytes);

struct ReaderProgress {
    double fraction = 0.0;
    std::string stage;
};

std::vector<std::byte> encodeProgress(double fraction, std::string_view stage);
std::vector<std::byte> encodeError(const Error& error);
std::vector<std::byte> encodeInfo(const VolumeInfo& info);
std::vector<std::byte> encodeContents(const VolumeContents& contents);
std::vector<std::byte> encodeSlab();

/// The first byte of an answer; none of an empty one or an unknown kind.
std::optional<ReplyKind> replyKind(std::span<const std::byte> bytes);
/// Of a whole answer of that kind. None: it is not well formed, or states what no reader may state: dims, spacing
/// and directions are those that a header may have.
std::optional<ReaderProgress> decodeProgress(std::span<const std::byte> bytes);
std::optional<Error> decodeError(std::span<const std::byte> bytes);
std::optional<VolumeInfo> decodeInfo(std::span<const std::byte> bytes);
std::optional<VolumeContents> decodeContents(std::span<const std::byte> bytes);

} // namespace isoslider::io
