#include "ui/render/brick_draft.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace isoslider::render {
namespace {

constexpr int kLast = extract::kCellSide; // grid point along an axis
constexpr std::uint16_t kNone = std::numeric_limits<std::uint16_t>::max();

/// The groups of vertices that become one.
struct Groups {
    int blockCells;
    int blocks = extract::kCellSide / blockCells;
    int places = blocks + 2; ///< along an axis: the two sides of the brick come after the blocks

    /// Where along an axis an edge is: in a block, or in one of the sides, if it lies in them.
    constexpr int placeAlong(int point, bool isAlongAxis) const {
        if (!isAlongAxis && (point == 0 || point == kLast))
            return point == 0 ? blocks : blocks + 1;
        return std::min(point / blockCells, blocks - 1);
    }
    constexpr int number(int x, int y, int z) const { return x + places * (y + places * z); }
    constexpr std::size_t count() const { return static_cast<std::size_t>(places) * places * places; }

    constexpr int ofEdge(extract::ClosedEdge edge) const {
        const int axis = extract::axisOf(edge);
        const auto start = extract::coordsOf(extract::startOf(edge));
        return number(placeAlong(start[0], axis == 0), placeAlong(start[1], axis == 1),
                      placeAlong(start[2], axis == 2));
    }
    int ofInner(const extract::InnerRecord& record) const {
        const auto block = [&](float along) { return std::clamp(static_cast<int>(along) / blockCells, 0, blocks - 1); };
        return number(block(record.place.x), block(record.place.y), block(record.place.z));
    }
};

/// The group of each edge, by its code without the level.
using GroupTable = std::array<std::uint8_t, extract::kCodePlaceMask + 1>;

GroupTable groupTable(int blockCells) {
    const Groups rule{blockCells};
    GroupTable table{};
    for (unsigned code = 0; code < extract::kClosedPoints * 4u; ++code)
        if (const auto vertex = static_cast<extract::VertexCode>(code); !extract::isInside(vertex))
            table[code] = static_cast<std::uint8_t>(rule.ofEdge(extract::edgeOf(vertex)));
    return table;
}

} // namespace

void coarsenBrick(const BrickSurface& surface, int blockCells, CoarseSurface& coarse) {
    static const std::array<GroupTable, 3> tables{groupTable(2), groupTable(4), groupTable(8)};
    const GroupTable& table = tables[static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(blockCells)) - 1)];
    // Of a group the vertex on the first edge stays, which comes first. Edges in a common side come in the same order
    // in both bricks, for the coordinate across it is the same for all of them.
    const Groups rule{blockCells};
    std::array<std::uint16_t, 216> kept; // by group, its place among the vertices that stay
    std::fill_n(kept.begin(), rule.count(), kNone);
    static thread_local std::vector<std::uint16_t> standIns;
    standIns.resize(surface.codes.size());
    coarse.vertices.clear();
    for (std::size_t i = 0; i < surface.codes.size(); ++i) {
        const extract::VertexCode code = surface.codes[i];
        const int group =
            extract::isInside(code) ? rule.ofInner(surface.inner[code >> 2]) : table[code & extract::kCodePlaceMask];
        std::uint16_t& place = kept[static_cast<std::size_t>(group)];
        if (place == kNone) {
            place = static_cast<std::uint16_t>(coarse.vertices.size());
            coarse.vertices.push_back(static_cast<std::uint16_t>(i));
        }
        standIns[i] = place;
    }
    coarse.indices.resize(surface.indices.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i + 2 < surface.indices.size(); i += 3) { // written in any case: cheaper than a branch
        const std::uint16_t a = standIns[surface.indices[i]], b = standIns[surface.indices[i + 1]],
                            c = standIns[surface.indices[i + 2]];
        coarse.indices[count] = a;
        coarse.indices[count + 1] = b;
        coarse.indices[count + 2] = c;
        count += 3 * static_cast<std::size_t>((a != b) & (b != c) & (c != a));
    }
    coarse.indices.resize(count);
}

} // namespace isoslider::render
