#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/file_system.h"
#include "core/volume_io/parsing/file_type.h"

namespace isoslider::io {

/// How the bytes of samples are written down in a file.
enum class Encoding {
    Plain,
    Deflate, ///< gzip or zlib; gzip files written one after the other unpack to all
    Bzip2, ///< likewise
    Hex, ///< two digits a byte, blanks between bytes
    Text, ///< numbers between blanks, each perhaps followed by a comma
};

/// Bytes made from those of a file, from one end to the other. One thread at a time.
class ByteDecoder {
public:
    virtual ~ByteDecoder() = default;
    /// Fills `out`: with fewer bytes only at the end. Errors: Corruption, InvalidArgument (a word that is no
    /// number), OutOfSpace, IoError.
    virtual Result<std::size_t> read(std::span<std::byte> out) = 0;
};

/// Decodes `file` from `offset` on and holds no more than a buffer. Text becomes samples of `textType` in the
/// byte order of this machine.
std::unique_ptr<ByteDecoder> makeDecoder(std::unique_ptr<RandomAccessFile> file, std::uint64_t offset,
                                         Encoding encoding, FileType textType = FileType::U8);

/// Fewest bytes in a file that may decode to `sizeBytes`.
std::uint64_t leastEncodedBytes(Encoding encoding, std::uint64_t sizeBytes, FileType textType);

/// Lines and words of decoded bytes.
class TextReader {
public:
    explicit TextReader(ByteDecoder& bytes) : bytes_(bytes) {}

    /// The next line without its end; at most kMaxHeaderLine bytes of it. False at the end or on an error.
    bool line(std::string& out);
    /// The next word between blanks; at most kMaxScannedWord + 1 bytes of it. False at the end or on an
    /// error.
    bool word(std::string& out);
    /// What ended the text before its time.
    const Status& status() const { return status_; }

private:
    bool fill();

    ByteDecoder& bytes_;
    std::string window_;
    std::size_t at_ = 0;
    Status status_;
};

/// A whole word as one number, rounded to nearest; `D` may stand for the exponent's `E`, and an exponent of
/// three digits may follow without either, as Fortran writes them. Numbers too small for double become zero.
std::optional<double> parseFortranReal(std::string_view word);

} // namespace isoslider::io
