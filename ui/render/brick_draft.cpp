#include "ui/render/brick_draft.h"

#include <algorithm>
#include <limits>

namespace isoslider::render {
namespace {

using Record = extract::EdgeRecord<float>;

constexpr int kLast = extract::kCellSide; // grid point along an axis
constexpr std::uint16_t kNone = std::numeric_limits<std::uint16_t>::max();

/// The groups of vertices that become one.
struct Groups {
    int blockCells;
    int blocks = extract::kCellSide / blockCells;
    int places = blocks + 2; ///< along an axis: the two sides of the brick come after the blocks

    /// Where along an axis an edge is: in a block, or in one of the sides, if it lies in them.
    int placeAlong(int point, bool isAlongAxis) const {
        if (!isAlongAxis && (point == 0 || point == kLast))
            return point == 0 ? blocks : blocks + 1;
        return std::min(point / blockCells, blocks - 1);
    }
    int number(int x, int y, int z) const { return x + places * (y + places * z); }
    std::size_t count() const { return static_cast<std::size_t>(places) * places * places; }

    int of(const Record& record) const {
        if (record.isInside()) {
            const glm::vec3 place = record.insidePlace();
            const auto block = [&](float along) {
                return std::clamp(static_cast<int>(along) / blockCells, 0, blocks - 1);
            };
            return number(block(place.x), block(place.y), block(place.z));
        }
        const int axis = extract::axisOf(record.edge);
        const auto start = extract::coordsOf(extract::startOf(record.edge));
        return number(placeAlong(start[0], axis == 0), placeAlong(start[1], axis == 1),
                      placeAlong(start[2], axis == 2));
    }
};

} // namespace

void coarsenBrick(std::span<const Record> records, std::span<const std::uint16_t> indices, int blockCells,
                  std::vector<std::uint16_t>& coarse) {
    // Of a group the vertex on the first edge stays. Edges in a common side come in the same order in both bricks, for
    // the coordinate across it is the same for all of them.
    const Groups rule{blockCells};
    static thread_local std::vector<std::uint16_t> kept, groups, standIns;
    kept.assign(rule.count(), kNone);
    groups.resize(records.size());
    standIns.resize(records.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
        const int group = rule.of(records[i]);
        groups[i] = static_cast<std::uint16_t>(group);
        std::uint16_t& first = kept[static_cast<std::size_t>(group)];
        if (first == kNone || records[i].edge < records[first].edge)
            first = static_cast<std::uint16_t>(i);
    }
    for (std::size_t i = 0; i < records.size(); ++i)
        standIns[i] = kept[groups[i]];
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const std::uint16_t a = standIns[indices[i]], b = standIns[indices[i + 1]], c = standIns[indices[i + 2]];
        if (a != b && b != c && c != a)
            coarse.insert(coarse.end(), {a, b, c});
    }
}

} // namespace isoslider::render
