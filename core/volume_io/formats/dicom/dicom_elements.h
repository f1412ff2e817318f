#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/file_system.h"

// The elements of a DICOM data set, walked within bounds and without memory for what is not asked for. GDCM
// decodes the frames, but it would take memory for each length as the file states it, before it looks at the
// file's size.

namespace isoslider::io {

using DicomTag = std::uint32_t; ///< group << 16 | element

/// "(0028,0010)".
std::string dicomTagText(DicomTag tag);

enum class DicomKind {
    Text, ///< all character strings, blanks and zeros at the end taken off
    Decimal, ///< numbers in text, between backslashes (DS, IS)
    Unsigned16,
    Integer16, ///< signed if the file reports it (US or SS)
    Unsigned32,
    Real32,
    Real64,
    Sequence,
};

/// The item of a sequence that an element is inside of.
struct DicomItem {
    DicomTag sequence = 0;
    std::size_t index = 0;
};

struct DicomValue {
    std::string text; ///< of Text
    std::vector<double> numbers; ///< of all other kinds; empty where text is no number
};

/// Samples, native or in fragments, as the data set holds them.
struct DicomPixelData {
    DicomTag tag = 0;
    std::uint64_t offset = 0; ///< of the value, in the data set's bytes
    std::uint64_t sizeBytes = 0; ///< as stated; of fragments: up to the end of the file
    bool isEncapsulated = false;
    bool isWords = false; ///< VR OW: bytes in pairs
};

/// Receives the elements. One that is not wanted is skipped.
class DicomSink {
public:
    virtual ~DicomSink() = default;
    /// What to do with an element: null to step over it.
    virtual const DicomKind* wants(std::span<const DicomItem> place, DicomTag tag) = 0;
    virtual void take(std::span<const DicomItem> place, DicomTag tag, DicomValue value) = 0;
};

/// The start of a data set and how its elements are written.
struct DicomDataSet {
    std::shared_ptr<const RandomAccessFile> bytes; ///< the file, or what it unpacks to
    std::uint64_t memoryBytes = 0; ///< that of ReadOptions
    std::uint64_t begin = 0;
    std::string transferSyntax; ///< empty: the file does not state
    bool isExplicit = true; ///< value representations are written out
    bool isBigEndian = false;

    /// Lets the first `end` bytes of a deflated data set be unpacked, which by itself are bounded.
    Status allow(std::uint64_t end) const;
};

/// True of a file that begins as DICOM does, with or without a preamble. `start`: up to its first 512 bytes.
bool looksLikeDicom(std::span<const std::byte> start);

/// Reads the file meta information and finds out how the rest is written.
/// Errors: InvalidArgument (not DICOM), Corruption, IoError.
Result<DicomDataSet> openDicomDataSet(const std::filesystem::path& path, std::uint64_t memoryBytes = 0);

/// Walks the elements up to the samples. Those of sequences are given when the sink wants the sequence.
/// Errors: Corruption (an element leads out of the file, or of the sequence it is in), InvalidArgument (no
/// samples).
Result<DicomPixelData> walkDicomElements(const DicomDataSet& dataSet, DicomSink& sink);

/// A stretch of the data set's bytes.
struct DicomFragment {
    std::uint64_t offset = 0;
    std::uint64_t sizeBytes = 0;
};

/// Fragments of encapsulated samples; the first is the table of offsets. Errors: Corruption, IoError.
Result<std::vector<DicomFragment>> findDicomFragments(const DicomDataSet& dataSet, const DicomPixelData& samples);

} // namespace isoslider::io
