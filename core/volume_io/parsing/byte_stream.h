#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "core/base/file_system.h"
#include "core/volume_io/parsing/byte_decoder.h"

namespace isoslider::io {

/// The bytes of a volume's samples, wherever they lie. One thread at a time.
class ByteStream {
public:
    virtual ~ByteStream() = default;
    virtual std::uint64_t sizeBytes() const = 0;
    /// Fills `out` from `offset` on. REQUIRES: the range lies within sizeBytes().
    virtual Status readAt(std::uint64_t offset, std::span<std::byte> out) = 0;
};

/// Part of a file that holds samples as they are.
struct FilePart {
    std::filesystem::path path;
    std::uint64_t offset = 0;
};

/// Parts of `partBytes` each, one after the other. Each file's size is checked here and again, by
/// the read, when it is used. Errors: NotFound, Corruption (a file is too short), IoError.
Result<std::unique_ptr<ByteStream>> openParts(std::vector<FilePart> parts, std::uint64_t partBytes);

/// How each of several parts is to be decoded.
struct Encoded {
    Encoding encoding = Encoding::Plain;
    FileType textType = FileType::U8; ///< of the samples, if they are text
    std::uint64_t skipBytes = 0; ///< decoded bytes of each part that are no samples and come first
    bool allowsTrailing = false; ///< a part may decode to more; then its checksum is not verified
    /// So many of the first bytes, one plane perhaps, are decoded before opening succeeds: a small packed
    /// file must not make its reader take the memory that its header asks for.
    std::uint64_t probeBytes = 0;
};

/// Parts that decode to `partBytes` each, one after the other; decoded as they are read: see openDeflated.
Result<std::unique_ptr<ByteStream>> openEncoded(std::vector<FilePart> parts, std::uint64_t partBytes, Encoded how);

/// A part of every `strideBytes`: what is left of an array when one of its axes is held.
struct Runs {
    std::uint64_t firstByte = 0;
    std::uint64_t runBytes = 0;
    std::uint64_t strideBytes = 0;
};

/// REQUIRES: runs lie within their stride, and strides fill `bytes`.
std::unique_ptr<ByteStream> takeRuns(std::unique_ptr<ByteStream> bytes, const Runs& runs);

/// A gzip or zlib stream that starts at `offset` of a file and must unpack to exactly
/// `skipBytes + sizeBytes` bytes, of which the first `skipBytes` are no samples. Unpacks as it is
/// read: ascending offsets cost one pass, going back starts again. Holds no more than a buffer.
/// The end of the stream and its checksum are verified when the last byte is read. Errors here and
/// in reading: Corruption, IoError.
Result<std::unique_ptr<ByteStream>> openDeflated(const std::filesystem::path& path, std::uint64_t offset,
                                                 std::uint64_t skipBytes, std::uint64_t sizeBytes);

/// The first bytes of a gzip file, unpacked; fewer than `maxBytes` where it ends.
Result<std::vector<std::byte>> inflateStart(const std::filesystem::path& path, std::size_t maxBytes);

} // namespace isoslider::io
