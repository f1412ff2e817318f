#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/base/file_system.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::model {

/// How samples are laid out on disk, but for their dims.
struct SampleFormat {
    ScalarType type = ScalarType::U8;
    bool isBigEndian = false;
    std::uint64_t skipBytes = 0; ///< before the first sample

    bool operator==(const SampleFormat&) const = default;
};

/// How smooth a file's bytes are when they are read in one way. In the right way, neighbours are alike: what
/// shows the type, the byte order and the length of rows and planes. Looks at some 100 places of the file,
/// whatever its size. Samples are compared by rank, where wild values decide nothing, and by value, where the
/// noise of a background decides nothing. Worker thread.
///
/// Not the measure that the reader's doubt of a byte order rests on (core/volume_io/formats/raw_reader.cpp): that one
/// has no scale, looks at neighbours only and at one place. It costs a read of 64 KiB, and no file is opened without
/// it.
class RawSmoothness {
public:
    /// `file` must outlive this.
    RawSmoothness(const RandomAccessFile& file, const SampleFormat& format);

    const SampleFormat& format() const { return format_; }
    std::uint64_t samples() const { return samples_; } ///< whole ones behind the skipped bytes
    /// False if reading failed or there are too few samples: then everything is as rough as noise.
    bool isUsable() const { return spread_.rank > 0.0 && spread_.value > 0.0; }
    /// Mean difference of samples `lag` apart, as a share of that of any two: 0 is smooth, 1 is noise.
    double roughness(std::uint64_t lag);
    /// Of the samples looked at: greatest less least, of the finite ones.
    double range() const { return range_; }
    /// Share of the samples looked at that a volume would hardly hold: infinite, or of absurd magnitude.
    double implausibleShare() const { return implausibleShare_; }

private:
    /// Of a sample: where it stands among all, and its value as a share of the usual range, both 0 to 1. Of
    /// pairs: mean differences of those.
    struct Place {
        double rank = 0.0;
        double value = 0.0;
    };
    struct MeanDifference;

    std::vector<double> read(std::uint64_t first, std::uint64_t count) const;
    Place placeOf(double value) const;
    void choosePlaces();
    void measure(const std::vector<double>& values);

    const RandomAccessFile& file_;
    SampleFormat format_;
    std::uint64_t samples_ = 0;
    std::vector<std::uint64_t> places_; ///< first samples of the runs looked at
    std::vector<std::vector<Place>> runs_; ///< there
    std::vector<double> sorted_; ///< what ranks are found in
    double low_ = 0.0; ///< of the usual range
    double high_ = 0.0;
    Place spread_; ///< mean difference of any two samples
    double range_ = 0.0;
    double implausibleShare_ = 0.0;
    std::map<std::uint64_t, double> known_; ///< roughness by lag
};

} // namespace isoslider::model
