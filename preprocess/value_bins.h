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
    ValueBins(Sample min, Sample max) : min_(static_cast<double>(min) * 0.5), range_(static_cast<double>(max) * 0.5 - min_) {
        scale_ = range_ > 0.0 ? static_cast<double>(kCount) / range_ : 0.0;
        for (std::size_t b = 0; b < kCount; ++b) {
            const double at = static_cast<double>(b) / static_cast<double>(kCount);
            thresholds_[b] = thresholdOf<Sample>(static_cast<double>(min) * (1.0 - at) + static_cast<double>(max) * at);
        }
        starts_.fill(max);
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
    }

    /// REQUIRES: finite, within the range.
    std::size_t binOf(Sample sample) const {
        if (!(range_ > 0.0))
            return 0;
        // A product instead of a quotient, which rounding may leave a bin away.
        const double place = (static_cast<double>(sample) * 0.5 - min_) * scale_;
        std::size_t bin = place > 0.0 ? std::min(kCount - 1, static_cast<std::size_t>(place)) : 0;
        while (bin > 0 && sample < starts_[bin])
            --bin;
        while (bin + 1 < kCount && sample >= starts_[bin + 1])
            ++bin;
        return bin;
    }
    /// Where the curves are taken.
    KeyThreshold threshold(std::size_t bin) const { return thresholds_[bin]; }
    /// The last threshold that is not above the sample; `bin` is the sample's.
    std::size_t curveBinOf(Sample sample, std::size_t bin) const {
        const KeyThreshold key = keyOf(sample);
        while (bin > 0 && key < thresholds_[bin])
            --bin;
        while (bin + 1 < kCount && key >= thresholds_[bin + 1])
            ++bin;
        return bin;
    }

private:
    // Halves: max - min may overflow.
    std::size_t exactBinOf(Sample sample) const {
        const double share = (static_cast<double>(sample) * 0.5 - min_) / range_;
        return std::min(kCount - 1, static_cast<std::size_t>(share * static_cast<double>(kCount)));
    }

    double min_ = 0.0, range_ = 0.0, scale_ = 0.0;
    std::array<Sample, kCount> starts_{};
    std::array<KeyThreshold, kCount> thresholds_{};
};

} // namespace isoslider::preprocess
