#pragma once

#include <array>
#include <cstdint>

#include "core/grid/grid_geometry.h"

namespace isoslider {

/// The grid cut into bricks of 8^3 grid points (and the cells and edges that start at them).
/// Bricks x fastest. A point id is brick * 512 + x + 8 y + 64 z within the brick; sorting by it keeps
/// neighbours together. All ids are 64-bit.
using PointId = std::uint64_t;
using BrickIndex = std::uint32_t;

inline constexpr int kBrickSide = 8;
inline constexpr int kBrickPoints = 512;
inline constexpr int kBrickEdges = 3 * kBrickPoints;

/// Within a brick: axis * 512 + x + 8 y + 64 z of the edge's lower grid point.
using LocalEdge = std::uint16_t;
using LocalPoint = std::uint16_t;

class BrickGrid {
public:
    BrickGrid() = default;
    explicit BrickGrid(const GridDims& dims) : dims_(dims) {
        for (int a = 0; a < 3; ++a)
            bricks_[a] = (dims[a] + kBrickSide - 1) / kBrickSide;
    }

    const GridDims& dims() const { return dims_; }
    const GridDims& bricks() const { return bricks_; }
    std::uint64_t brickCount() const { return static_cast<std::uint64_t>(bricks_[0] * bricks_[1] * bricks_[2]); }
    /// Point ids lie in [0, idCount()); bricks that stick out of the box leave gaps.
    std::uint64_t idCount() const { return brickCount() * kBrickPoints; }

    BrickIndex brickAt(std::int64_t bx, std::int64_t by, std::int64_t bz) const {
        return static_cast<BrickIndex>(bx + bricks_[0] * (by + bricks_[1] * bz));
    }
    std::array<std::int64_t, 3> brickCoords(BrickIndex brick) const {
        const std::int64_t b = brick;
        return {b % bricks_[0], b / bricks_[0] % bricks_[1], b / (bricks_[0] * bricks_[1])};
    }
    PointId pointId(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return PointId{brickAt(x >> 3, y >> 3, z >> 3)} * kBrickPoints +
               static_cast<PointId>((x & 7) + 8 * (y & 7) + 64 * (z & 7));
    }
    std::array<std::int64_t, 3> pointCoords(PointId id) const {
        const auto b = brickCoords(static_cast<BrickIndex>(id / kBrickPoints));
        const auto local = static_cast<std::int64_t>(id % kBrickPoints);
        return {b[0] * 8 + (local & 7), b[1] * 8 + (local >> 3 & 7), b[2] * 8 + (local >> 6)};
    }
    /// Bricks between a brick and the next one along an axis.
    std::int64_t brickStride(int axis) const {
        return axis == 0 ? 1 : axis == 1 ? bricks_[0] : bricks_[0] * bricks_[1];
    }
    bool contains(PointId id) const {
        if (id >= idCount())
            return false;
        const auto p = pointCoords(id);
        return p[0] < dims_[0] && p[1] < dims_[1] && p[2] < dims_[2];
    }

private:
    GridDims dims_{0, 0, 0};
    GridDims bricks_{0, 0, 0};
};

} // namespace isoslider
