#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "core/grid/scalar_key.h"

namespace isoslider::preprocess {

/// Equal bins over the range of values, for the histogram and the curves of an index. In the histogram bin b
/// begins at the least sample s with 512 (s - min) / (max - min) >= b, the last one holds max too. Curves are
/// taken at isovalues min + b (max - min) / 512, which rounding may put on the other side of a sample.
template <class Sample>
class ValueBins {
public:
    static constexpr std::size_t kCount = 512;
    using Key = KeyOf<Sample>;

    ValueBins() = default;
    /// REQUIRES: min <= max, both finite samples.
    ValueBins(Sample min, Sample max)
        : min_(static_cast<double>(min) * 0.5), range_(static_cast<double>(max) * 0.5 - min_) {
        scale_ = range_ > 0.0 ? static_cast<double>(kCount) / range_ : 0.0;
        for (std::size_t b = 0; b < kCount; ++b) {
            const double at = static_cast<double>(b) / static_cast<double>(kCount);
            thresholds_[b] = thresholdOf<Sample>(static_cast<double>(min) * (1.0 - at) + static_cast<double>(max) * at);
        }
        starts_.fill(max);
        if (range_ > 0.0)
            starts_[0] = min;
        for (std::size_t b = 1; b < kCount && range_ > 0.0; ++b) {
            // Invariant: low is in a bin before b, high is not.
            std::uint64_t low = keyOf(min), high = keyOf(max);
            while (high - low > 1) {
                const std::uint64_t middle = low + (high - low) / 2;
                (exactBinOf(sampleOfKey<Sample>(static_cast<Key>(middle))) < b ? low : high) = middle;
            }
            starts_[b] = sampleOfKey<Sample>(static_cast<Key>(high));
        }
        for (std::size_t b = 0; b < kCount; ++b) {
            const auto differs = [&](std::size_t i) {
                return i > 0 && i < kCount && thresholds_[i] != keyOf(starts_[i]);
            };
            isCurveOff_[b] = !(range_ > 0.0) || differs(b) || differs(b + 1);
        }
    }

    /// REQUIRES: finite, within the range.
    std::size_t binOf(Sample sample) const { return corrected(sample, guess(sample)); }
    /// The bins of a row, in vectors but for what rounding has put beside the right one.
    template <std::size_t kLength>
    void binsOf(const Sample* row, std::array<std::int32_t, kLength>& bins) const {
        for (std::size_t x = 0; x < kLength; ++x)
            bins[x] = guess(row[x]);
        for (std::size_t x = 0; x < kLength; ++x)
            bins[x] = static_cast<std::int32_t>(corrected(row[x], bins[x]));
    }
    /// Where the curves are taken.
    KeyThreshold threshold(std::size_t bin) const { return thresholds_[bin]; }
    /// The last threshold that is not above the sample; `bin` is the sample's.
    std::size_t curveBinOf(Sample sample, std::size_t bin) const {
        if (!isCurveOff_[bin])
            return bin;
        const auto above = std::upper_bound(thresholds_.begin(), thresholds_.end(), KeyThreshold{keyOf(sample)});
        return above == thresholds_.begin() ? 0 : static_cast<std::size_t>(above - thresholds_.begin()) - 1;
    }

private:
    // A product instead of a quotient, which rounding may leave a bin away, and which is not a number where the
    // range is among the least there are.
    std::int32_t guess(Sample sample) const {
        const double place = (static_cast<double>(sample) * 0.5 - min_) * scale_;
        return static_cast<std::int32_t>(place > 0.0 ? (place < kLast ? place : kLast) : 0.0);
    }
    std::size_t corrected(Sample sample, std::int32_t guessed) const {
        auto bin = static_cast<std::size_t>(guessed);
        if (!(range_ > 0.0))
            return 0;
        while (bin > 0 && sample < starts_[bin])
            --bin;
        while (bin + 1 < kCount && sample >= starts_[bin + 1])
            ++bin;
        return bin;
    }
    // Halves: max - min may overflow.
    std::size_t exactBinOf(Sample sample) const {
        const double share = (static_cast<double>(sample) * 0.5 - min_) / range_;
        return std::min(kCount - 1, static_cast<std::size_t>(share * static_cast<double>(kCount)));
    }

    static constexpr double kLast = kCount - 1;

    double min_ = 0.0, range_ = 0.0, scale_ = 0.0;
    std::array<Sample, kCount> starts_{};
    std::array<KeyThreshold, kCount> thresholds_{};
    std::array<bool, kCount> isCurveOff_{}; ///< a threshold beside the bin is not where the bin begins or ends
};

} // namespace isoslider::preprocess
