#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/grid/scalar_key.h"

namespace isoslider {

template <class Key>
class DistinctKeySet;

/// The exact number of distinct finite values of a stream of samples, -0 and +0 being one value, within a bound on
/// memory. Values that do not fit are postponed, and the same samples must be added once more for these:
///
///     do {
///         ... add() all samples, in any order, cut and shared among threads in any way ...
///     } while (!distinct.endPass());
///     n = distinct.count();
///
/// The result depends on the set of samples only; the number of passes on threads, too. 8- and 16-bit samples never
/// need another pass. 32-bit values take 128 KB for each of 4096 equal parts of their range that occurs, 512 MB at
/// most; f64 samples 8 to 24 bytes for each distinct one. Beyond the bound, which is 1 MB at
/// least: 0.5 MB for each thread that adds, once what 1/1024 of the values takes, so that each pass counts some, and
/// for f64 samples twice that for each thread.
template <class Sample>
class DistinctKeys {
public:
    explicit DistinctKeys(std::uint64_t memoryBytes);
    ~DistinctKeys();
    DistinctKeys(const DistinctKeys&) = delete;
    DistinctKeys& operator=(const DistinctKeys&) = delete;

    /// Any number of threads at once. Some 4096 samples that lie together in the volume serve best.
    void add(std::span<const Sample> samples);
    /// True when all values are counted. REQUIRES: no thread is in add(), and all samples were added in this pass.
    bool endPass();
    /// Values counted so far.
    std::uint64_t count() const;

private:
    std::unique_ptr<DistinctKeySet<KeyOf<Sample>>> set_;
};

#define ISO_DECLARE(Sample, Name) extern template class DistinctKeys<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_DECLARE)
#undef ISO_DECLARE

} // namespace isoslider
