#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/cell/cell_states.h"
#include "core/extract/live/brick_bits.h"

namespace isoslider::extract {

/// The vertex numbers of a brick's active edges: place 4 * point + axis. The edges of a cell lie in a few
/// consecutive pieces of it. Places of other edges hold anything.
struct VertexTable {
    alignas(64) std::array<std::uint16_t, 4 * (kPaddedPoints + 96)> numbers;

    std::uint16_t& of(ClosedEdge edge) { return numbers[placeOf(edge)]; }
    static std::size_t placeOf(ClosedEdge edge) {
        return 4 * startOf(edge).index() + static_cast<std::size_t>(axisOf(edge));
    }
};

/// Place in the vertex table, relative to 4 * the cell's point, of each of a cell's twelve edges (cell_numbering.h).
extern const std::array<std::uint16_t, 12> kPlaceOfCellEdge;

/// By signs: isAmbiguous() as a table at hand.
const std::array<bool, 256>& ambiguousSignTable();

/// The active cells of a brick in order, with their signs and states: those of ambiguous cells are for others to fill
/// in.
struct CellList {
    static constexpr std::size_t kMost = std::size_t{kCellSide} * kCellSide * kCellSide;
    std::uint32_t count = 0;
    std::uint32_t ambiguousCount = 0;
    // With room for what is written behind the last in whole vectors.
    std::array<ClosedPoint, kMost + 64> cells;
    std::array<std::uint8_t, kMost + 64> signs;
    std::array<cell::StateId, kMost + 64> states; ///< below 256 the signs
    std::array<std::uint16_t, kMost + 1>
        ambiguous; ///< places in the list of the cells whose signs leave the surface open
};
void listCells(const BitString& active, const BitString& above, CellList& list);

/// Triangles of the cells, three vertex numbers each, in the list's order; returns how many numbers. Inner vertices of
/// cells are numbered from `firstInner` on. `out` has room for kMaxCellIndices per ambiguous cell, 15 per other cell,
/// and kIndexOverrun more.
inline constexpr std::size_t kMaxCellIndices = 3 * cell::kMaxStateTriangles;
inline constexpr std::size_t kIndexOverrun = 32;
std::uint32_t writeTriangles(const CellList& list, std::uint32_t firstInner, const VertexTable& vertices,
                             std::uint16_t* out);
/// The same without vectors: what the one above is tested against.
std::uint32_t writeTrianglesReference(const CellList& list, std::uint32_t firstInner, const VertexTable& vertices,
                                      std::uint16_t* out);

} // namespace isoslider::extract
