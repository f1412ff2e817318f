#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/volume_io/formats/dicom/dicom_image.h"

namespace isoslider::io {

/// Which fragments make which frame: one each, all of them one frame, or as the table of offsets (the first
/// fragment) states. Errors: Corruption (none of these).
Result<std::vector<std::vector<DicomFragment>>> assignDicomFragments(const RandomAccessFile& bytes,
                                                                     std::span<const DicomFragment> fragments,
                                                                     std::uint64_t frames);

/// Compares what a compressed frame states of itself with `pixels`: its decoder would believe the frame.
/// Errors: Corruption (other extents, depth or components, or no such header), IoError.
Status checkDicomCodestream(const RandomAccessFile& bytes, const DicomPixels& pixels, std::size_t frame,
                            const std::filesystem::path& path);

/// Reads frames of one file, which stays open. One thread at a time.
class DicomFrameReader {
public:
    virtual ~DicomFrameReader() = default;
    /// Samples of one frame in the machine's byte order, those of a row beside each other, components as
    /// `isPlanar()` states; bits that are not stored are cleared, or repeat the sign. Errors: Corruption,
    /// IoError.
    virtual Status read(std::size_t frame, std::vector<std::byte>& samples) = 0;
    /// Each component in a separate plane, not beside each other.
    virtual bool isPlanar() const = 0;
};

/// `memoryBytes` is that of ReadOptions. REQUIRES: `image` outlives the reader.
Result<std::unique_ptr<DicomFrameReader>> openDicomFrames(const DicomImage& image, std::uint64_t memoryBytes = 0);

} // namespace isoslider::io
