#include "core/volume_io/formats/dicom/dicom_pixels.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <iostream>
#include <mutex>
#include <type_traits>

#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include "core/base/quiet_stream.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

/// Bytes of samples for one that is compressed: JPEG 2000 makes 286,000 of a blank image of 16384 x 16384.
constexpr std::uint64_t kMostPerByte = 300'000;
constexpr std::size_t kMaxMarkerBytes = std::size_t{1} << 20; ///< of a JPEG frame before its extents

Error damaged(const std::string& what, std::size_t frame, const fs::path& path) {
    return makeError(ErrorCode::Corruption, "pixel data (7fe0,0010): frame " + std::to_string(frame) + ": " + what,
                     path);
}

std::uint64_t totalBytes(std::span<const DicomFragment> fragments) {
    std::uint64_t total = 0;
    for (const DicomFragment& fragment : fragments)
        total += fragment.sizeBytes;
    return total;
}

/// The fragments' bytes one after the other, `maxBytes` at most.
Result<std::vector<std::byte>> gather(const RandomAccessFile& bytes, std::span<const DicomFragment> fragments,
                                      std::uint64_t maxBytes) {
    std::vector<std::byte> all(std::min(totalBytes(fragments), maxBytes));
    std::span<std::byte> rest(all);
    for (const DicomFragment& fragment : fragments) {
        const auto part = rest.first(std::min<std::uint64_t>(fragment.sizeBytes, rest.size()));
        ISO_TRY(bytes.readExactlyAt(fragment.offset, part));
        rest = rest.subspan(part.size());
    }
    return all;
}

std::uint32_t bigEndian(std::span<const std::byte> bytes, std::size_t at, int size) {
    std::uint32_t value = 0;
    for (int i = 0; i < size; ++i)
        value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + static_cast<std::size_t>(i)]);
    return value;
}

std::uint32_t littleEndian32(std::span<const std::byte> bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;)
        value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
    return value;
}

/// What a compressed frame states of itself.
struct Codestream {
    std::int64_t rows = 0, columns = 0;
    int components = 0, bits = 0;
    bool isFound = false;
};

// Everything up to the scan, strictly: a decoder that only warns of what is odd there may also stop the
// program.
Codestream readJpegMarkers(std::span<const std::byte> bytes) {
    if (bytes.size() < 4 || bigEndian(bytes, 0, 2) != 0xffd8)
        return {};
    Codestream stream;
    for (std::size_t at = 2; at + 4 <= bytes.size();) {
        if (bytes[at] != std::byte{0xff})
            return {};
        const std::uint32_t marker = bigEndian(bytes, at + 1, 1);
        if (marker == 0xff) { // filling
            ++at;
            continue;
        }
        const std::size_t length = bigEndian(bytes, at + 2, 2);
        if (marker < 0xc0 || (marker >= 0xd0 && marker <= 0xd9) || length < 2 || length > bytes.size() - at - 2)
            return {};
        const bool isFrame = (marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) || marker == 0xf7;
        if (isFrame && (length < 8 || stream.components != 0))
            return {};
        if (isFrame)
            stream = {bigEndian(bytes, at + 5, 2), bigEndian(bytes, at + 7, 2),
                      static_cast<int>(bigEndian(bytes, at + 9, 1)), static_cast<int>(bigEndian(bytes, at + 4, 1)),
                      false};
        const bool isJfif = marker == 0xe0 && length >= 9 && bigEndian(bytes, at + 4, 4) == 0x4a464946;
        const bool isAdobe = marker == 0xee && length >= 14 && bigEndian(bytes, at + 4, 4) == 0x41646f62;
        if ((isJfif && bigEndian(bytes, at + 9, 1) != 1) || (isAdobe && bigEndian(bytes, at + 15, 1) > 1))
            return {};
        if (marker == 0xda) {
            stream.isFound = stream.components != 0;
            return stream;
        }
        at += 2 + length;
    }
    return {};
}

/// Where the codestream begins, in a JP2 file or without one.
std::size_t findJpeg2000(std::span<const std::byte> bytes) {
    constexpr std::array kStart{std::byte{0xff}, std::byte{0x4f}, std::byte{0xff}, std::byte{0x51}};
    const auto found = std::search(bytes.begin(), bytes.end(), kStart.begin(), kStart.end());
    return static_cast<std::size_t>(found - bytes.begin());
}

/// All segments up to the first tile's data lie within the bytes, and state how the samples are coded.
bool areJpeg2000MarkersWhole(std::span<const std::byte> bytes) {
    bool isCoded = false;
    for (std::size_t at = 2; at + 4 <= bytes.size();) {
        const std::uint32_t marker = bigEndian(bytes, at, 2);
        if (marker == 0xff93)
            return isCoded;
        const std::size_t length = bigEndian(bytes, at + 2, 2);
        const bool isSegment = marker >= 0xff50 && marker != 0xff92 && marker != 0xffd9;
        if (!isSegment || length < 2 || length > bytes.size() - at - 2 || (marker == 0xff52 && length < 12))
            return false;
        isCoded = isCoded || marker == 0xff52;
        at += 2 + length;
    }
    return false;
}

Codestream readJpeg2000Size(std::span<const std::byte> all) {
    const auto bytes = all.subspan(findJpeg2000(all));
    if (bytes.size() < 45 || !areJpeg2000MarkersWhole(bytes))
        return {};
    const auto field = [&](std::size_t offset) { return static_cast<std::int64_t>(bigEndian(bytes, offset, 4)); };
    Codestream stream{field(12) - field(20), field(8) - field(16), static_cast<int>(bigEndian(bytes, 40, 2)),
                      static_cast<int>(bigEndian(bytes, 42, 1) & 0x7f) + 1, true};
    for (std::size_t c = 0; c < static_cast<std::size_t>(stream.components); ++c) {
        const std::size_t component = 42 + 3 * c;
        const bool isWhole = component + 3 <= bytes.size() && bigEndian(bytes, component + 1, 2) == 0x0101 &&
                             static_cast<int>(bigEndian(bytes, component, 1) & 0x7f) + 1 == stream.bits;
        if (!isWhole)
            return {};
    }
    return stream;
}

constexpr std::size_t kRleHeaderBytes = 64;

/// Segments of a frame: for each component, the most significant bytes of all samples first.
/// `begins` has the first kRleHeaderBytes of the frame.
Result<std::vector<DicomFragment>> rleSegments(std::span<const std::byte> begins, std::uint64_t frameBytes,
                                               const DicomPixels& pixels, std::size_t frame, const fs::path& path) {
    const int expected = pixels.components * pixels.bitsAllocated / 8;
    if (begins.size() < kRleHeaderBytes || static_cast<int>(littleEndian32(begins, 0)) != expected || expected > 15)
        return damaged(std::to_string(expected) + " RLE segments expected", frame, path);
    const auto points = static_cast<std::uint64_t>(pixels.rows * pixels.columns);
    std::vector<DicomFragment> segments;
    for (int i = 0; i < expected; ++i) {
        const auto at = static_cast<std::size_t>(4 + 4 * i);
        const std::uint64_t begin = littleEndian32(begins, at);
        const std::uint64_t end = i + 1 < expected ? littleEndian32(begins, at + 4) : frameBytes;
        // Two bytes stand for 128 at most.
        if (begin < kRleHeaderBytes || begin > end || end > frameBytes || (end - begin) * 64 < points)
            return damaged("RLE segment " + std::to_string(i) + " of " + std::to_string(begin) + " to " +
                               std::to_string(end) + " bytes cannot hold " + std::to_string(points) + " samples",
                           frame, path);
        segments.push_back({begin, end - begin});
    }
    return segments;
}

/// Every `stride`-th byte of `out`. False if the segment does not give `count` of them.
bool unpackRle(std::span<const std::byte> segment, std::byte* out, std::size_t stride, std::size_t count) {
    std::size_t done = 0;
    for (std::size_t at = 0; at + 1 < segment.size() && done < count;) {
        const int code = std::to_integer<std::int8_t>(segment[at++]);
        if (code == -128)
            continue;
        const std::size_t wanted = static_cast<std::size_t>(code >= 0 ? code + 1 : 1 - code);
        const std::size_t taken = std::min(wanted, count - done);
        if (code >= 0 && segment.size() - at < taken)
            return false;
        for (std::size_t i = 0; i < taken; ++i)
            out[(done + i) * stride] = segment[code >= 0 ? at + i : at];
        at += code >= 0 ? wanted : 1;
        done += taken;
    }
    return done == count;
}

template <class T>
void keepStoredBits(std::span<std::byte> bytes, int bitsStored, int highBit) {
    using Unsigned = std::make_unsigned_t<T>;
    constexpr int kBits = static_cast<int>(8 * sizeof(T));
    for (std::size_t i = 0; i + sizeof(T) <= bytes.size(); i += sizeof(T)) {
        Unsigned raw;
        std::memcpy(&raw, bytes.data() + i, sizeof raw);
        raw = static_cast<Unsigned>(raw << (kBits - 1 - highBit));
        const T value = static_cast<T>(static_cast<T>(raw) >> (kBits - bitsStored)); // repeats the sign of signed T
        std::memcpy(bytes.data() + i, &value, sizeof value);
    }
}

void keepStoredBits(std::span<std::byte> bytes, const DicomPixels& pixels) {
    if (pixels.bitsStored == pixels.bitsAllocated || pixels.bitsAllocated == 1)
        return;
    switch (pixels.type) {
        case FileType::U8: return keepStoredBits<std::uint8_t>(bytes, pixels.bitsStored, pixels.highBit);
        case FileType::I8: return keepStoredBits<std::int8_t>(bytes, pixels.bitsStored, pixels.highBit);
        case FileType::U16: return keepStoredBits<std::uint16_t>(bytes, pixels.bitsStored, pixels.highBit);
        case FileType::I16: return keepStoredBits<std::int16_t>(bytes, pixels.bitsStored, pixels.highBit);
        case FileType::U32: return keepStoredBits<std::uint32_t>(bytes, pixels.bitsStored, pixels.highBit);
        case FileType::I32: return keepStoredBits<std::int32_t>(bytes, pixels.bitsStored, pixels.highBit);
        default: return;
    }
}

/// While it lives, what is written to standard error is lost, also past the C++ streams: the JPEG library
/// inside GDCM prints there what it gives up on. One at a time: the next waits.
class QuietError {
public:
    QuietError() : lock_(mutex()), before_(::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0)) {
        const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
        if (before_ >= 0 && nothing >= 0)
            ::dup2(nothing, STDERR_FILENO);
        if (nothing >= 0)
            ::close(nothing);
    }
    ~QuietError() {
        if (before_ >= 0) {
            ::dup2(before_, STDERR_FILENO);
            ::close(before_);
        }
    }
    QuietError(const QuietError&) = delete;
    QuietError& operator=(const QuietError&) = delete;

private:
    static std::mutex& mutex() {
        static std::mutex one;
        return one;
    }
    std::scoped_lock<std::mutex> lock_;
    int before_;
};

class FrameReader final : public DicomFrameReader {
public:
    FrameReader(const DicomImage& image, std::shared_ptr<const RandomAccessFile> bytes)
        : image_(image), pixels_(image.pixels), bytes_(std::move(bytes)) {}

    bool isPlanar() const override { return pixels_.coding == DicomCoding::Native && pixels_.isPlanar; }

    Status read(std::size_t frame, std::vector<std::byte>& samples) override {
        samples.resize(pixels_.bitsAllocated == 1 ? 8 * pixels_.frameBytes() : pixels_.frameBytes());
        switch (pixels_.coding) {
            case DicomCoding::Native: ISO_TRY(readNative(frame, samples)); break;
            case DicomCoding::Rle: ISO_TRY(readRle(frame, samples)); break;
            default: ISO_TRY(readByGdcm(frame, samples)); break;
        }
        keepStoredBits(samples, pixels_);
        return {};
    }

private:
    Status readNative(std::size_t frame, std::vector<std::byte>& samples) {
        if (pixels_.bitsAllocated == 1)
            return readBits(frame, samples);
        ISO_TRY(bytes_->readExactlyAt(pixels_.offset + frame * pixels_.frameBytes(), samples));
        const std::size_t size = pixels_.isPairSwapped ? 2 : fileTypeSizeBytes(pixels_.type);
        if (pixels_.isBigEndian && size > 1)
            for (std::size_t i = 0; i + size <= samples.size(); i += size)
                std::reverse(samples.data() + i, samples.data() + i + size);
        return {};
    }

    // Frames of single bits follow each other without a gap, the lowest bit of a byte first.
    Status readBits(std::size_t frame, std::vector<std::byte>& samples) {
        const auto points = static_cast<std::uint64_t>(pixels_.rows * pixels_.columns * pixels_.components);
        const std::uint64_t begin = frame * points;
        std::vector<std::byte> packed((begin + points + 7) / 8 - begin / 8);
        ISO_TRY(bytes_->readExactlyAt(pixels_.offset + begin / 8, packed));
        samples.resize(points);
        for (std::uint64_t i = 0; i < points; ++i) {
            const std::uint64_t bit = begin % 8 + i;
            samples[i] = packed[bit / 8] >> static_cast<int>(bit % 8) & std::byte{1};
        }
        return {};
    }

    Status readRle(std::size_t frame, std::vector<std::byte>& samples) {
        const auto packed = gather(*bytes_, pixels_.fragments[frame], ~std::uint64_t{0});
        if (!packed.isOk())
            return packed.error();
        const std::span<const std::byte> all(packed.value());
        const auto segments = rleSegments(all, all.size(), pixels_, frame, image_.path);
        if (!segments.isOk())
            return segments.error();
        const auto sampleBytes = static_cast<std::size_t>(pixels_.bitsAllocated / 8);
        const std::size_t stride = segments.value().size();
        const auto points = static_cast<std::size_t>(pixels_.rows * pixels_.columns);
        for (std::size_t i = 0; i < stride; ++i) {
            const std::size_t component = i / sampleBytes, significance = i % sampleBytes;
            const std::size_t place =
                std::endian::native == std::endian::little ? sampleBytes - 1 - significance : significance;
            const DicomFragment& segment = segments.value()[i];
            if (!unpackRle(all.subspan(segment.offset, segment.sizeBytes),
                           samples.data() + component * sampleBytes + place, stride, points))
                return damaged("RLE segment " + std::to_string(i) + " ends early", frame, image_.path);
        }
        return {};
    }

    Status readByGdcm(std::size_t frame, std::vector<std::byte>& samples) {
        auto packed = gather(*bytes_, pixels_.fragments[frame], ~std::uint64_t{0});
        if (!packed.isOk())
            return std::move(packed).error();
        // Files may have changed since they were looked at.
        ISO_TRY(checkDicomCodestream(*bytes_, pixels_, frame, image_.path));
        const QuietError quietDescriptor;
        gdcm::Trace::WarningOff();
        gdcm::Trace::ErrorOff();
        const QuietStream quietErrors(std::cerr), quietLog(std::clog), quietOutput(std::cout);
        try {
            const std::span<const std::byte> all(packed.value());
            const bool isJpeg2000 = pixels_.coding == DicomCoding::Jpeg2000; // the box around it is not needed
            if (decode(isJpeg2000 ? all.subspan(findJpeg2000(all)) : all, samples))
                return {};
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception&) {} // said below
        return damaged("cannot be decompressed", frame, image_.path);
    }

    bool decode(std::span<const std::byte> packed, std::span<std::byte> samples) const {
        gdcm::Fragment fragment;
        fragment.SetByteValue(reinterpret_cast<const char*>(packed.data()), static_cast<std::uint32_t>(packed.size()));
        const gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;
        fragments->AddFragment(fragment);
        gdcm::DataElement element(gdcm::Tag(0x7fe0, 0x0010));
        element.SetVR(gdcm::VR::OB);
        element.SetValue(*fragments);
        gdcm::Image decoder;
        decoder.SetNumberOfDimensions(2);
        decoder.SetDimension(0, static_cast<unsigned>(pixels_.columns));
        decoder.SetDimension(1, static_cast<unsigned>(pixels_.rows));
        const bool isSigned =
            pixels_.type == FileType::I8 || pixels_.type == FileType::I16 || pixels_.type == FileType::I32;
        const auto narrow = [](int value) { return static_cast<unsigned short>(value); };
        decoder.SetPixelFormat(gdcm::PixelFormat(narrow(pixels_.components), narrow(pixels_.bitsAllocated),
                                                 narrow(pixels_.bitsStored), narrow(pixels_.highBit),
                                                 narrow(isSigned)));
        decoder.SetPhotometricInterpretation(photometric());
        decoder.SetTransferSyntax(gdcm::TransferSyntax::GetTSType(pixels_.transferSyntax.c_str()));
        decoder.SetDataElement(element);
        return decoder.GetBufferLength() == samples.size() &&
               decoder.GetBuffer(reinterpret_cast<char*>(samples.data()));
    }

    // Of names that GDCM does not know, or that do not fit, it would make a failed assertion.
    gdcm::PhotometricInterpretation photometric() const {
        using Photometric = gdcm::PhotometricInterpretation;
        const auto known = Photometric::GetPIType(pixels_.photometric.c_str());
        constexpr Photometric::PIType kColours[] = {Photometric::RGB, Photometric::YBR_FULL, Photometric::YBR_FULL_422,
                                                    Photometric::YBR_RCT, Photometric::YBR_ICT};
        if (pixels_.components == 1)
            return Photometric::MONOCHROME2;
        return std::ranges::find(kColours, known) != std::end(kColours) ? known : Photometric::RGB;
    }

    const DicomImage& image_;
    const DicomPixels& pixels_;
    std::shared_ptr<const RandomAccessFile> bytes_;
};

} // namespace

Result<std::vector<std::vector<DicomFragment>>> assignDicomFragments(const RandomAccessFile& bytes,
                                                                     std::span<const DicomFragment> fragments,
                                                                     std::uint64_t frames) {
    using Assigned = std::vector<std::vector<DicomFragment>>;
    const auto parts = fragments.empty() ? fragments : fragments.subspan(1);
    if (frames > parts.size())
        return makeError(ErrorCode::Corruption,
                         "pixel data (7fe0,0010): number of frames (0028,0008) is " + std::to_string(frames) +
                             ", but the file has " + std::to_string(parts.size()) + " fragments of them",
                         bytes.path());
    Assigned assigned(frames);
    if (frames == 1) {
        assigned[0].assign(parts.begin(), parts.end());
        return assigned;
    }
    if (frames == parts.size()) {
        for (std::size_t i = 0; i < parts.size(); ++i)
            assigned[i] = {parts[i]};
        return assigned;
    }
    const Error unclear = makeError(ErrorCode::Corruption,
                                    "pixel data (7fe0,0010): " + std::to_string(parts.size()) +
                                        " fragments cannot be "
                                        "shared out among " +
                                        std::to_string(frames) + " frames",
                                    bytes.path());
    if (fragments[0].sizeBytes != 4 * frames)
        return unclear;
    const auto table = gather(bytes, fragments.first(1), 4 * frames);
    if (!table.isOk())
        return table.error();
    std::size_t frame = 0;
    for (const DicomFragment& part : parts) {
        // Offsets count from the first fragment's head of 8 bytes.
        const std::uint64_t place = part.offset - parts[0].offset;
        while (frame + 1 < frames && littleEndian32(table.value(), 4 * (frame + 1)) <= place)
            ++frame;
        assigned[frame].push_back(part);
    }
    const bool isComplete = std::ranges::none_of(assigned, [](const auto& list) { return list.empty(); });
    return isComplete ? Result<Assigned>(std::move(assigned)) : Result<Assigned>(unclear);
}

Status checkDicomCodestream(const RandomAccessFile& bytes, const DicomPixels& pixels, std::size_t frame,
                            const fs::path& path) {
    const auto& fragments = pixels.fragments[frame];
    std::uint64_t looked = 4096;
    while (true) {
        const auto start = gather(bytes, fragments, pixels.coding == DicomCoding::Rle ? kRleHeaderBytes : looked);
        if (!start.isOk())
            return start.error();
        if (pixels.coding == DicomCoding::Rle) {
            const auto segments = rleSegments(start.value(), totalBytes(fragments), pixels, frame, path);
            return segments.isOk() ? Status() : Status(segments.error());
        }
        const Codestream stream =
            pixels.coding == DicomCoding::Jpeg2000 ? readJpeg2000Size(start.value()) : readJpegMarkers(start.value());
        if (!stream.isFound && start.value().size() == looked && looked < kMaxMarkerBytes) {
            looked *= 16;
            continue;
        }
        if (!stream.isFound)
            return damaged("is not compressed as the transfer syntax states", frame, path);
        const bool isSameDepth =
            stream.bits <= pixels.bitsAllocated && (stream.bits <= 8) == (pixels.bitsAllocated == 8);
        const bool isSame = stream.rows == pixels.rows && stream.columns == pixels.columns &&
                            stream.components == pixels.components && isSameDepth;
        if (isSame && pixels.frameBytes() / kMostPerByte > totalBytes(fragments))
            return damaged("has " + std::to_string(totalBytes(fragments)) + " bytes, which cannot hold " +
                               std::to_string(pixels.frameBytes()) + " of samples",
                           frame, path);
        if (isSame)
            return {};
        return damaged("is " + std::to_string(stream.columns) + " x " + std::to_string(stream.rows) + " of " +
                           std::to_string(stream.components) + " x " + std::to_string(stream.bits) +
                           " bits, the header states " + std::to_string(pixels.columns) + " x " +
                           std::to_string(pixels.rows) + " of " + std::to_string(pixels.components) + " x " +
                           std::to_string(pixels.bitsAllocated),
                       frame, path);
    }
}

Result<std::unique_ptr<DicomFrameReader>> openDicomFrames(const DicomImage& image, std::uint64_t memoryBytes) {
    auto dataSet = openDicomDataSet(image.path, memoryBytes);
    if (!dataSet.isOk())
        return std::move(dataSet).error();
    const DicomPixels& pixels = image.pixels;
    ISO_TRY(dataSet.value().allow(pixels.offset + image.frames.size() * pixels.frameBytes()));
    return std::unique_ptr<DicomFrameReader>(std::make_unique<FrameReader>(image, dataSet.value().bytes));
}

} // namespace isoslider::io
