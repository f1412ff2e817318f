#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

namespace isoslider::io {
namespace {

using testing::Contains;
using testing::HasSubstr;
using enum ErrorCode;

constexpr std::uint32_t kColumns = 40, kRows = 24;

/// How a file is written; its samples are `value(x, y, page, component)`.
struct Layout {
    const char* mode = "wl"; ///< b: big-endian, 8: BigTIFF
    int pages = 1;
    int components = 1;
    int compression = COMPRESSION_NONE;
    int rowsPerStrip = 7; ///< 0: tiles of 16 x 16
    bool isPlanar = false;
    int photometric = PHOTOMETRIC_MINISBLACK;
    std::string description = {};
    int resolution = 0;
    std::uint32_t columns = kColumns;
};

double value(std::uint32_t x, std::uint32_t y, int page, int component) {
    return x + 3.0 * y + 20.0 * page + 5.0 * component;
}

/// Samples of a part of a page, as libtiff takes them.
template <class T>
std::vector<T> part(const Layout& layout, std::uint32_t x0, std::uint32_t y0, std::uint32_t width, std::uint32_t height,
                    int page, int plane) {
    std::vector<T> samples;
    for (std::uint32_t y = y0; y < y0 + height; ++y)
        for (std::uint32_t x = x0; x < x0 + width; ++x)
            for (int c = 0; c < layout.components; ++c)
                if (!layout.isPlanar || c == plane)
                    samples.push_back(static_cast<T>(value(x, y, page, c)));
    return samples;
}

template <class T>
constexpr int kFormat = std::is_floating_point_v<T> ? SAMPLEFORMAT_IEEEFP
                        : std::is_signed_v<T>       ? SAMPLEFORMAT_INT
                                                    : SAMPLEFORMAT_UINT;

template <class T>
void writePage(TIFF* tiff, const Layout& layout, int page) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, layout.columns);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, kRows);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * sizeof(T)));
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, kFormat<T>);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, layout.components);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, layout.compression);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, layout.photometric);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, layout.isPlanar ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
    if (!layout.description.empty() && page == 0)
        TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, layout.description.c_str());
    if (layout.resolution > 0) {
        TIFFSetField(tiff, TIFFTAG_XRESOLUTION, static_cast<double>(layout.resolution));
        TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 2.0 * layout.resolution);
    }
    const int planes = layout.isPlanar ? layout.components : 1;
    if (layout.rowsPerStrip == 0) {
        TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
        TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
        for (int plane = 0; plane < planes; ++plane)
            for (std::uint32_t y = 0; y < kRows; y += 16)
                for (std::uint32_t x = 0; x < layout.columns; x += 16) {
                    auto samples = part<T>(layout, x, y, 16, 16, page, plane);
                    TIFFWriteTile(tiff, samples.data(), x, y, 0, static_cast<std::uint16_t>(plane));
                }
    } else {
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, layout.rowsPerStrip);
        for (int plane = 0; plane < planes; ++plane)
            for (std::uint32_t y = 0; y < kRows; ++y) {
                auto samples = part<T>(layout, 0, y, layout.columns, 1, page, plane);
                TIFFWriteScanline(tiff, samples.data(), y, static_cast<std::uint16_t>(plane));
            }
    }
    TIFFWriteDirectory(tiff);
}

template <class T>
std::filesystem::path write(const std::filesystem::path& path, const Layout& layout) {
    TIFF* tiff = TIFFOpen(path.c_str(), layout.mode);
    for (int page = 0; page < layout.pages; ++page)
        writePage<T>(tiff, layout, page);
    TIFFClose(tiff);
    return path;
}

/// Every sample of a volume whose slice z is page `first + z * step`.
void expectSamples(const ScalarGrid& grid, int component = 0, int first = 0, int step = 1) {
    for (int z = 0; z < grid.dims()[2]; ++z)
        for (std::uint32_t y = 0; y < kRows; ++y)
            for (std::uint32_t x = 0; x < kColumns; ++x)
                ASSERT_EQ(grid.valueAt(x, y, z), value(x, y, first + step * z, component)) << x << ' ' << y << ' ' << z;
}

class TiffVolume : public testing::Test {
protected:
    template <class T>
    std::shared_ptr<const ScalarGrid> written(const Layout& layout, const ReadOptions& options = {}) {
        return read(write<T>(folder_ / "volume.tif", layout), options);
    }
    std::shared_ptr<const ScalarGrid> read(const std::filesystem::path& path, const ReadOptions& options = {}) {
        auto grid = readVolume(path, options);
        EXPECT_THAT(grid, test::IsOk());
        return grid.isOk() ? grid.value() : std::make_shared<const ScalarGrid>();
    }
    std::string refusal(const std::filesystem::path& path, const ReadOptions& options = {}) {
        const auto grid = readVolume(path, options);
        EXPECT_FALSE(grid.isOk());
        return grid.isOk() ? "" : grid.error().line();
    }
    std::vector<std::string> notes(const std::filesystem::path& path) {
        const auto source = openVolume(path);
        EXPECT_THAT(source, test::IsOk());
        return source.isOk() ? source.value()->info().notes : std::vector<std::string>();
    }
    void slice(const std::string& name, int page, std::uint32_t columns = kColumns) {
        Layout layout;
        layout.columns = columns;
        TIFF* tiff = TIFFOpen((folder_ / name).c_str(), "wl");
        writePage<std::uint8_t>(tiff, layout, page);
        TIFFClose(tiff);
    }

    test::TemporaryFolder folder_;
};

template <class T>
struct ExpectedType {
    static constexpr ScalarType kType = std::is_same_v<T, std::uint8_t>    ? ScalarType::U8
                                        : std::is_same_v<T, std::int8_t>   ? ScalarType::I8
                                        : std::is_same_v<T, std::uint16_t> ? ScalarType::U16
                                        : std::is_same_v<T, std::int16_t>  ? ScalarType::I16
                                        : std::is_same_v<T, std::int32_t>  ? ScalarType::I32
                                        : std::is_same_v<T, float>         ? ScalarType::F32
                                                                           : ScalarType::F64;
};

template <class T>
class TiffOfType : public TiffVolume {};
using Types = testing::Types<std::uint8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t, std::uint64_t,
                             std::int64_t, float, double>;
TYPED_TEST_SUITE(TiffOfType, Types);

TYPED_TEST(TiffOfType, IsReadInEitherByteOrderAsStripsAndTiles) {
    for (const char* mode : {"wl", "wb", "wl8", "wb8"})
        for (const int rowsPerStrip : {0, 7, static_cast<int>(kRows)}) {
            Layout layout;
            layout.mode = mode;
            layout.pages = 3;
            layout.rowsPerStrip = rowsPerStrip;
            const auto grid = this->template written<TypeParam>(layout);
            ASSERT_EQ(grid->dims(), (GridDims{kColumns, kRows, 3})) << mode;
            EXPECT_EQ(grid->type(), ExpectedType<TypeParam>::kType);
            expectSamples(*grid);
        }
}

TEST_F(TiffVolume, IsUnpackedByEveryCompressionThatLosesNothing) {
    int tried = 0;
    TIFFSetWarningHandler(nullptr); // of one deflate for the other
    for (const int compression : {COMPRESSION_LZW, COMPRESSION_PACKBITS, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_DEFLATE,
                                  COMPRESSION_LZMA, COMPRESSION_ZSTD}) {
        if (TIFFIsCODECConfigured(static_cast<std::uint16_t>(compression)) == 0)
            continue;
        Layout layout;
        layout.pages = 2;
        layout.compression = compression;
        expectSamples(*written<std::int16_t>(layout));
        layout.rowsPerStrip = 0;
        expectSamples(*written<std::int16_t>(layout));
        ++tried;
    }
    EXPECT_GE(tried, 4);
}

TEST_F(TiffVolume, GivesOneComponentOfColours) {
    for (const bool isPlanar : {false, true})
        for (const int rowsPerStrip : {0, 7}) {
            Layout layout;
            layout.pages = 2;
            layout.components = 3;
            layout.photometric = PHOTOMETRIC_RGB;
            layout.isPlanar = isPlanar;
            layout.rowsPerStrip = rowsPerStrip;
            const auto path = write<std::uint16_t>(folder_ / "colours.tif", layout);
            EXPECT_THAT(refusal(path), HasSubstr("has 3 components"));
            ReadOptions options;
            for (int component = 0; component < 3; ++component) {
                options.component = component;
                expectSamples(*read(path, options), component);
            }
            options.component = 3;
            EXPECT_THAT(refusal(path, options), HasSubstr("--component 3"));
            options.component = kMagnitude;
            EXPECT_NEAR(read(path, options)->valueAt(0, 0, 1), std::sqrt(20.0 * 20 + 25 * 25 + 30 * 30), 1e-5);
            const auto listed = listVolumes(path);
            ASSERT_THAT(listed, test::IsOk());
            EXPECT_EQ(listed.value().fields[0].componentNames, (std::vector<std::string>{"red", "green", "blue"}));
        }
}

TEST_F(TiffVolume, OfImageJHasSpacingChannelsAndFrames) {
    Layout layout;
    layout.pages = 12;
    layout.resolution = 4;
    layout.description = "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\nunit=micron\n"
                         "spacing=1.5\nloop=false\n";
    const auto path = write<std::uint16_t>(folder_ / "hyperstack.tif", layout);
    EXPECT_THAT(refusal(path), HasSubstr("--component 0 to 1, and --frame 0 to 1"));
    ReadOptions options;
    options.frame = 1;
    EXPECT_THAT(refusal(path, options), HasSubstr("has 2 components: choose one with --component 0 to 1"));
    options.component = 1;
    const auto grid = read(path, options);
    EXPECT_EQ(grid->dims(), (GridDims{kColumns, kRows, 3}));
    EXPECT_EQ(grid->geometry().spacing, glm::dvec3(0.25, 0.125, 1.5));
    expectSamples(*grid, 0, 7, 2); // channel 1 of frame 1
    EXPECT_EQ(openVolume(path, options).value()->info().lengthUnit, "µm");
    layout.description = test::replaced(layout.description, "unit=micron", "unit=pixel");
    const auto source = openVolume(write<std::uint16_t>(folder_ / "pixels.tif", layout), options);
    EXPECT_EQ(source.value()->info().lengthUnit, "");
    EXPECT_THAT(source.value()->info().notes, Contains(HasSubstr("'pixel'")));
}

TEST_F(TiffVolume, OfImageJMayHaveOneDirectoryForAllSlices) {
    for (const char* mode : {"wl", "wb"}) {
        Layout layout;
        layout.mode = mode;
        layout.rowsPerStrip = kRows;
        layout.description = "ImageJ=1.53t\nimages=3\nslices=3\n";
        // The samples go last, so that the others can follow them.
        const auto path = write<std::uint16_t>(folder_ / "large.tif", layout);
        std::string bytes = test::readText(path);
        TIFF* tiff = TIFFOpen(path.c_str(), "r");
        const auto offset = static_cast<std::size_t>(TIFFGetStrileOffset(tiff, 0));
        TIFFClose(tiff);
        std::string samples;
        for (int page = 0; page < 3; ++page)
            for (const std::uint16_t sample : part<std::uint16_t>(layout, 0, 0, kColumns, kRows, page, 0)) {
                samples += static_cast<char>(mode[1] == 'l' ? sample & 255 : sample >> 8);
                samples += static_cast<char>(mode[1] == 'l' ? sample >> 8 : sample & 255);
            }
        // The directory is moved behind where the samples end now.
        const std::string tail = bytes.substr(offset + samples.size() / 3);
        ASSERT_EQ(offset, 8u);
        std::string moved = bytes.substr(0, offset) + samples + tail;
        const auto shift = static_cast<std::uint32_t>(samples.size() / 3 * 2);
        const auto add = [&](std::size_t at) {
            const bool isLittle = mode[1] == 'l';
            std::uint32_t number = 0;
            for (std::size_t i = 0; i < 4; ++i)
                number |= static_cast<std::uint32_t>(static_cast<unsigned char>(moved[at + i]))
                          << 8 * (isLittle ? i : 3 - i);
            number += shift;
            for (std::size_t i = 0; i < 4; ++i)
                moved[at + i] = static_cast<char>(number >> 8 * (isLittle ? i : 3 - i) & 255);
        };
        add(4); // where the directory is
        const std::size_t directory = bytes.size() - tail.size() + shift;
        // Entries whose values lie elsewhere: only the description here.
        std::size_t description = moved.find("ImageJ=");
        ASSERT_NE(description, std::string::npos);
        for (std::size_t entry = directory; entry + 12 < moved.size(); ++entry) {
            const bool isLittle = mode[1] == 'l';
            if (static_cast<unsigned char>(moved[entry + (isLittle ? 1 : 0)]) == 1 &&
                static_cast<unsigned char>(moved[entry + (isLittle ? 0 : 1)]) == 14 &&
                static_cast<unsigned char>(moved[entry + (isLittle ? 2 : 3)]) == 2) {
                add(entry + 8);
                break;
            }
        }
        folder_.write("large.tif", moved);
        const auto grid = read(path);
        ASSERT_EQ(grid->dims(), (GridDims{kColumns, kRows, 3}));
        expectSamples(*grid);
        folder_.write("large.tif", test::replaced(moved, "images=3", "images=9"));
        EXPECT_THAT(refusal(path), HasSubstr("images=9"));
    }
}

TEST_F(TiffVolume, OfOmeHasItsDimensionOrderAndUnits) {
    Layout layout;
    layout.pages = 6;
    layout.description =
        "<?xml version=\"1.0\"?><OME><Image><Pixels DimensionOrder=\"XYZCT\" Type=\"uint8\" SizeX=\"40\" "
        "SizeY=\"24\" SizeZ=\"3\" SizeC=\"2\" SizeT=\"1\" PhysicalSizeX=\"0.5\" PhysicalSizeXUnit=\"nm\" "
        "PhysicalSizeY=\"0.25\" PhysicalSizeYUnit=\"nm\" PhysicalSizeZ=\"2\"></Pixels></Image></OME>";
    const auto path = write<std::uint8_t>(folder_ / "volume.ome.tif", layout);
    ReadOptions options;
    options.component = 1;
    const auto grid = read(path, options);
    EXPECT_EQ(grid->geometry().spacing, glm::dvec3(0.5, 0.25, 2.0));
    EXPECT_EQ(grid->dims()[2], 3);
    expectSamples(*grid, 0, 3, 1);
    const auto unitWith = [&](const char* unit) {
        layout.description = test::replaced(layout.description, "PhysicalSizeZ=\"2\"",
                                            std::string("PhysicalSizeZ=\"2\" PhysicalSizeZUnit=\"") + unit + '"');
        return openVolume(write<std::uint8_t>(folder_ / "other.ome.tif", layout), options).value()->info();
    };
    const auto mixed = openVolume(path, options).value()->info();
    EXPECT_EQ(mixed.lengthUnit, "") << "nm and, where none is named, µm";
    EXPECT_THAT(mixed.notes, Contains(HasSubstr("'nm', 'nm', micrometres")));
    EXPECT_EQ(unitWith("nm").lengthUnit, "nm");
}

TEST_F(TiffVolume, WithAnImageDepthHasAllSlices) {
    constexpr int kSlices = 13;
    const auto write = [&](std::uint16_t compression) {
        const auto path = folder_ / "deep.tif";
        TIFF* tiff = TIFFOpen(path.c_str(), "wl");
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 4);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 3);
        TIFFSetField(tiff, TIFFTAG_IMAGEDEPTH, kSlices);
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 3);
        std::vector<std::uint8_t> samples(4 * 3 * kSlices);
        std::iota(samples.begin(), samples.end(), std::uint8_t{0});
        TIFFWriteRawStrip(tiff, 0, samples.data(), static_cast<tmsize_t>(samples.size()));
        TIFFClose(tiff);
        return path;
    };
    const auto grid = read(write(COMPRESSION_NONE));
    ASSERT_EQ(grid->dims(), (GridDims{4, 3, kSlices}));
    for (int z = 0; z < kSlices; ++z)
        for (int y = 0; y < 3; ++y)
            for (int x = 0; x < 4; ++x)
                ASSERT_EQ(grid->valueAt(x, y, z), x + 4 * (y + 3 * z));
    EXPECT_THAT(refusal(write(COMPRESSION_PACKBITS)), HasSubstr("13 slices in one page"));
}

TEST_F(TiffVolume, OfSingleBitsIsUnpacked) {
    for (const int compression : {COMPRESSION_NONE, COMPRESSION_CCITTFAX4}) {
        TIFF* tiff = TIFFOpen((folder_ / "bits.tif").c_str(), "w");
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 11);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 5);
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 1);
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 2);
        for (std::uint32_t y = 0; y < 5; ++y) {
            unsigned char row[2] = {static_cast<unsigned char>(0x80 >> y), 0x20}; // bit y and the last
            TIFFWriteScanline(tiff, row, y, 0);
        }
        TIFFClose(tiff);
        const auto grid = read(folder_ / "bits.tif");
        EXPECT_EQ(grid->type(), ScalarType::U8);
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < 11; ++x)
                EXPECT_EQ(grid->valueAt(x, y, 0), x == y || x == 10) << x << ' ' << y;
    }
}

TEST_F(TiffVolume, OfJpegIsNearlyTheSame) {
    Layout layout;
    layout.compression = COMPRESSION_JPEG;
    layout.rowsPerStrip = 8;
    const auto grid = written<std::uint8_t>(layout);
    for (std::uint32_t y = 0; y < kRows; ++y)
        for (std::uint32_t x = 0; x < kColumns; ++x)
            ASSERT_NEAR(grid->valueAt(x, y, 0), value(x, y, 0, 0), 6.0) << x << ' ' << y;
}

TEST_F(TiffVolume, B075_WithPagesOfTwoSizesIsRefused) {
    TIFF* tiff = TIFFOpen((folder_ / "two.tif").c_str(), "w");
    Layout layout;
    writePage<std::uint8_t>(tiff, layout, 0);
    layout.columns = 30;
    writePage<std::uint8_t>(tiff, layout, 1);
    TIFFClose(tiff);
    EXPECT_THAT(refusal(folder_ / "two.tif"), HasSubstr("page 2: is 30 x 24 of uint8, those before it are 40 x 24"));
}

TEST_F(TiffVolume, NotesATableOfColours) {
    Layout layout;
    layout.photometric = PHOTOMETRIC_MINISWHITE;
    EXPECT_THAT(notes(write<std::uint8_t>(folder_ / "white.tif", layout)), Contains(HasSubstr("not inverted")));
}

TEST_F(TiffVolume, B075_OfAFolderIsInNaturalOrder) {
    const char* const names[] = {"slice1.tif", "slice2.tif", "slice9.tif", "slice10.tif", "slice011.TIFF"};
    for (int i = 0; i < 5; ++i)
        slice(names[i], i);
    folder_.write("notes.txt", "not a slice");
    const auto grid = read(folder_.path());
    EXPECT_EQ(grid->dims()[2], 5);
    expectSamples(*grid);
    EXPECT_THAT(notes(folder_.path()),
                Contains(HasSubstr("natural order of their names, from 'slice1.tif' to 'slice011")));
    EXPECT_THAT(notes(folder_.path()), Contains(HasSubstr("gap between 'slice2.tif' and 'slice9.tif'")));
}

TEST_F(TiffVolume, B075_OfAFolderNamesTheSliceThatDoesNotFit) {
    for (int i = 0; i < 3; ++i)
        slice("s" + std::to_string(i) + ".tif", i);
    slice("s3.tif", 3, 30);
    EXPECT_THAT(refusal(folder_.path()), testing::AllOf(HasSubstr("s3.tif"), HasSubstr("is 30 x 24 of uint8")));
    write<std::uint8_t>(folder_ / "s3.tif", {.pages = 2});
    EXPECT_THAT(refusal(folder_.path()), testing::AllOf(HasSubstr("s3.tif"), HasSubstr("has 2;")));
    folder_.write("s3.tif", "II*");
    EXPECT_THAT(refusal(folder_.path()), HasSubstr("s3.tif"));
}

TEST_F(TiffVolume, IsKnownByItsFirstBytes) {
    const auto path = write<std::uint8_t>(folder_ / "noname", {.mode = "wb8"});
    EXPECT_EQ(read(path)->dims(), (GridDims{kColumns, kRows, 1}));
}

// --- bad files
// ----------------------------------------------------------------------------------------------

std::uint64_t peakRssBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
}

/// A little-endian directory of long values, at byte 8.
std::string directory(const std::vector<std::pair<int, std::uint32_t>>& entries, std::uint32_t next = 0) {
    std::string bytes("II*\0\x08\0\0\0", 8);
    const auto number = [&](std::uint32_t n, int size) {
        for (int i = 0; i < size; ++i)
            bytes += static_cast<char>(n >> 8 * i & 255);
    };
    number(static_cast<std::uint32_t>(entries.size()), 2);
    for (const auto& [tag, entry] : entries) {
        number(static_cast<std::uint32_t>(tag), 2);
        number(4, 2);
        number(1, 4);
        number(entry, 4);
    }
    number(next, 4);
    return bytes + std::string(200, '\1');
}

std::string image(std::uint32_t columns, std::uint32_t rows, std::uint32_t bits = 8, int compression = 1,
                  std::uint32_t next = 0, std::uint32_t count = 100) {
    return directory({{256, columns},
                      {257, rows},
                      {258, bits},
                      {259, static_cast<std::uint32_t>(compression)},
                      {262, 1},
                      {273, 160},
                      {277, 1},
                      {278, rows},
                      {279, count}},
                     next);
}

TEST_F(TiffVolume, IsRefusedSoonWithOneClearLine) {
    struct Bad {
        const char* label;
        std::string bytes;
        const char* says;
    };
    const std::string sound = test::readText(write<std::uint16_t>(folder_ / "sound.tif", {.pages = 3}));
    const Bad files[] = {
        {"nothing but the magic", std::string("II*\0", 4), "is not a TIFF file"},
        {"no directory", std::string("II*\0\xff\xff\0\0", 8), "is not a TIFF file"},
        {"cut", sound.substr(0, sound.size() - 300), ""},
        {"a directory without entries", directory({}), ""},
        {"no columns", image(0, 10), ""},
        {"too many columns", image(2'000'000, 10), "page 1"},
        {"larger than its file", image(1000, 1000), "do not lie within the 322 of the file"},
        {"packed by any means, larger than possible", image(1 << 20, 1 << 19, 8, 50000),
         "in the file cannot hold them"},
        {"packed, larger than possible", image(100'000, 100'000, 8, 8), "in the file cannot hold them"},
        {"a strip beyond the end", image(10, 10, 8, 8, 0, 1000), "do not lie within"},
        {"12 bits", image(10, 10, 12), "bits per sample"},
        {"an unknown compression", image(10, 10, 8, 12345), "compression"},
        {"a loop of directories", image(10, 10, 8, 1, 8), "page 2"},
        {"damaged deflate", image(10, 10, 8, 8), "strip 0 cannot be read"},
        {"tiles larger than the image",
         directory({{256, 10},
                    {257, 10},
                    {258, 8},
                    {259, 8},
                    {262, 1},
                    {277, 1},
                    {322, 1 << 17},
                    {323, 1 << 14},
                    {324, 160},
                    {325, 100}}),
         "bytes each"},
        {"tiles without end",
         directory({{256, 1 << 20},
                    {257, 1 << 19},
                    {258, 8},
                    {259, 8},
                    {262, 1},
                    {277, 1},
                    {322, 16},
                    {323, 16},
                    {324, 160},
                    {325, 100}}),
         ""}};
    for (const Bad& bad : files) {
        SCOPED_TRACE(bad.label);
        const auto path = folder_.write("bad.tif", bad.bytes);
        const std::uint64_t rssBefore = peakRssBytes();
        const auto begin = std::chrono::steady_clock::now();
        testing::internal::CaptureStderr();
        const std::string line = refusal(path);
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
        EXPECT_THAT(line, HasSubstr(bad.says));
        EXPECT_THAT(line, HasSubstr("bad.tif: "));
        EXPECT_THAT(line, testing::Not(HasSubstr("\n")));
        EXPECT_LT(elapsed.count(), 1.0);
        EXPECT_LT(peakRssBytes() - rssBefore, std::uint64_t{64} << 20);
    }
}

} // namespace
} // namespace isoslider::io
