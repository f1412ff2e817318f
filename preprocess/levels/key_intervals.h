#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/grid/scalar_key.h"

namespace isoslider::preprocess {

/// A key and how many grid points have it: exactly, or estimated from a sample of the points.
struct KeyCount {
    std::uint64_t key = 0;
    std::uint64_t points = 0;
};

/// Counts of keys, in bounded memory, as a basis for dividing the keys into intervals. Exact where there are
/// at most kMaxExactKeys different ones; otherwise from a sample of about kMaxSampleKeys points, all of them when
/// there are fewer. Which points are sampled depends on their order only, so the same field gives the same counts
/// in every scalar type: keys keep the order of samples, and their distances are never looked at.
template <class Key>
class KeyCounter {
public:
    static constexpr std::size_t kMaxExactKeys = 1024;
    static constexpr std::uint64_t kMaxSampleKeys = std::uint64_t{1} << 20;

    /// `mostKeys`: upper bound of the keys that will be added.
    explicit KeyCounter(std::uint64_t mostKeys);

    void add(Key key) {
        if (isExact_)
            countExactly(key);
        if (position_++ == nextSample_)
            takeSample(key);
    }
    /// Ascending by key. Call once, when all keys have been added.
    std::vector<KeyCount> takeCounts();

private:
    static constexpr std::size_t kSlots = 4 * kMaxExactKeys;

    void countExactly(Key key);
    void takeSample(Key key);

    std::uint64_t stride_;
    std::uint64_t position_ = 0;
    std::uint64_t nextSample_ = 0;
    std::vector<Key> sample_;
    bool isExact_ = true;
    std::size_t exactKeys_ = 0;
    std::vector<KeyCount> slots_ = std::vector<KeyCount>(kSlots); ///< a hash table; free where points is 0
};

extern template class KeyCounter<std::uint16_t>;
extern template class KeyCounter<std::uint32_t>;
extern template class KeyCounter<std::uint64_t>;

/// All keys, divided into intervals. Interval i holds the keys in [begin(i), begin(i + 1)), the last one to the end.
class KeyIntervals {
public:
    /// REQUIRES: ascending, all different, the first 0, at most 65535.
    explicit KeyIntervals(std::vector<std::uint64_t> begins);

    std::size_t count() const { return begins_.size(); }
    std::uint64_t begin(std::size_t interval) const { return begins_[interval]; }
    /// The interval of a key. O(1) where keys are spread evenly, O(log count) at worst.
    std::size_t find(std::uint64_t key) const {
        if (key < low_)
            return 0;
        const std::size_t slot = std::min<std::uint64_t>((key - low_) >> shift_, kSlots - 1);
        const auto first = begins_.begin() + firstOfSlot_[slot], last = begins_.begin() + firstOfSlot_[slot + 1] + 1;
        return static_cast<std::size_t>(std::upper_bound(first, last, key) - begins_.begin()) - 1;
    }
    bool hasOneKey(std::size_t interval) const {
        return interval + 1 < begins_.size() && begins_[interval + 1] - begins_[interval] == 1;
    }

private:
    static constexpr std::size_t kSlots = 4096;

    std::vector<std::uint64_t> begins_;
    std::uint64_t low_ = 0; ///< begin of interval 1: what is below is in interval 0
    int shift_ = 0;
    /// By (key - low) >> shift: the interval of the slot's first key; one more for the end.
    std::vector<std::uint16_t> firstOfSlot_ = std::vector<std::uint16_t>(kSlots + 1);
};

} // namespace isoslider::preprocess
