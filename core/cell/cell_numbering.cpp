#include "core/cell/cell_numbering.h"

#include "core/base/check.h"

namespace isoslider::cell {

const std::array<CellEdge, 12> kCellEdges{{{0, 1, 0},
                                           {2, 3, 0},
                                           {4, 5, 0},
                                           {6, 7, 0},
                                           {0, 2, 1},
                                           {1, 3, 1},
                                           {4, 6, 1},
                                           {5, 7, 1},
                                           {0, 4, 2},
                                           {1, 5, 2},
                                           {2, 6, 2},
                                           {3, 7, 2}}};

int edgeBetween(int cornerA, int cornerB) {
    for (int e = 0; e < 12; ++e)
        if ((kCellEdges[e].lowerCorner == cornerA && kCellEdges[e].upperCorner == cornerB) ||
            (kCellEdges[e].lowerCorner == cornerB && kCellEdges[e].upperCorner == cornerA))
            return e;
    checkFailed("corners share an edge", __FILE__, __LINE__);
}

const std::array<std::uint8_t, 12>& facesOfEdges() {
    static const std::array<std::uint8_t, 12> faces = [] {
        std::array<std::uint8_t, 12> table{};
        for (int f = 0; f < 6; ++f)
            for (int k = 0; k < 4; ++k)
                table[edgeBetween(kFaceCorners[f][k], kFaceCorners[f][(k + 1) % 4])] |=
                    static_cast<std::uint8_t>(1 << f);
        return table;
    }();
    return faces;
}

namespace {

struct SignFacts {
    std::array<std::uint16_t, 256> activeEdges{};
    std::array<std::uint8_t, 256> ambiguousFaces{};

    SignFacts() {
        for (unsigned signs = 0; signs < 256; ++signs) {
            for (unsigned e = 0; e < 12; ++e)
                activeEdges[signs] |= static_cast<std::uint16_t>(
                    ((signs >> kCellEdges[e].lowerCorner ^ signs >> kCellEdges[e].upperCorner) & 1u) << e);
            for (unsigned f = 0; f < 6; ++f) {
                const auto& c = kFaceCorners[f];
                const unsigned first = signs >> c[0] & 1, second = signs >> c[1] & 1;
                if (first != second && first == (signs >> c[2] & 1) && second == (signs >> c[3] & 1))
                    ambiguousFaces[signs] |= static_cast<std::uint8_t>(1u << f);
            }
        }
    }
};

const SignFacts kFacts;

} // namespace

std::uint16_t activeEdges(std::uint8_t signs) { return kFacts.activeEdges[signs]; }

std::uint8_t ambiguousFaces(std::uint8_t signs) { return kFacts.ambiguousFaces[signs]; }

} // namespace isoslider::cell
