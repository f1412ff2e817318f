#pragma once

#include <array>
#include <cstdint>

#include "core/base/fast_divider.h"
#include "core/base/strong_id.h"
#include "core/grid/grid_geometry.h"

namespace isoslider {

inline constexpr int kBrickSide = 8;
inline constexpr int kBrickPoints = 512;

struct BrickTag;
/// A brick of 8^3 grid points (and the cells and edges that start at them), in an order with x fastest.
using BrickIndex = StrongId<BrickTag, std::uint32_t>;

struct LocalPointTag;
/// A grid point of a brick, or the cell that starts there: x + 8 y + 64 z.
using LocalPoint = StrongId<LocalPointTag, std::uint16_t>;

struct PointTag;
/// A grid point of the volume: brick * 512 + local point. Sorting by it keeps neighbours together.
using PointId = StrongId<PointTag, std::uint64_t>;

constexpr PointId pointIn(BrickIndex brick, LocalPoint local) {
    return PointId(std::uint64_t{brick.number()} * kBrickPoints + local.number());
}
constexpr BrickIndex brickOf(PointId point) { return BrickIndex(point.number() / kBrickPoints); }
constexpr LocalPoint localOf(PointId point) { return LocalPoint(point.number() % kBrickPoints); }

/// The grid cut into bricks.
class BrickGrid {
public:
    BrickGrid() = default;
    explicit BrickGrid(const GridDims& dims) : dims_(dims) {
        for (int a = 0; a < 3; ++a)
            bricks_[a] = (dims[a] + kBrickSide - 1) / kBrickSide;
        byRow_ = FastDivider(static_cast<std::uint32_t>(bricks_[0]));
        byPlane_ = FastDivider(static_cast<std::uint32_t>(bricks_[0] * bricks_[1]));
    }

    const GridDims& dims() const { return dims_; }
    const GridDims& bricks() const { return bricks_; }
    std::uint64_t brickCount() const { return static_cast<std::uint64_t>(bricks_[0] * bricks_[1] * bricks_[2]); }
    /// Point ids lie in [0, idCount()); bricks that stick out of the box leave gaps.
    std::uint64_t idCount() const { return brickCount() * kBrickPoints; }

    BrickIndex brickAt(std::int64_t bx, std::int64_t by, std::int64_t bz) const {
        return BrickIndex(bx + bricks_[0] * (by + bricks_[1] * bz));
    }
    std::array<std::int64_t, 3> brickCoords(BrickIndex brick) const {
        const std::int64_t b = brick.number(), row = byRow_.quotient(brick.number()),
                           z = byPlane_.quotient(brick.number());
        return {b - bricks_[0] * row, row - bricks_[1] * z, z};
    }
    PointId pointId(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return pointIn(brickAt(x >> 3, y >> 3, z >> 3), LocalPoint((x & 7) + 8 * (y & 7) + 64 * (z & 7)));
    }
    std::array<std::int64_t, 3> pointCoords(PointId id) const {
        const auto b = brickCoords(brickOf(id));
        const std::int64_t local = localOf(id).number();
        return {b[0] * 8 + (local & 7), b[1] * 8 + (local >> 3 & 7), b[2] * 8 + (local >> 6)};
    }
    /// Bricks between a brick and the next one along an axis.
    std::int64_t brickStride(int axis) const {
        return axis == 0 ? 1 : axis == 1 ? bricks_[0] : bricks_[0] * bricks_[1];
    }
    bool contains(PointId id) const {
        if (id.number() >= idCount())
            return false;
        const auto p = pointCoords(id);
        return p[0] < dims_[0] && p[1] < dims_[1] && p[2] < dims_[2];
    }

private:
    GridDims dims_{0, 0, 0};
    GridDims bricks_{0, 0, 0};
    FastDivider byRow_, byPlane_;
};

} // namespace isoslider
