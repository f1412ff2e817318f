#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <optional>

#include "core/volume_io/volume_reader.h"
#include "ui/model/colouring/colour_map.h"

namespace isoslider::model {

/// What the colours of a surface stand for. Middle: the distance from the middle of the volume. Field: another volume
/// on the same grid.
enum class ColourBy { One, Gradient, X, Y, Z, Middle, Field };
inline constexpr std::array<ColourBy, 7> kColourKeys{ColourBy::One, ColourBy::Gradient, ColourBy::X,    ColourBy::Y,
                                                     ColourBy::Z,   ColourBy::Middle,   ColourBy::Field};

/// The values that have the map's first and last colour. REQUIRES: low < high, both finite.
struct ColourRange {
    double low = 0.0, high = 1.0;

    bool operator==(const ColourRange&) const = default;
};

/// Ascending and finite, its width too.
inline bool isUsable(const ColourRange& range) {
    return range.low < range.high && std::isfinite(range.high - range.low);
}

/// A volume whose values surfaces are coloured by.
struct FieldFile {
    std::filesystem::path path; ///< absolute
    io::ReadOptions options;

    bool operator==(const FieldFile&) const = default;
};

/// How the surfaces of a volume are coloured; pieces in separate colours have those all the same.
struct Colouring {
    ColourBy by = ColourBy::One;
    std::optional<FieldFile> field; ///< where it is by Field
    ColourMap map = ColourMap::Viridis;
    bool isReversed = false;
    std::optional<ColourRange> range; ///< none: that of the volume

    bool operator==(const Colouring&) const = default;
};

} // namespace isoslider::model
