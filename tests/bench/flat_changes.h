#pragma once

#include <bit>
#include <mutex>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/extract/edge_interpolation.h"
#include "core/extract/sources/block_walk.h"
#include "core/grid/brick_grid.h"
#include "core/grid/normal_codec.h"
#include "core/grid/scalar_key.h"
#include "core/index/index_reader.h"

namespace isoslider::bench {

struct LocalEdgeTag;
/// Within a brick: axis * 512 + the local point at the edge's lower end.
using LocalEdge = StrongId<LocalEdgeTag, std::uint16_t>;

/// An edge that becomes active, with all that interpolation needs; local to the 8^3 points of `brick`.
template <class Live>
struct ActivatedEdge {
    Live scalar1, scalar2;
    BrickIndex brick;
    LocalEdge edge;
    NormalCode normal1, normal2;
};

struct DeactivatedEdge {
    BrickIndex brick;
    LocalEdge edge;
};

/// Net edge changes of one move, as the paper's E+ and E-: no edge appears twice.
template <class Live>
struct EdgeChanges {
    std::vector<ActivatedEdge<Live>> activated;
    std::vector<DeactivatedEdge> deactivated;
};

/// Takes the net changes between two thresholds from the edge blocks of an index. `keys`, `normals`: of points, by id.
template <class Sample>
Status collectEdgeChanges(extract::BlockWalk<KeyOf<Sample>>& walk, const BrickGrid& grid, KeyThreshold from,
                          KeyThreshold to, std::span<const KeyOf<Sample>> keys, std::span<const NormalCode> normals,
                          EdgeChanges<extract::LiveOf<Sample>>& changes) {
    using Live = extract::LiveOf<Sample>;
    changes.activated.clear();
    changes.deactivated.clear();
    const KeyThreshold lower = std::min(from, to), upper = std::max(from, to);
    std::mutex mutex; // never contended on the one thread that the baseline has
    extract::SlideStats stats;
    return walk.visit(lower, upper, stats, {}, [&](const auto& part) {
        const std::lock_guard lock(mutex);
        static constexpr int kStride[3] = {1, 8, 64};
        for (std::size_t i = part.begin; i < part.end; ++i) {
            const PointId id = part.page.id(i);
            const auto key = keys[id.index()];
            const Live near = static_cast<Live>(sampleOfKey<Sample>(key));
            for (unsigned mask = part.page.rising[i] | part.page.falling[i]; mask != 0; mask &= mask - 1) {
                const int e = std::countr_zero(mask), axis = e >> 1;
                const bool isUpward = e & 1;
                const int local = localOf(id).number();
                const bool leaves = (local / kStride[axis] & 7) == (isUpward ? 7 : 0);
                const std::ptrdiff_t step =
                    leaves ? grid.brickStride(axis) * kBrickPoints - 7 * kStride[axis] : kStride[axis];
                const PointId farId = isUpward ? id + step : id - step;
                const auto farKey = keys[farId.index()];
                if (farKey >= lower && farKey < upper)
                    continue; // redundant: crossed at both ends
                const PointId start = isUpward ? id : farId;
                const BrickIndex brick = brickOf(start);
                const auto edge = LocalEdge(axis * kBrickPoints + localOf(start).number());
                if ((farKey > key) != (from < to)) {
                    changes.deactivated.push_back({brick, edge});
                    continue;
                }
                const Live far = static_cast<Live>(sampleOfKey<Sample>(farKey));
                const NormalCode nearNormal = normals[id.index()], farNormal = normals[farId.index()];
                if (isUpward)
                    changes.activated.push_back({near, far, brick, edge, nearNormal, farNormal});
                else
                    changes.activated.push_back({far, near, brick, edge, farNormal, nearNormal});
            }
        }
    });
}

} // namespace isoslider::bench
