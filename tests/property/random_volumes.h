#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/property/test_volumes.h"

namespace isoslider::test {

/// Random volumes for the laws that hold for every volume; named, so that a failure can be read.
struct RandomVolume {
    std::shared_ptr<const ScalarGrid> grid;
    std::string description;
    std::vector<double> samples; ///< some finite values of it
    double min = 0.0, max = 0.0; ///< of the finite values; both 0 when there is none
    bool hasFinite = false;
};

enum class Field { Noise, Smooth, Checkerboard, Constant, Holes, Denormal, Extreme, Zeros };
inline constexpr int kFieldCount = 8;

using Random = std::mt19937_64;

inline double unitRandom(Random& random) { return std::uniform_real_distribution<double>(0.0, 1.0)(random); }
inline std::int64_t intRandom(Random& random, std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(random);
}

/// The seed of a test run: ISOSLIDER_TEST_SEED, or the fixed default.
inline std::uint64_t testSeed(std::uint64_t fallback) {
    const char* text = std::getenv("ISOSLIDER_TEST_SEED");
    return text ? std::strtoull(text, nullptr, 10) : fallback;
}

/// Mostly a brick or two, every size from 1 to `longest` possible along each axis.
inline GridGeometry randomGeometry(Random& random, std::int64_t longest) {
    GridGeometry geometry;
    for (int a = 0; a < 3; ++a) {
        switch (intRandom(random, 0, 9)) {
            case 0: geometry.dims[a] = intRandom(random, 1, 2); break;
            case 1: geometry.dims[a] = intRandom(random, 7, 10); break; // at the border of a brick
            case 2: geometry.dims[a] = intRandom(random, 1, longest); break;
            default: geometry.dims[a] = intRandom(random, 2, std::min<std::int64_t>(longest, 18)); break;
        }
        geometry.spacing[a] = std::exp(4.0 * unitRandom(random) - 2.0);
    }
    return geometry;
}

/// A value of the field at a grid point, before it is cast to the sample type.
template <class Sample>
class FieldFunction {
public:
    FieldFunction(Field field, Random& random) : field_(field), random_(random) {
        for (double& f : frequency_)
            f = 0.1 + 0.9 * unitRandom(random);
        levels_ = intRandom(random, 2, 40);
        holeShare_ = unitRandom(random) * 0.3;
    }

    Sample operator()(std::int64_t x, std::int64_t y, std::int64_t z) {
        using Limits = std::numeric_limits<Sample>;
        constexpr bool isFloat = std::is_floating_point_v<Sample>;
        switch (field_) {
            case Field::Noise:
                return static_cast<Sample>(intRandom(random_, 0, levels_) - (Limits::is_signed ? levels_ / 2 : 0));
            case Field::Smooth: return smooth(x, y, z);
            case Field::Checkerboard: return static_cast<Sample>((x + y + z) % 2 == 0 ? 3 : 7);
            case Field::Constant: return Sample(5);
            case Field::Holes:
                if constexpr (isFloat)
                    if (unitRandom(random_) < holeShare_) {
                        constexpr Sample kMissing[3] = {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()};
                        return kMissing[intRandom(random_, 0, 2)];
                    }
                return unitRandom(random_) < 0.5 ? smooth(x, y, z) : static_cast<Sample>(intRandom(random_, 0, 9));
            case Field::Denormal:
                if constexpr (isFloat)
                    return static_cast<Sample>(intRandom(random_, -50, 50)) * Limits::denorm_min();
                return static_cast<Sample>(intRandom(random_, 0, 2));
            case Field::Extreme: {
                constexpr Sample kValues[5] = {Limits::lowest(), Limits::max(), Sample(0), Sample(1),
                                               static_cast<Sample>(Limits::max() / 2)};
                return kValues[intRandom(random_, 0, 4)];
            }
            case Field::Zeros:
                if constexpr (isFloat)
                    return Sample(intRandom(random_, -1, 1)) * (intRandom(random_, 0, 1) ? Sample(1) : Sample(-0.0));
                return static_cast<Sample>(intRandom(random_, 0, 1));
        }
        return Sample(0);
    }

private:
    Sample smooth(std::int64_t x, std::int64_t y, std::int64_t z) const {
        const double wave = std::sin(frequency_[0] * static_cast<double>(x)) +
                            std::sin(frequency_[1] * static_cast<double>(y)) +
                            std::sin(frequency_[2] * static_cast<double>(z) + 0.3 * static_cast<double>(x));
        return static_cast<Sample>(std::is_signed_v<Sample> ? 40.0 * wave : 128.0 + 40.0 * wave);
    }

    Field field_;
    Random& random_;
    double frequency_[3];
    std::int64_t levels_;
    double holeShare_;
};

inline RandomVolume randomVolume(Random& random, std::int64_t longest) {
    static constexpr const char* kFieldNames[kFieldCount] = {"noise", "smooth",   "checkerboard", "constant",
                                                             "holes", "denormal", "extreme",      "zeros"};
    const ScalarType type = kAllScalarTypes[static_cast<std::size_t>(intRandom(random, 0, 6))];
    const GridGeometry geometry = randomGeometry(random, longest);
    const int field = static_cast<int>(intRandom(random, 0, kFieldCount - 1));
    RandomVolume volume;
    visitScalarType(type, [&](auto sample) {
        FieldFunction<decltype(sample)> function(static_cast<Field>(field), random);
        volume.grid = makeVolume<decltype(sample)>(type, geometry, function);
    });
    volume.min = std::numeric_limits<double>::infinity();
    volume.max = -volume.min;
    volume.grid->visit([&](auto values) {
        for (const auto value : values) {
            const double v = static_cast<double>(value);
            if (!std::isfinite(v))
                continue;
            volume.hasFinite = true;
            volume.min = std::min(volume.min, v);
            volume.max = std::max(volume.max, v);
            if (volume.samples.size() < 64 || intRandom(random, 0, 99) == 0)
                volume.samples.push_back(v);
        }
    });
    if (!volume.hasFinite)
        volume.min = volume.max = 0.0;
    std::ostringstream text;
    text << scalarTypeName(type) << " " << kFieldNames[field] << " " << geometry.dims[0] << "x" << geometry.dims[1]
         << "x" << geometry.dims[2];
    volume.description = text.str();
    return volume;
}

/// The next stop of a walk: tiny steps, jumps, sample values and their neighbours, outside the range.
inline double nextIsovalue(const RandomVolume& volume, double current, Random& random) {
    const double share = unitRandom(random);
    const double inside = volume.min * (1.0 - share) + volume.max * share;
    switch (intRandom(random, 0, 11)) {
        case 0: return volume.min - 1.0 - std::abs(volume.min);
        case 1: return volume.max + 1.0 + std::abs(volume.max);
        case 2: return intRandom(random, 0, 1) ? volume.min : volume.max;
        case 3: return std::nextafter(volume.max, std::numeric_limits<double>::infinity());
        case 4:
            return (intRandom(random, 0, 1) ? 1.0 : -1.0) *
                   (intRandom(random, 0, 1) ? 1e305 : std::numeric_limits<double>::infinity());
        case 5:
        case 6: return inside;
        case 7: {
            const double step = (volume.max * 0.5 - volume.min * 0.5) * 0.01 * (share - 0.5);
            return std::clamp(std::clamp(current, volume.min, volume.max) + step, volume.min, volume.max);
        }
        default: break;
    }
    if (volume.samples.empty())
        return inside;
    const double sample = volume.samples[static_cast<std::size_t>(
        intRandom(random, 0, static_cast<std::int64_t>(volume.samples.size()) - 1))];
    switch (intRandom(random, 0, 3)) {
        case 0: return std::nextafter(sample, std::numeric_limits<double>::infinity());
        case 1: return std::nextafter(sample, -std::numeric_limits<double>::infinity());
        default: return sample;
    }
}

/// Smooth, with noise in some blocks of 8^3 cells: leaves of very different sizes beside each other. Missing samples in
/// one volume of three.
inline std::shared_ptr<const ScalarGrid> patchyVolume(Random& random) {
    GridGeometry geometry;
    for (auto& n : geometry.dims)
        n = intRandom(random, 9, 36);
    const double a = 0.05 + 0.2 * unitRandom(random), b = 0.05 + 0.2 * unitRandom(random);
    const bool hasMissing = intRandom(random, 0, 2) == 0;
    std::map<std::array<std::int64_t, 3>, double> noise;
    return makeVolume<float>(ScalarType::F32, geometry, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
        auto [at, isNew] = noise.try_emplace({x / 8, y / 8, z / 8}, 0.0);
        if (isNew && intRandom(random, 0, 3) == 0)
            at->second = 20.0 * unitRandom(random);
        if (hasMissing && intRandom(random, 0, 999) == 0)
            return std::numeric_limits<double>::quiet_NaN();
        return 50.0 * std::sin(a * static_cast<double>(x) + 0.1 * static_cast<double>(z)) +
               50.0 * std::sin(b * static_cast<double>(y)) + 2.0 * static_cast<double>(z) +
               at->second * unitRandom(random);
    });
}

} // namespace isoslider::test
