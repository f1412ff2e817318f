#include <cstring>

#include "core/base/byte_codec.h"
#include "core/volume_io/formats/dicom/dicom_image.h"
#include "tests/fuzz/fuzz_support.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/volume_promises.h"

// Formats of which every byte is ours to read. Each input is a file; those that are read in two have the second beside
// them.

namespace isoslider::fuzz {
namespace {

// Headers may name these instead of holding their samples.
void writeDataFiles() {
    static const bool areWritten = [] {
        std::vector<std::byte> bytes(4096);
        for (std::size_t i = 0; i < bytes.size(); ++i)
            bytes[i] = static_cast<std::byte>(i * i / 64);
        for (const char* name : {"data.raw", "data1.raw", "data2.raw"})
            writeInput(name, bytes);
        return true;
    }();
    (void)areWritten;
}

bool isGzip(std::span<const std::byte> bytes) {
    return bytes.size() >= 2 && bytes[0] == std::byte{0x1f} && bytes[1] == std::byte{0x8b};
}

} // namespace

void fuzzMetaImage(std::span<const std::byte> bytes) {
    writeDataFiles();
    requireVolumePromises(io::openMetaImage, io::listMetaImage, writeInput("input.mha", bytes));
}

void fuzzNrrd(std::span<const std::byte> bytes) {
    writeDataFiles();
    requireVolumePromises(io::openNrrd, io::listNrrd, writeInput("input.nrrd", bytes));
}

void fuzzMrc(std::span<const std::byte> bytes) {
    requireVolumePromises(io::openMrc, io::listMrc, writeInput(isGzip(bytes) ? "input.mrc.gz" : "input.mrc", bytes));
}

void fuzzCube(std::span<const std::byte> bytes) {
    requireVolumePromises(io::openCube, io::listCube,
                          writeInput(isGzip(bytes) ? "input.cube.gz" : "input.cube", bytes));
}

/// A .nii or .nii.gz. What is not marked as one file is taken for a pair, as Analyze is: the samples follow a header
/// of 348 bytes.
void fuzzNifti(std::span<const std::byte> bytes) {
    constexpr std::size_t kHeaderBytes = 348, kMagicAt = 344;
    if (isGzip(bytes))
        return requireVolumePromises(io::openNifti, io::listNifti, writeInput("input.nii.gz", bytes));
    const bool isPair = bytes.size() >= kHeaderBytes && std::memcmp(bytes.data() + kMagicAt, "n+1", 3) != 0 &&
                        std::memcmp(bytes.data() + 4, "n+2", 3) != 0;
    if (!isPair)
        return requireVolumePromises(io::openNifti, io::listNifti, writeInput("input.nii", bytes));
    writeInput("pair.img", bytes.subspan(kHeaderBytes));
    requireVolumePromises(io::openNifti, io::listNifti, writeInput("pair.hdr", bytes.first(kHeaderBytes)));
}

/// A layout of 20 bytes, then the file: dims (6), type, byte order, bytes to skip (2), three spacings of two bytes,
/// flags.
void fuzzRaw(std::span<const std::byte> bytes) {
    ByteReader in(bytes);
    io::RawLayout layout;
    for (auto& size : layout.dims)
        size = in.get<std::int16_t>();
    layout.type = kAllScalarTypes[in.get<std::uint8_t>() % kAllScalarTypes.size()];
    layout.isBigEndian = (in.get<std::uint8_t>() & 1) != 0;
    layout.skipBytes = in.get<std::uint16_t>();
    for (int axis = 0; axis < 3; ++axis)
        layout.spacing[axis] = in.get<std::int16_t>() / 256.0;
    io::ReadOptions options;
    const auto flags = in.get<std::uint8_t>();
    if ((flags & 1) != 0) // far too large ones
        for (auto& size : layout.dims)
            size <<= 40;
    if ((flags & 2) != 0)
        layout.skipBytes = ~std::uint64_t{0} - layout.skipBytes;
    options.allowsTrailing = (flags & 4) != 0;
    options.raw = layout;
    requireVolumePromises(io::openRaw, nullptr, writeInput("input.raw", in.getBytes(in.remaining())), options);
}

/// Frames that are not compressed, or by run lengths, are read here; all others GDCM decodes.
void fuzzDicom(std::span<const std::byte> bytes) {
    const auto path = writeInput("input.dcm", bytes);
    const auto image = io::readDicomImage(path);
    if (!image.isOk())
        return requireGoodError(image.error());
    ISO_REQUIRE(!image.value().frames.empty(), path.string());
    const io::DicomCoding coding = image.value().pixels.coding;
    if (coding == io::DicomCoding::Native || coding == io::DicomCoding::Rle)
        requireVolumePromises(io::openDicom, io::listDicom, path);
}

/// libtiff decodes, but reads nothing that has not passed our checks of its directories.
void fuzzTiff(std::span<const std::byte> bytes) {
    requireVolumePromises(io::openTiff, io::listTiff, writeInput("input.tif", bytes));
}

} // namespace isoslider::fuzz
