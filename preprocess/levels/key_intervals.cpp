#include "preprocess/levels/key_intervals.h"

#include <bit>
#include <limits>

#include "core/base/check.h"

namespace isoslider::preprocess {
namespace {

std::uint64_t spread(std::uint64_t value) {
    value *= 0x9e3779b97f4a7c15u;
    return value ^ value >> 32;
}

} // namespace

template <class Key>
KeyCounter<Key>::KeyCounter(std::uint64_t mostKeys) : stride_(mostKeys / kMaxSampleKeys + 1) {
    sample_.reserve(static_cast<std::size_t>(mostKeys / stride_ + 1));
}

template <class Key>
void KeyCounter<Key>::countExactly(Key key) {
    std::size_t slot = spread(key) % kSlots;
    while (slots_[slot].points > 0 && slots_[slot].key != key)
        slot = (slot + 1) % kSlots;
    if (slots_[slot].points == 0 && exactKeys_++ == kMaxExactKeys) {
        isExact_ = false;
        return;
    }
    slots_[slot].key = key;
    ++slots_[slot].points;
}

// One point of each run of `stride_`, at a place that does not repeat from run to run: a volume's rows do.
template <class Key>
void KeyCounter<Key>::takeSample(Key key) {
    sample_.push_back(key);
    nextSample_ = sample_.size() * stride_ + spread(sample_.size()) % stride_;
}

template <class Key>
std::vector<KeyCount> KeyCounter<Key>::takeCounts() {
    std::vector<KeyCount> counts;
    if (isExact_) {
        for (const KeyCount& slot : slots_)
            if (slot.points > 0)
                counts.push_back(slot);
        std::sort(counts.begin(), counts.end(), [](const KeyCount& a, const KeyCount& b) { return a.key < b.key; });
        return counts;
    }
    std::sort(sample_.begin(), sample_.end());
    for (const Key key : sample_) {
        if (counts.empty() || counts.back().key != key)
            counts.push_back({key, 0});
        counts.back().points += stride_;
    }
    std::vector<Key>().swap(sample_);
    return counts;
}

template class KeyCounter<std::uint16_t>;
template class KeyCounter<std::uint32_t>;
template class KeyCounter<std::uint64_t>;

KeyIntervals::KeyIntervals(std::vector<std::uint64_t> begins) : begins_(std::move(begins)) {
    ISO_CHECK(!begins_.empty() && begins_.front() == 0 && begins_.size() <= std::numeric_limits<std::uint16_t>::max());
    low_ = begins_.size() > 1 ? begins_[1] : std::numeric_limits<std::uint64_t>::max();
    const std::uint64_t range = begins_.size() > 1 ? begins_.back() - low_ : 0;
    shift_ = std::max(0, static_cast<int>(std::bit_width(range)) - std::countr_zero(kSlots));
    for (std::size_t slot = 0; slot < kSlots; ++slot) {
        const std::uint64_t first = low_ + std::min(static_cast<std::uint64_t>(slot) << shift_, range);
        const auto after = std::upper_bound(begins_.begin(), begins_.end(), first);
        firstOfSlot_[slot] = static_cast<std::uint16_t>(after - begins_.begin() - 1);
    }
    firstOfSlot_[kSlots] = static_cast<std::uint16_t>(begins_.size() - 1);
}

} // namespace isoslider::preprocess
