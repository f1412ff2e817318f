#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace isoslider::model {

/// From low to high values. All are perceptually uniform; BlueWhiteRed from its middle to both ends.
enum class ColourMap { Viridis, Magma, Cividis, BlueWhiteRed, Grey };
inline constexpr std::array<ColourMap, 5> kColourMaps{ColourMap::Viridis, ColourMap::Magma, ColourMap::Cividis,
                                                      ColourMap::BlueWhiteRed, ColourMap::Grey};

/// Red, green, blue, 0 to 1; as seen.
using SeenColour = std::array<float, 3>;

/// What has no value.
inline constexpr SeenColour kNoValueColour{0.5f, 0.5f, 0.5f};

/// As settings and session files name it.
const char* colourMapName(ColourMap map);
/// The colour of a place on the map, 0 to 1; beyond the ends that of the end.
SeenColour colourAt(ColourMap map, bool isReversed, double place);
/// The colours of so many places from 0 to 1. REQUIRES: at least 2.
std::vector<SeenColour> coloursOf(ColourMap map, bool isReversed, int count);

} // namespace isoslider::model
