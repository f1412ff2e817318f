#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/extract/pieces/surface_pieces.h"
#include "core/grid/grid_geometry.h"

namespace isoslider::model {

/// A piece by one of its vertices: the lower grid point and the axis of the edge that it lies on.
struct PiecePlace {
    std::array<std::int32_t, 3> edgeStart{};
    int edgeAxis = 0;

    bool operator==(const PiecePlace&) const = default;
};

/// Pieces of a picture that is still to come.
struct PiecePlaces {
    std::vector<PiecePlace> hidden;
    std::optional<PiecePlace> only;

    bool isEmpty() const { return hidden.empty() && !only; }
    bool operator==(const PiecePlaces&) const = default;
};

/// Which pieces of a picture last less than asked, as the samples say.
struct ShortLivedPieces {
    double isovalue = 0.0; ///< of the picture
    GridDims dims{}; ///< of its grid: that of a preview is coarser
    double leastPersistence = 0.0; ///< that was asked for
    std::vector<extract::PieceId> ids; ///< ascending
    bool isComplete = true; ///< false: some pieces are so large that it was not found out; they are not among these
    std::string error; ///< why nothing was found; else empty
};

/// Which pieces of one surface are not shown. Pieces are named by the number they keep while the surface slides.
struct HiddenPieces {
    double leastSize = 0.0; ///< smaller ones are hidden, see sizeOf(); 0: none is
    double leastPersistence = 0.0; ///< those that last less are hidden, in scalars; 0: none is
    std::uint32_t largest = 0; ///< so many are shown at most, those of most triangles; 0: all
    std::vector<extract::PieceId> hidden; ///< these, too
    std::optional<extract::PieceId> only; ///< all but this are hidden, as long as it is there
    PiecePlaces awaited; ///< of a session: hidden or shown alone as soon as pieces are known
    /// Found for `leastPersistence`, of the latest picture that rested; those that have come since are shown. Null: not
    /// yet.
    std::shared_ptr<const ShortLivedPieces> shortLived;

    bool hidesAny() const {
        return leastSize > 0.0 || leastPersistence > 0.0 || largest > 0 || !hidden.empty() || only ||
               !awaited.isEmpty();
    }
    bool operator==(const HiddenPieces&) const = default;
};

/// How the pieces of the active surface are shown.
struct PieceOptions : HiddenPieces {
    bool isColoured = false;
    std::optional<extract::PieceId> selected; ///< stands out

    PieceOptions() = default;
    /// Of a surface that does not slide.
    explicit PieceOptions(HiddenPieces pieces) : HiddenPieces(std::move(pieces)) {}

    HiddenPieces& hiddenPieces() { return *this; }
    const HiddenPieces& hiddenPieces() const { return *this; }
    bool isWanted() const { return isColoured || hidesAny() || selected; }
    bool operator==(const PieceOptions&) const = default;
};

/// The most that PieceOptions::largest may be.
inline constexpr int kMostLargestPieces = 999;
/// The most places that a session keeps.
inline constexpr std::size_t kMostAwaited = 5000;

/// The longest side of the piece's box, in the volume's unit of length: to one grid step.
double sizeOf(const extract::Piece& piece, const GridGeometry& geometry);

/// Red, green, blue in linear light, and what they are for.
using PieceTint = std::array<std::uint8_t, 4>;
inline constexpr std::uint8_t kHiddenPiece = 0, kPlainPiece = 128, kTintedPiece = 255; // last byte of a tint

struct PieceCounts {
    std::uint64_t all = 0, shown = 0;

    bool operator==(const PieceCounts&) const = default;
};

/// The pieces of a picture as the options have them shown. By place among the pieces. What it is made from must outlive
/// it.
class PieceDisplay {
public:
    PieceDisplay(const extract::SurfacePieces& pieces, const GridGeometry& geometry, const PieceOptions& options);

    bool isShown(std::size_t piece) const;
    /// Depends on the piece's number alone, so it keeps it while it is neither selected nor hidden.
    PieceTint tint(std::size_t piece) const;
    /// The colour it has where pieces are coloured.
    PieceTint colour(std::size_t piece) const;
    std::vector<PieceTint> tints() const;
    PieceCounts counts() const;
    /// Of the piece with that number; none if it is not there.
    std::optional<std::size_t> find(const std::optional<extract::PieceId>& id) const;

private:
    const extract::SurfacePieces& pieces_;
    const GridGeometry& geometry_;
    const PieceOptions& options_;
    std::optional<std::size_t> only_;
};

} // namespace isoslider::model
