#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cell/trilinear_cell.h"

namespace isoslider::cell {

/// Number of a cell's state. 0..255: the signs themselves, where they leave nothing open; greater: one
/// for each way in which the ambiguous faces and the inside of such a cell can be joined.
using StateId = std::uint16_t;

/// In triangles, vertices 0..11 are the surface's vertices on the cell's edges, kInnerVertex + k its
/// inner vertex k.
inline constexpr std::uint8_t kInnerVertex = 12;

/// A loop that no triangulation spans without a diagonal in a face has a separate vertex: the mean of the
/// loop's vertices.
struct CellCentre {
    std::uint16_t loopEdges; ///< bit e: the loop passes through edge e
};

/// One state and its triangles. Triangles are counter-clockwise seen from the side below the isovalue.
/// No triangle edge lies in a face but the segments that both neighbours draw there; so an edge of the
/// mesh never has more than two triangles. Where a loop admits no such triangulation it is spanned from
/// a centre; the two loops of a tunnel are joined to its waist, a ring of six inner vertices.
struct CellState {
    std::uint8_t signs = 0;
    std::uint8_t joinedFaces = 0; ///< bit f: face f is ambiguous and its above corners are joined
    Tunnel tunnel = Tunnel::None;
    std::uint8_t diagonal = 0; ///< of a tunnel
    std::uint8_t loops = 0; ///< on the faces
    std::uint8_t components = 0; ///< of the surface in the cell: loops, less one for a tunnel
    std::uint8_t triangleCount = 0;
    std::uint8_t innerVertices = 0; ///< a tunnel's six, then one per centre
    std::span<const std::uint8_t> triangles; ///< 3 * triangleCount vertices
    std::span<const CellCentre> centres;
    /// Corner of the waist's box at inner vertex k of a tunnel: bit 0 greater x, bit 1 y, bit 2 z.
    std::array<std::uint8_t, 6> ring{};
};

/// All states, built once.
std::span<const CellState> cellStates();
inline constexpr int kMaxStateTriangles = 24;
inline constexpr std::size_t kMaxInnerVertices = 12;

/// The state of given decisions. REQUIRES: `joinedFaces` within ambiguousFaces(signs); a tunnel only
/// where mayHaveTunnel() reports it.
StateId stateOf(std::uint8_t signs, std::uint8_t joinedFaces, Tunnel tunnel = Tunnel::None, std::uint8_t diagonal = 0);

/// What given faces leave: the state without a tunnel, and the tunnels there is room for: bit 0 Above, bit 1 Below.
struct FacesState {
    StateId state = 0;
    std::uint8_t tunnels = 0;
};
struct FacesStates {
    std::array<std::uint8_t, 256> ambiguous{}; ///< ambiguousFaces(), by signs
    std::array<std::uint16_t, 256> first{}; ///< in `states`, by signs
    /// Bits of joined faces that are ambiguous, moved together; by both.
    std::array<std::array<std::uint8_t, 64>, 64> packed{};
    std::vector<FacesState> states;

    /// REQUIRES: `joinedFaces` within ambiguousFaces(signs).
    const FacesState& of(std::uint8_t signs, std::uint8_t joinedFaces) const {
        return states[first[signs] + packed[ambiguous[signs]][joinedFaces]];
    }
};
const FacesStates& facesStates();

/// The tunnels that given faces leave room for: bit 0 Above, bit 1 Below.
unsigned mayHaveTunnel(std::uint8_t signs, std::uint8_t joinedFaces);

/// True when signs alone do not determine the surface: a face is ambiguous, or the inside is.
bool isAmbiguous(std::uint8_t signs);

} // namespace isoslider::cell
