#include "ui/model/colouring/colour_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace isoslider::model {
namespace {

// Colours at even distances, between which maps are linear: of viridis and magma (Smith and van der Walt 2015), cividis
// (Nunez et al. 2018), and ColorBrewer's RdBu from blue to red.
constexpr std::uint32_t kViridis[] = {0x440154, 0x481567, 0x482677, 0x453781, 0x404788, 0x39568c, 0x33638d,
                                      0x2d708e, 0x287d8e, 0x238a8d, 0x1f968b, 0x20a387, 0x29af7f, 0x3cbb75,
                                      0x55c667, 0x73d055, 0x95d840, 0xb8de29, 0xdce319, 0xfde725};
constexpr std::uint32_t kMagma[] = {0x000004, 0x180f3d, 0x440f76, 0x721f81, 0x9e2f7f,
                                    0xcd4071, 0xf1605d, 0xfd9668, 0xfeca8d, 0xfcfdbf};
constexpr std::uint32_t kCividis[] = {0x00224e, 0x123570, 0x3b496c, 0x575d6d, 0x707173,
                                      0x8a8678, 0xa59c74, 0xc3b369, 0xe1cc55, 0xfee838};
constexpr std::uint32_t kBlueWhiteRed[] = {0x053061, 0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7,
                                           0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b, 0x67001f};
constexpr std::uint32_t kGrey[] = {0x141414, 0xf5f5f5};

std::span<const std::uint32_t> coloursOf(ColourMap map) {
    switch (map) {
        case ColourMap::Viridis: return kViridis;
        case ColourMap::Magma: return kMagma;
        case ColourMap::Cividis: return kCividis;
        case ColourMap::BlueWhiteRed: return kBlueWhiteRed;
        case ColourMap::Grey: return kGrey;
    }
    return kGrey;
}

} // namespace

const char* colourMapName(ColourMap map) {
    switch (map) {
        case ColourMap::Viridis: return "viridis";
        case ColourMap::Magma: return "magma";
        case ColourMap::Cividis: return "cividis";
        case ColourMap::BlueWhiteRed: return "blueWhiteRed";
        case ColourMap::Grey: return "grey";
    }
    return "";
}

SeenColour colourAt(ColourMap map, bool isReversed, double place) {
    const auto colours = coloursOf(map);
    const double within = place > 0.0 ? std::min(place, 1.0) : 0.0;
    const double at = (isReversed ? 1.0 - within : within) * static_cast<double>(colours.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(at), colours.size() - 2);
    const double share = at - static_cast<double>(below);
    SeenColour colour{};
    for (std::size_t part = 0; part < 3; ++part) {
        const auto of = [&](std::size_t i) {
            return static_cast<double>(colours[i] >> (16 - 8 * part) & 0xff) / 255.0;
        };
        colour[part] = static_cast<float>(of(below) + share * (of(below + 1) - of(below)));
    }
    return colour;
}

std::vector<SeenColour> coloursOf(ColourMap map, bool isReversed, int count) {
    std::vector<SeenColour> colours;
    for (int i = 0; i < count; ++i)
        colours.push_back(colourAt(map, isReversed, static_cast<double>(i) / (count - 1)));
    return colours;
}

} // namespace isoslider::model
