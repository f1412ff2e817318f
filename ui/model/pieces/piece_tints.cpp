#include "ui/model/pieces/piece_tints.h"

#include <algorithm>
#include <cmath>

namespace isoslider::model {
namespace {

using Colour = std::array<std::uint8_t, 3>;

// As seen. First the colour that the surface has otherwise; none of the red of changes or the cyan of events.
constexpr std::array<Colour, 12> kColours{{{231, 217, 193},
                                           {86, 148, 214},
                                           {232, 163, 61},
                                           {112, 187, 93},
                                           {176, 124, 198},
                                           {217, 201, 74},
                                           {210, 123, 165},
                                           {77, 172, 150},
                                           {140, 158, 255},
                                           {190, 140, 110},
                                           {229, 127, 98},
                                           {160, 205, 130}}};
constexpr PieceTint kSelected{255, 0, 184, kTintedPiece}; // magenta, in linear light: far from all of them
// Of every next round through the colours.
constexpr std::array<double, 3> kShades{1.0, 0.62, 0.82};

std::uint8_t toLinear(std::uint8_t seen, double shade) {
    return static_cast<std::uint8_t>(std::lround(255.0 * std::pow(seen * shade / 255.0, 2.2)));
}

std::array<PieceTint, kColours.size() * kShades.size()> linearTints() {
    std::array<PieceTint, kColours.size() * kShades.size()> tints{};
    for (std::size_t k = 0; k < tints.size(); ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            tints[k][channel] = toLinear(kColours[k % kColours.size()][channel], kShades[k / kColours.size()]);
    return tints;
}

} // namespace

double sizeOf(const extract::Piece& piece, const GridGeometry& geometry) {
    double size = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        size = std::max(size, (piece.high[k] - piece.low[k]) * std::abs(geometry.spacing[axis]));
    }
    return size;
}

PieceDisplay::PieceDisplay(const extract::SurfacePieces& pieces, const GridGeometry& geometry,
                           const PieceOptions& options)
    : pieces_(pieces), geometry_(geometry), options_(options), only_(find(options.only)) {}

std::optional<std::size_t> PieceDisplay::find(const std::optional<extract::PieceId>& id) const {
    const auto all = pieces_.pieces();
    const auto found =
        id ? std::find_if(all.begin(), all.end(), [&](const extract::Piece& piece) { return piece.id == *id; })
           : all.end();
    return found != all.end() ? std::optional(static_cast<std::size_t>(found - all.begin())) : std::nullopt;
}

bool PieceDisplay::isShown(std::size_t piece) const {
    const extract::Piece& shown = pieces_.pieces()[piece];
    if (only_)
        return piece == *only_;
    const auto* found = options_.leastPersistence > 0.0 ? options_.shortLived.get() : nullptr;
    if (found != nullptr && std::binary_search(found->ids.begin(), found->ids.end(), shown.id))
        return false;
    return !(options_.largest > 0 && piece >= options_.largest) && sizeOf(shown, geometry_) >= options_.leastSize &&
           std::find(options_.hidden.begin(), options_.hidden.end(), shown.id) == options_.hidden.end();
}

PieceTint PieceDisplay::colour(std::size_t piece) const {
    static const auto all = linearTints();
    return all[pieces_.pieces()[piece].id.index() % all.size()];
}

PieceTint PieceDisplay::tint(std::size_t piece) const {
    PieceTint tint = colour(piece);
    tint[3] = !isShown(piece) ? kHiddenPiece : options_.isColoured ? kTintedPiece : kPlainPiece;
    if (tint[3] != kHiddenPiece && options_.selected == pieces_.pieces()[piece].id)
        tint = kSelected;
    return tint;
}

std::vector<PieceTint> PieceDisplay::tints() const {
    std::vector<PieceTint> tints(pieces_.pieces().size());
    for (std::size_t piece = 0; piece < tints.size(); ++piece)
        tints[piece] = tint(piece);
    return tints;
}

PieceCounts PieceDisplay::counts() const {
    PieceCounts counts{pieces_.pieces().size(), 0};
    for (std::size_t piece = 0; piece < counts.all; ++piece)
        counts.shown += isShown(piece);
    return counts;
}

} // namespace isoslider::model
