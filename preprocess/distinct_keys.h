#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/grid/scalar_key.h"

namespace isoslider::preprocess {

template <class Key>
class DistinctKeySet;

/// The exact number of distinct finite values of a stream of samples, -0 and +0 being one value, within a
/// bound on memory. Where the values do not fit, some are postponed, and the same samples must be added once
/// more for these:
///
///     for (;; distinct.beginNextPass()) {
///         ... add() all samples, in any order, cut and shared among threads in any way ...
///         if (!distinct.needsAnotherPass())
///             break;
///     }
///     n = distinct.count();
///
/// The result depends on the set of samples only; the number of passes on threads, too. 8- and 16-bit samples
/// never need another pass. 32-bit values take 8 KB for each upper half that occurs, at most 512 MB, the more
/// often the more threads until half of the bound is reached; f64 samples 8 bytes each, and that of distinct
/// ones alone when the bound is reached. Beyond the bound: some 0.6 MB for each thread that adds.
template <class Sample>
class DistinctKeys {
public:
    /// At least 1 MB is used for f64 samples if need be, and 8 KB for 32-bit ones.
    explicit DistinctKeys(std::uint64_t memoryBytes);
    ~DistinctKeys();
    DistinctKeys(const DistinctKeys&) = delete;
    DistinctKeys& operator=(const DistinctKeys&) = delete;

    /// Any number of threads at once. Some 4096 samples that lie together in the volume serve best.
    void add(std::span<const Sample> samples);

    // The others: REQUIRES: no thread is in add(), and all samples of this pass were added.

    bool needsAnotherPass() const;
    /// REQUIRES: needsAnotherPass().
    void beginNextPass();
    /// Ends the last pass, if that has not been done; takes the time that merging takes, on all threads.
    /// REQUIRES: not needsAnotherPass(), no add() after it.
    std::uint64_t count();

private:
    std::unique_ptr<DistinctKeySet<KeyOf<Sample>>> set_;
};

#define ISO_DECLARE(Sample, Name) extern template class DistinctKeys<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_DECLARE)
#undef ISO_DECLARE

} // namespace isoslider::preprocess
