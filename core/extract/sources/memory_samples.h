#pragma once

#include <algorithm>
#include <array>

#include "core/extract/sources/sample_reader.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::extract {

/// The samples of a volume in memory.
template <class Sample>
class MemorySamples final : public SampleReader<Sample> {
public:
    /// `grid` must outlive the reader.
    explicit MemorySamples(const ScalarGrid& grid)
        : view_{grid.values<Sample>().data(), grid.dims()}, bricks_(grid.dims()) {}

    std::uint64_t orderOf(BrickIndex brick) const override { return brick.number(); }
    Result<std::size_t> prepare(std::span<const BrickIndex> bricks, SlideStats&, std::stop_token) override {
        return bricks.size();
    }
    void prefetch(BrickIndex brick) const override {
        const auto coords = bricks_.brickCoords(brick);
        const std::int64_t x = coords[0] * kBrickSide, y0 = coords[1] * kBrickSide, z0 = coords[2] * kBrickSide;
        for (std::int64_t z = std::max<std::int64_t>(0, z0 - 1); z < std::min(view_.dims[2], z0 + 10); ++z)
            for (std::int64_t y = std::max<std::int64_t>(0, y0 - 1); y < std::min(view_.dims[1], y0 + 10); ++y)
                __builtin_prefetch(view_.samples + view_.offset(x, y, z));
    }

    SampleRows<Sample> rows(BrickIndex brick) const override {
        const auto coords = bricks_.brickCoords(brick);
        const std::array<std::int64_t, 3> origin{coords[0] * kBrickSide, coords[1] * kBrickSide,
                                                 coords[2] * kBrickSide};
        SampleRows<Sample> rows;
        placeInBox(view_.dims, origin, rows.begin, rows.end);
        rows.rowStride = view_.stride(1);
        rows.planeStride = view_.stride(2);
        const std::ptrdiff_t first = view_.offset(origin[0], origin[1], origin[2]);
        rows.before.fill({view_.samples, first - 1});
        rows.own.fill({view_.samples, first});
        rows.behind.fill({view_.samples, first + kBrickSide});
        return rows;
    }

private:
    SampleView<Sample> view_;
    BrickGrid bricks_;
};

} // namespace isoslider::extract
