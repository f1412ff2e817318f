#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "core/volume_io/parsing/byte_stream.h"
#include "core/volume_io/parsing/file_type.h"
#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::io {

/// value = slope * sample + intercept.
struct Rescale {
    double slope = 1.0;
    double intercept = 0.0;
};

/// Values in a byte stream: those of one sample beside each other, x fastest.
struct SampleLayout {
    FileType type = FileType::U8;
    bool isBigEndian = false;
    std::optional<Rescale> rescale; ///< makes integers f32, those of 32 bits f64
    int components = 1; ///< values per sample
    int component = 0; ///< the one to take, or kMagnitude: f32, or f64 of values beyond 16 bits or f32
    std::uint64_t firstValue = 0; ///< values in the stream before the first sample
};

/// Bytes of a plane of samples in a file, all components of them.
std::uint64_t planeBytes(const VolumeField& field, FileType type);

/// Samples of a byte stream, swapped, widened and rescaled slab by slab. `info.type` is set here.
/// REQUIRES: the stream holds that many values; component is one of those, or kMagnitude.
std::unique_ptr<VolumeSource> makeSampleSource(VolumeInfo info, SampleLayout layout, std::unique_ptr<ByteStream> bytes,
                                               std::filesystem::path path);

} // namespace isoslider::io
