#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/file_system.h"
#include "core/volume_io/sources/sample_source.h"

namespace isoslider::io {

/// One image of a TIFF file, as its directory describes it.
struct TiffPage {
    std::uint64_t directory = 0; ///< offset in the file
    std::int64_t columns = 0;
    std::int64_t rows = 0;
    FileType type = FileType::U8;
    int components = 1; ///< values per sample
    bool isPlanar = false;
    int photometric = 0;
    std::int64_t depth = 1; ///< slices, one after the other at `offset`: tag 32997 of SGI
    bool isBits = false; ///< eight samples of u8 in a byte of the file
    std::uint64_t offset = 0; ///< of the first strip or tile

    std::uint64_t sizeBytes() const {
        return static_cast<std::uint64_t>(columns * rows * components) * fileTypeSizeBytes(type);
    }
    bool isLike(const TiffPage& other) const {
        return columns == other.columns && rows == other.rows && depth == other.depth && type == other.type &&
               components == other.components && photometric == other.photometric;
    }
    std::string description() const; ///< "640 x 480 of 3 x uint8"
};

/// A TIFF or BigTIFF file, read by libtiff through the file layer; what libtiff complains of is kept. One
/// thread at a time.
class TiffFile {
public:
    /// Reads and checks all directories: that samples are of a kind that is read, and lie within the file.
    /// Reduced images and masks are left out. Errors: InvalidArgument, Corruption, IoError.
    static Result<std::unique_ptr<TiffFile>> open(const std::filesystem::path& path);
    ~TiffFile();
    TiffFile(const TiffFile&) = delete;
    TiffFile& operator=(const TiffFile&) = delete;

    const std::vector<TiffPage>& pages() const { return pages_; }
    /// The description in the first directory, 1 MiB of it at most.
    const std::string& imageDescription() const { return imageDescription_; }
    /// Resolution of the first directory, in samples per unit; 0 if it has none.
    double resolution(int axis) const { return resolution_[axis]; }
    std::size_t pagesLeftOut() const { return pagesLeftOut_; }
    /// There is one page, whose samples lie in the file as they are.
    bool isPlain() const { return isPlain_; }
    bool isBigEndian() const;
    const RandomAccessFile& bytes() const;

    /// All samples of a page in the machine's byte order, components beside each other.
    /// REQUIRES: samples.size() == pages()[page].sizeBytes(). Errors: Corruption, IoError.
    Status readPage(std::size_t page, std::span<std::byte> samples);

private:
    struct Handle;
    explicit TiffFile(std::unique_ptr<Handle> handle);
    Status readDirectories();
    Result<TiffPage> readDirectory();
    Status checkStrips(const TiffPage& page) const;
    bool arePlainStrips(const TiffPage& page) const; ///< whose samples follow each other uncompressed, of all slices
    Status readStrips(const TiffPage& page, std::span<std::byte> samples);
    Status readBits(const TiffPage& page, std::span<std::byte> samples);
    Status readTiles(const TiffPage& page, std::span<std::byte> samples);
    Error complaint(const std::string& what) const;

    std::unique_ptr<Handle> handle_;
    std::vector<TiffPage> pages_;
    std::string imageDescription_;
    double resolution_[2] = {0.0, 0.0};
    std::size_t pagesLeftOut_ = 0;
    bool isPlain_ = false;
};

} // namespace isoslider::io
