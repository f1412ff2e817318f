#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/extract/live/brick_bits.h"
#include "core/grid/normal_codec.h"
#include "core/grid/scalar_key.h"
#include "core/grid/scalar_type.h"

namespace isoslider::extract {

/// What samples of live bricks are kept as: in the order of their keys, as small as the type allows, with comparisons
/// that vector units have. Integers of up to 16 bits are their keys, others are themselves.
template <class Sample>
using StoredSample = std::conditional_t<sizeof(Sample) == 1, std::uint8_t,
                                        std::conditional_t<sizeof(Sample) == 2, std::uint16_t, Sample>>;

template <class Sample>
inline StoredSample<Sample> storedOf(Sample sample) {
    if constexpr (sizeof(Sample) <= 2)
        return static_cast<StoredSample<Sample>>(keyOf(sample));
    else
        return sample;
}

template <class Sample>
inline Sample sampleOf(StoredSample<Sample> stored) {
    if constexpr (sizeof(Sample) <= 2)
        return sampleOfKey<Sample>(stored);
    else
        return stored;
}

/// The stored sample from which on points are above. REQUIRES: some sample of the type has a key >= threshold.
template <class Sample>
inline StoredSample<Sample> storedThreshold(KeyThreshold threshold) {
    if constexpr (sizeof(Sample) <= 2)
        return static_cast<StoredSample<Sample>>(threshold);
    else
        return sampleOfKey<Sample>(static_cast<KeyOf<Sample>>(threshold));
}

/// A closed brick's points in whole vectors of up to 32. Those behind the last hold a sample of the brick.
inline constexpr int kKeptPoints = (kClosedPoints + 31) / 32 * 32;

/// The points of a live brick: what its vertices are made from. Which of them hold anything is known to who fills it:
/// those at the ends of edges that carry vertices do.
template <class Sample>
struct alignas(64) BrickPoints {
    StoredSample<Sample> samples[kKeptPoints];
    NormalCode normals[kKeptPoints];
};

/// Points of any sample type are kept as lines of 64 bytes.
struct alignas(64) PointLine {
    std::byte bytes[64];
};
template <class Sample>
const PointLine* linesOf(const BrickPoints<Sample>& points) {
    return reinterpret_cast<const PointLine*>(&points);
}
/// REQUIRES: they are lines of points of samples of this type.
template <class Sample>
const BrickPoints<Sample>& pointsIn(const PointLine* lines) {
    return *reinterpret_cast<const BrickPoints<Sample>*>(lines);
}

template <class Sample>
BrickPoints<Sample>& pointsIn(PointLine* lines) {
    return *reinterpret_cast<BrickPoints<Sample>*>(lines);
}

constexpr std::uint32_t pointLineCount(std::size_t sampleBytes) {
    return static_cast<std::uint32_t>(((sampleBytes + sizeof(NormalCode)) * kKeptPoints + sizeof(PointLine) - 1) /
                                      sizeof(PointLine));
}
static_assert(pointLineCount(1) * sizeof(PointLine) == sizeof(BrickPoints<std::uint8_t>));
static_assert(pointLineCount(2) * sizeof(PointLine) == sizeof(BrickPoints<std::int16_t>));
static_assert(pointLineCount(8) * sizeof(PointLine) == sizeof(BrickPoints<double>));

} // namespace isoslider::extract
