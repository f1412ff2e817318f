#include "core/extract/pieces/brick_parts.h"

#include <algorithm>
#include <utility>

#include "core/base/disjoint_sets.h"

namespace isoslider::extract {
namespace {

struct Span3 {
    std::array<std::uint8_t, 3> low{}, high{};
};

/// Grid points of the brick at both ends of what a vertex lies on; for one inside a cell the cell's.
template <class Live>
Span3 endsOf(const EdgeRecord<Live>& record) {
    Span3 ends;
    if (record.isInside()) {
        const glm::vec3 place = record.insidePlace();
        for (int axis = 0; axis < 3; ++axis) {
            const auto cell = static_cast<std::uint8_t>(std::clamp(place[axis], 0.0f, kCellSide - 1.0f));
            ends.low[static_cast<std::size_t>(axis)] = cell;
            ends.high[static_cast<std::size_t>(axis)] = static_cast<std::uint8_t>(cell + 1);
        }
        return ends;
    }
    const auto start = coordsOf(startOf(record.edge));
    for (std::size_t axis = 0; axis < 3; ++axis)
        ends.low[axis] = ends.high[axis] = static_cast<std::uint8_t>(start[axis]);
    const auto along = static_cast<std::size_t>(axisOf(record.edge));
    const int side = 1 << record.levelOrUpperZ;
    ends.low[along] = static_cast<std::uint8_t>(start[along] & ~(side - 1));
    ends.high[along] = static_cast<std::uint8_t>(ends.low[along] + side);
    return ends;
}

} // namespace

template <class Live>
BrickParts partsOf(std::span<const EdgeRecord<Live>> records, std::span<const std::uint16_t> indices) {
    BrickParts result;
    static thread_local DisjointSets<std::uint16_t> sets;
    sets.reset(records.size());
    for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
        sets.unite(indices[k], indices[k + 1]);
        sets.unite(indices[k], indices[k + 2]);
    }
    // A part is numbered where its first triangle comes: vertices without triangles have none.
    static thread_local std::vector<std::uint16_t> numbers;
    numbers.assign(records.size(), BrickParts::kNone);
    for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
        std::uint16_t& number = numbers[sets.rootOf(indices[k])];
        if (number == BrickParts::kNone) {
            number = static_cast<std::uint16_t>(result.parts.size());
            result.parts.emplace_back();
        }
        ++result.parts[number].triangles;
    }
    result.edges.resize(records.size());
    result.partOf.resize(records.size());
    for (std::size_t k = 0; k < records.size(); ++k) {
        const EdgeRecord<Live>& record = records[k];
        const std::uint16_t number = numbers[sets.rootOf(static_cast<std::uint16_t>(k))];
        result.edges[k] = record.edge;
        result.partOf[k] = number;
        if (number == BrickParts::kNone)
            continue;
        BrickPart& part = result.parts[number];
        if (part.high ==
            decltype(part.high){}) // records on edges come before those inside cells, and each part has some
            part.edge = record.edge;
        const Span3 ends = endsOf(record);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            part.low[axis] = std::min(part.low[axis], ends.low[axis]);
            part.high[axis] = std::max(part.high[axis], ends.high[axis]);
            if (record.isInside() || ends.low[axis] != ends.high[axis])
                continue;
            if (ends.low[axis] == 0)
                result.faces[2 * axis].push_back({record.edge, number});
            else if (ends.low[axis] == kCellSide)
                result.faces[2 * axis + 1].push_back(
                    {ClosedEdge(record.edge.number() - kCellSide * kPointStride[axis]), number});
        }
    }
    return result;
}

template BrickParts partsOf(std::span<const EdgeRecord<float>>, std::span<const std::uint16_t>);
template BrickParts partsOf(std::span<const EdgeRecord<double>>, std::span<const std::uint16_t>);

} // namespace isoslider::extract
