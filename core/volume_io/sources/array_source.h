#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/volume_io/sources/sample_source.h"

namespace isoslider::io {

/// An array of any rank in a file, read in blocks by the library of its format.
class ArrayReader {
public:
    virtual ~ArrayReader() = default;
    /// Fills `out` with the block that begins at `start` and has `count` samples along each axis of the file, the
    /// last axis fastest, in this machine's byte order.
    virtual Status read(std::span<const std::uint64_t> start, std::span<const std::uint64_t> count,
                        std::span<std::byte> out) = 0;
};

/// Which part of an array is the volume.
struct ArrayView {
    FileType type = FileType::F32; ///< as the reader gives samples
    std::vector<std::uint64_t> start; ///< one per axis of the file: the place on the axes that are none of x, y, z
    std::array<int, 3> axisOf{-1, -1, -1}; ///< the file's axis that is x, y, z; -1: none, one sample
    std::array<bool, 3> isFlipped{}; ///< the file runs the other way
};

/// Which samples are missing, and what the others mean.
struct ArrayMeaning {
    std::vector<double> missing; ///< stored values that stand for none; NaN always does
    std::optional<double> low, high; ///< stored values beyond are missing
    std::optional<Rescale> rescale; ///< of stored values
    bool isRescaleWide = false; ///< the rescaled values are f64, else f32

    bool hasMissing() const { return !missing.empty() || low || high; }
};

/// The type of the samples that makeArraySource gives: that of the file, but f32 or f64 where values are rescaled, and
/// where integers may be missing: f32 for those of up to 16 bits, else f64, which hold them exactly.
ScalarType arrayType(FileType type, const ArrayMeaning& meaning);

/// Samples of an array, x fastest, missing ones NaN. Blocks of a bounded size are read; if z is the file's slowest
/// axis, only the planes asked for. `info.type` is set here, `info.geometry.dims` states how many samples along x, y,
/// z; `memoryBytes` is that of ReadOptions. REQUIRES: the array is that large. Errors of readSlab: those of the reader;
/// InvalidArgument (a 64-bit integer without an exact f64).
std::unique_ptr<VolumeSource> makeArraySource(VolumeInfo info, ArrayView view, ArrayMeaning meaning,
                                              std::unique_ptr<ArrayReader> reader, std::filesystem::path path,
                                              std::uint64_t memoryBytes);

} // namespace isoslider::io
