#include "core/volume_io/formats/tiff/tiff_file.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include <tiffio.h>

#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxPages = 65536;
constexpr std::uint64_t kMaxTileBytes = std::uint64_t{16} << 20;
constexpr tmsize_t kMaxAllocation = tmsize_t{32} << 20; ///< by libtiff at once, besides the file's own size

/// Bytes of samples that one byte of the file can make at most: by the method where it has a bound, else well
/// above what a blank image of 16384 x 16384 comes to (CCITT group 4: 34,000 samples, zstd: 2,500).
std::uint64_t mostPerByte(int compression) {
    switch (compression) {
        case COMPRESSION_NONE: return 1;
        case COMPRESSION_PACKBITS: return 64;
        case COMPRESSION_DEFLATE:
        case COMPRESSION_ADOBE_DEFLATE: return 1032;
        case COMPRESSION_LZW: return 4096;
        case COMPRESSION_JPEG: return 4096;
        case COMPRESSION_LZMA: return 65536;
        default: return 100'000;
    }
}

} // namespace

std::string TiffPage::description() const {
    return std::to_string(columns) + " x " + std::to_string(rows) + " of " +
           (components > 1 ? std::to_string(components) + " x " : "") + std::string(fileTypeName(type));
}

/// libtiff's side: it reads through these functions and complains to them.
struct TiffFile::Handle {
    std::unique_ptr<RandomAccessFile> file;
    TIFF* tiff = nullptr;
    std::uint64_t position = 0;
    std::string complaint;
    bool hasFailed = false; ///< the system refused to read

    static tmsize_t read(thandle_t user, void* out, tmsize_t size) {
        auto* self = static_cast<Handle*>(user);
        const auto count = self->file->readAt(
            self->position, {static_cast<std::byte*>(out), static_cast<std::size_t>(std::max<tmsize_t>(size, 0))});
        self->hasFailed = self->hasFailed || !count.isOk();
        if (!count.isOk())
            return -1;
        self->position += count.value();
        return static_cast<tmsize_t>(count.value());
    }
    static tmsize_t write(thandle_t, void*, tmsize_t) { return -1; }
    static toff_t seek(thandle_t user, toff_t offset, int from) {
        auto* self = static_cast<Handle*>(user);
        const std::uint64_t base = from == SEEK_SET ? 0 : from == SEEK_CUR ? self->position : self->file->sizeBytes();
        self->position = base + offset;
        return self->position;
    }
    static int close(thandle_t) { return 0; }
    static toff_t size(thandle_t user) { return static_cast<Handle*>(user)->file->sizeBytes(); }
    static int map(thandle_t, void**, toff_t*) { return 0; }
    static void unmap(thandle_t, void*, toff_t) {}

    static int onError(TIFF*, void* user, const char*, const char* format, va_list arguments) {
        auto* self = static_cast<Handle*>(user);
        char text[300];
        std::vsnprintf(text, sizeof text, format, arguments);
        if (self->complaint.empty())
            self->complaint = text;
        return 1;
    }
    static int onWarning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

    ~Handle() {
        if (tiff != nullptr)
            TIFFClose(tiff);
    }
};

TiffFile::TiffFile(std::unique_ptr<Handle> handle) : handle_(std::move(handle)) {}
TiffFile::~TiffFile() = default;

bool TiffFile::isBigEndian() const { return TIFFIsBigEndian(handle_->tiff) != 0; }
const RandomAccessFile& TiffFile::bytes() const { return *handle_->file; }

Error TiffFile::complaint(const std::string& what) const {
    std::string text = handle_->complaint;
    std::replace_if(
        text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
    return makeError(handle_->hasFailed ? ErrorCode::IoError : ErrorCode::Corruption,
                     what + (text.empty() ? "" : ": " + text), handle_->file->path());
}

Result<std::unique_ptr<TiffFile>> TiffFile::open(const fs::path& path) {
    auto opened = defaultFileSystem().openForReading(path);
    if (!opened.isOk())
        return std::move(opened).error();
    auto handle = std::make_unique<Handle>();
    handle->file = std::move(opened).value();
    std::unique_ptr<TiffFile> file(new TiffFile(std::move(handle)));
    Handle& self = *file->handle_;
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetErrorHandlerExtR(options, Handle::onError, &self);
    TIFFOpenOptionsSetWarningHandlerExtR(options, Handle::onWarning, &self);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, kMaxAllocation + static_cast<tmsize_t>(self.file->sizeBytes()));
    self.tiff = TIFFClientOpenExt("TIFF", "rm", &self, Handle::read, Handle::write, Handle::seek, Handle::close,
                                  Handle::size, Handle::map, Handle::unmap, options);
    TIFFOpenOptionsFree(options);
    if (self.tiff == nullptr)
        return file->complaint("is not a TIFF file that can be read");
    ISO_TRY(file->readDirectories());
    return file;
}

Status TiffFile::readDirectories() {
    TIFF* tiff = handle_->tiff;
    const char* text = nullptr;
    if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text) == 1 && text != nullptr)
        imageDescription_ = std::string_view(text).substr(0, kMaxHeaderBytes);
    for (int axis = 0; axis < 2; ++axis) {
        float resolution = 0.0f;
        if (TIFFGetField(tiff, axis == 0 ? TIFFTAG_XRESOLUTION : TIFFTAG_YRESOLUTION, &resolution) == 1)
            resolution_[axis] = resolution;
    }
    do {
        std::uint32_t kind = 0;
        TIFFGetField(tiff, TIFFTAG_SUBFILETYPE, &kind);
        if ((kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) != 0) {
            ++pagesLeftOut_;
            continue;
        }
        if (pages_.size() == kMaxPages)
            return refuseField("pages", "more than " + std::to_string(kMaxPages), handle_->file->path());
        auto page = readDirectory();
        if (!page.isOk())
            return std::move(page).error();
        isPlain_ = pages_.empty() && arePlainStrips(page.value());
        pages_.push_back(page.value());
    } while (TIFFReadDirectory(tiff) == 1);
    const std::string next = "page " + std::to_string(pages_.size() + pagesLeftOut_ + 1);
    if (!handle_->complaint.empty())
        return complaint(next);
    if (TIFFLastDirectory(tiff) == 0)
        return complaint(next + ": the directories form a loop");
    if (pages_.empty())
        return refuseField("pages", "the file has none", handle_->file->path());
    return {};
}

Result<TiffPage> TiffFile::readDirectory() {
    TIFF* tiff = handle_->tiff;
    const fs::path& path = handle_->file->path();
    const std::string where = "page " + std::to_string(pages_.size() + 1);
    TiffPage page;
    page.directory = TIFFCurrentDirOffset(tiff);
    std::uint32_t columns = 0, rows = 0;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &columns);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &rows);
    const std::int64_t sizes[] = {columns, rows};
    if (const auto dims = checkDims(sizes, where, path); !dims.isOk())
        return dims.error();
    page.columns = columns;
    page.rows = rows;
    std::uint16_t bits = 1, format = SAMPLEFORMAT_UINT, components = 1, planar = PLANARCONFIG_CONTIG,
                  photometric = PHOTOMETRIC_MINISBLACK, compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &components);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &planar);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
    if (components < 1 || components > 64)
        return refuseField(where + ", samples per pixel", std::to_string(components) + " is not within 1..64", path);
    page.components = components;
    page.isPlanar = planar == PLANARCONFIG_SEPARATE && components > 1;
    page.photometric = photometric;
    struct Known {
        int bits, format;
        FileType type;
    };
    constexpr Known kTypes[] = {{8, SAMPLEFORMAT_UINT, FileType::U8},     {8, SAMPLEFORMAT_INT, FileType::I8},
                                {16, SAMPLEFORMAT_UINT, FileType::U16},   {16, SAMPLEFORMAT_INT, FileType::I16},
                                {32, SAMPLEFORMAT_UINT, FileType::U32},   {32, SAMPLEFORMAT_INT, FileType::I32},
                                {64, SAMPLEFORMAT_UINT, FileType::U64},   {64, SAMPLEFORMAT_INT, FileType::I64},
                                {32, SAMPLEFORMAT_IEEEFP, FileType::F32}, {64, SAMPLEFORMAT_IEEEFP, FileType::F64}};
    if (format == SAMPLEFORMAT_VOID)
        format = SAMPLEFORMAT_UINT;
    page.isBits = bits == 1 && components == 1 && TIFFIsTiled(tiff) == 0;
    if (page.isBits)
        bits = 8;
    const auto* known = std::find_if(std::begin(kTypes), std::end(kTypes),
                                     [&](const Known& type) { return type.bits == bits && type.format == format; });
    if (known == std::end(kTypes))
        return refuseField(where + ", bits per sample",
                           std::to_string(bits) + " bits of sample format " + std::to_string(format) +
                               " are no type of scalars that is read",
                           path);
    page.type = known->type;
    if (TIFFIsCODECConfigured(compression) == 0)
        return refuseField(where + ", compression", std::to_string(compression) + " is not read", path);
    if (photometric == PHOTOMETRIC_YCBCR && compression == COMPRESSION_JPEG)
        TIFFSetField(tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
    else if (photometric == PHOTOMETRIC_YCBCR || photometric == PHOTOMETRIC_LOGL || photometric == PHOTOMETRIC_LOGLUV)
        return refuseField(where + ", photometric interpretation",
                           std::to_string(photometric) + " is coded colour, which is not read", path);
    page.offset = TIFFGetStrileOffset(tiff, 0);
    std::uint32_t depth = 1;
    TIFFGetField(tiff, TIFFTAG_IMAGEDEPTH, &depth);
    page.depth = std::clamp<std::int64_t>(depth, 1, kMaxDim);
    ISO_TRY(checkStrips(page));
    // libtiff itself reads the first slice of these.
    if (page.depth > 1 && !arePlainStrips(page))
        return refuseField(
            where + ", image depth",
            std::to_string(depth) + " slices in one page are read only in uncompressed strips, all listed", path);
    return page;
}

// Before memory is taken: the strips or tiles lie in the file, and can hold the samples.
Status TiffFile::checkStrips(const TiffPage& page) const {
    TIFF* tiff = handle_->tiff;
    const std::uint64_t fileBytes = handle_->file->sizeBytes();
    const bool isTiled = TIFFIsTiled(tiff) != 0;
    const std::uint32_t count = isTiled ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
    const std::string where = "page " + std::to_string(pages_.size() + 1) + ", strips";
    const auto refuse = [&](const std::string& problem) {
        return makeError(ErrorCode::Corruption, where + ": " + problem, handle_->file->path(), page.directory);
    };
    if (count == 0 || count > fileBytes)
        return refuse(std::to_string(count) + " do not fit the file");
    std::uint64_t total = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint64_t begin = TIFFGetStrileOffset(tiff, i), size = TIFFGetStrileByteCount(tiff, i);
        if (begin == 0 || size == 0 || begin > fileBytes || size > fileBytes - begin)
            return makeError(ErrorCode::Corruption,
                             where + ": number " + std::to_string(i) + " has " + std::to_string(size) +
                                 " bytes, which do not lie within the " + std::to_string(fileBytes) + " of the file",
                             handle_->file->path(), begin);
        total += size;
    }
    std::uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    const std::uint64_t most = mostPerByte(compression) * (page.isBits ? 8 : 1);
    if (page.sizeBytes() / most > total)
        return refuse(page.description() + " need " + std::to_string(page.sizeBytes()) + " bytes, " +
                      std::to_string(total) + " in the file cannot hold them");
    const std::uint64_t part = isTiled ? TIFFTileSize64(tiff) : TIFFStripSize64(tiff);
    if (part == 0 || part > std::max(4 * page.sizeBytes(), kMaxTileBytes))
        return refuse("are of " + std::to_string(part) + " bytes each");
    return {};
}

bool TiffFile::arePlainStrips(const TiffPage& page) const {
    TIFF* tiff = handle_->tiff;
    std::uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    if (compression != COMPRESSION_NONE || page.isPlanar || page.isBits || TIFFIsTiled(tiff) != 0)
        return false;
    std::uint64_t next = page.offset;
    for (std::uint32_t i = 0; i < TIFFNumberOfStrips(tiff); ++i) {
        if (TIFFGetStrileOffset(tiff, i) != next)
            return false;
        next += TIFFGetStrileByteCount(tiff, i);
    }
    return next == page.offset + page.sizeBytes() * static_cast<std::uint64_t>(page.depth);
}

Status TiffFile::readPage(std::size_t page, std::span<std::byte> samples) {
    const TiffPage& wanted = pages_[page];
    ISO_CHECK(samples.size() == wanted.sizeBytes());
    handle_->complaint.clear();
    if (TIFFCurrentDirOffset(handle_->tiff) != wanted.directory &&
        TIFFSetSubDirectory(handle_->tiff, wanted.directory) != 1)
        return complaint("page " + std::to_string(page + 1) + " cannot be read again");
    if (wanted.photometric == PHOTOMETRIC_YCBCR)
        TIFFSetField(handle_->tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
    if (wanted.isBits)
        return readBits(wanted, samples);
    return TIFFIsTiled(handle_->tiff) != 0 ? readTiles(wanted, samples) : readStrips(wanted, samples);
}

namespace {

/// Rows of one strip or tile into the page: `stepBytes` from one sample's value to the next.
void copyRow(std::span<const std::byte> row, std::byte* out, std::size_t valueBytes, std::size_t stepBytes) {
    if (stepBytes == valueBytes) {
        std::memcpy(out, row.data(), row.size());
        return;
    }
    for (std::size_t i = 0; i + valueBytes <= row.size(); i += valueBytes, out += stepBytes)
        std::memcpy(out, row.data() + i, valueBytes);
}

} // namespace

Status TiffFile::readStrips(const TiffPage& page, std::span<std::byte> samples) {
    TIFF* tiff = handle_->tiff;
    const std::size_t typeBytes = fileTypeSizeBytes(page.type);
    const std::size_t sampleBytes = typeBytes * static_cast<std::size_t>(page.components);
    const std::size_t valueBytes = page.isPlanar ? typeBytes : sampleBytes;
    const std::size_t rowBytes = static_cast<std::size_t>(page.columns) * valueBytes;
    std::uint32_t stripRows = 0;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &stripRows);
    const std::int64_t rows = std::clamp<std::int64_t>(stripRows, 1, page.rows);
    std::vector<std::byte> buffer(static_cast<std::size_t>(rows) * rowBytes);
    const int planes = page.isPlanar ? page.components : 1;
    for (int plane = 0; plane < planes; ++plane)
        for (std::int64_t y = 0; y < page.rows; y += rows) {
            const std::uint32_t strip =
                TIFFComputeStrip(tiff, static_cast<std::uint32_t>(y), static_cast<std::uint16_t>(plane));
            const std::size_t size = static_cast<std::size_t>(std::min(rows, page.rows - y)) * rowBytes;
            const tmsize_t count = TIFFReadEncodedStrip(tiff, strip, buffer.data(), static_cast<tmsize_t>(size));
            if (count != static_cast<tmsize_t>(size))
                return complaint("strip " + std::to_string(strip) + " cannot be read");
            std::byte* out = samples.data() + static_cast<std::size_t>(y * page.columns) * sampleBytes +
                             static_cast<std::size_t>(plane) * typeBytes;
            copyRow(std::span(buffer).first(size), out, valueBytes, sampleBytes);
        }
    return {};
}

// Rows begin at whole bytes, the highest bit first.
Status TiffFile::readBits(const TiffPage& page, std::span<std::byte> samples) {
    TIFF* tiff = handle_->tiff;
    const auto columns = static_cast<std::size_t>(page.columns);
    const std::size_t rowBytes = (columns + 7) / 8;
    std::uint32_t stripRows = 0;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &stripRows);
    const std::int64_t rows = std::clamp<std::int64_t>(stripRows, 1, page.rows);
    std::vector<std::byte> buffer(static_cast<std::size_t>(rows) * rowBytes);
    for (std::int64_t y = 0; y < page.rows; y += rows) {
        const std::uint32_t strip = TIFFComputeStrip(tiff, static_cast<std::uint32_t>(y), 0);
        const auto count = static_cast<std::size_t>(std::min(rows, page.rows - y));
        const auto size = static_cast<tmsize_t>(count * rowBytes);
        if (TIFFReadEncodedStrip(tiff, strip, buffer.data(), size) != size)
            return complaint("strip " + std::to_string(strip) + " cannot be read");
        for (std::size_t row = 0; row < count; ++row)
            for (std::size_t x = 0; x < columns; ++x)
                samples[(static_cast<std::size_t>(y) + row) * columns + x] =
                    buffer[row * rowBytes + x / 8] >> static_cast<int>(7 - x % 8) & std::byte{1};
    }
    return {};
}

Status TiffFile::readTiles(const TiffPage& page, std::span<std::byte> samples) {
    TIFF* tiff = handle_->tiff;
    const std::size_t typeBytes = fileTypeSizeBytes(page.type);
    const std::size_t sampleBytes = typeBytes * static_cast<std::size_t>(page.components);
    const std::size_t valueBytes = page.isPlanar ? typeBytes : sampleBytes;
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_TILELENGTH, &height);
    std::vector<std::byte> buffer(TIFFTileSize64(tiff));
    if (width == 0 || height == 0 || buffer.size() < std::size_t{width} * height * valueBytes)
        return complaint("tiles have no size");
    const int planes = page.isPlanar ? page.components : 1;
    for (int plane = 0; plane < planes; ++plane)
        for (std::int64_t y = 0; y < page.rows; y += height)
            for (std::int64_t x = 0; x < page.columns; x += width) {
                const std::uint32_t tile =
                    TIFFComputeTile(tiff, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0,
                                    static_cast<std::uint16_t>(plane));
                const auto size = static_cast<tmsize_t>(buffer.size());
                if (TIFFReadEncodedTile(tiff, tile, buffer.data(), size) != size)
                    return complaint("tile " + std::to_string(tile) + " cannot be read");
                const std::int64_t columns = std::min<std::int64_t>(width, page.columns - x);
                for (std::int64_t row = 0; row < std::min<std::int64_t>(height, page.rows - y); ++row) {
                    const auto begin = static_cast<std::size_t>(row) * width * valueBytes;
                    copyRow(std::span(buffer).subspan(begin, static_cast<std::size_t>(columns) * valueBytes),
                            samples.data() + static_cast<std::size_t>((y + row) * page.columns + x) * sampleBytes +
                                static_cast<std::size_t>(plane) * typeBytes,
                            valueBytes, sampleBytes);
                }
            }
    return {};
}

} // namespace isoslider::io
