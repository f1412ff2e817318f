#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/volume_io/formats/dicom/dicom_elements.h"
#include "core/volume_io/sources/sample_source.h"

namespace isoslider::io {

/// How the samples of a frame are written.
enum class DicomCoding { Native, Rle, Jpeg, JpegLs, Jpeg2000 };

/// One frame's samples, and where the frames are.
struct DicomPixels {
    std::int64_t rows = 0;
    std::int64_t columns = 0;
    int components = 1;
    int bitsAllocated = 16; ///< 1, 8, 16, 32 or, of floating samples, 64
    int bitsStored = 16;
    int highBit = 15;
    FileType type = FileType::U16; ///< with 1 bit allocated: U8
    bool isPlanar = false; ///< red, green and blue each in a separate plane
    bool isPairSwapped = false; ///< 8-bit samples in big-endian words
    std::string photometric; ///< "MONOCHROME2"
    std::string transferSyntax;
    DicomCoding coding = DicomCoding::Native;
    bool isBigEndian = false;
    std::uint64_t offset = 0; ///< of native samples
    std::vector<std::vector<DicomFragment>> fragments; ///< of encapsulated ones: those of each frame

    std::uint64_t frameBytes() const {
        const auto bits =
            static_cast<std::uint64_t>(rows * columns * components) * static_cast<std::uint64_t>(bitsAllocated);
        return (bits + 7) / 8;
    }
};

/// What distinguishes images at one place, in the order in which it is tried.
enum class DicomSplit {
    Time,
    EchoNumber,
    EchoTime,
    BValue,
    Gradient,
    FrameType,
    Segment,
    Trigger,
    Acquisition,
    Energy,
    Count
};
/// "times", "echoes".
std::string_view dicomSplitName(DicomSplit split);

/// What may differ from frame to frame. Lengths in mm, positions left-posterior-superior.
struct DicomFrame {
    std::optional<glm::dvec3> position; ///< centre of the first sample
    std::optional<std::array<glm::dvec3, 2>> directions; ///< along a row, along a column
    std::optional<glm::dvec2> spacing; ///< between columns, between rows
    std::optional<double> thickness, sliceSpacing;
    std::optional<double> slope, intercept;
    std::string stack;
    std::array<std::string, static_cast<std::size_t>(DicomSplit::Count)> splits;
};

/// What one file states of its images, samples not read.
struct DicomImage {
    std::filesystem::path path;
    std::string series, instanceUid, description, modality, date;
    std::int64_t seriesNumber = 0, instance = 0;
    DicomPixels pixels;
    std::vector<DicomFrame> frames; ///< at least one
    bool hasFramePositions = false; ///< or all frames state the same
    std::vector<std::string> notes;
};

/// Reads and checks everything but the samples: that they are all there, and of compressed ones that their
/// own headers state the same size. Memory in proportion to the number of frames the file really holds. Errors:
/// InvalidArgument (no image, or none of a kind that is read), Corruption, IoError.
Result<DicomImage> readDicomImage(const std::filesystem::path& path, std::uint64_t memoryBytes = 0);

} // namespace isoslider::io
