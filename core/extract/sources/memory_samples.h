#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

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

    std::uint64_t orderOf(BrickIndex brick) const override { return brick; }
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

    void read(BrickIndex brick, SampleBlock<Sample>& block) const override {
        const auto coords = bricks_.brickCoords(brick);
        const std::array<std::int64_t, 3> origin{coords[0] * kBrickSide, coords[1] * kBrickSide,
                                                 coords[2] * kBrickSide};
        block.place(view_.dims, origin);
        const auto rowAt = [&](int y, int z) { return view_.offset(origin[0] - 1, origin[1] + y, origin[2] + z); };
        const std::ptrdiff_t first = rowAt(block.begin[1], block.begin[2]);
        const std::ptrdiff_t last = rowAt(block.end[1] - 1, block.end[2] - 1);
        if (first >= 0 && last + kCopied <= view_.offset(0, 0, view_.dims[2]))
            copyRows(block, view_.samples + first, -1, std::integral_constant<std::size_t, kCopied>{});
        else
            copyRows(block, view_.samples + (first + 1 + block.begin[0]), block.begin[0],
                     static_cast<std::size_t>(block.end[0] - block.begin[0]));
    }

    void readRows(BrickIndex brick, const PointRows& rows, SampleBlock<Sample>& block) const override {
        const auto coords = bricks_.brickCoords(brick);
        const std::array<std::int64_t, 3> origin{coords[0] * kBrickSide, coords[1] * kBrickSide, coords[2] * kBrickSide};
        block.place(view_.dims, origin);
        const BlockRows wanted = rowsForGradients(rows);
        const std::ptrdiff_t last = view_.offset(0, 0, view_.dims[2]) - kCopied;
        for (int z = block.begin[2]; z < block.end[2]; ++z)
            for (unsigned row = wanted[static_cast<std::size_t>(z + 1)]; row != 0; row &= row - 1) {
                const int y = std::countr_zero(row) - 1;
                if (y < block.begin[1] || y >= block.end[1])
                    continue;
                const std::ptrdiff_t from = view_.offset(origin[0] - 1, origin[1] + y, origin[2] + z);
                if (from >= 0 && from <= last)
                    std::memcpy(block.samples.data() + block.offset(-1, y, z), view_.samples + from, kCopied * sizeof(Sample));
                else
                    std::memcpy(block.samples.data() + block.offset(block.begin[0], y, z), view_.samples + from + 1 + block.begin[0],
                                static_cast<std::size_t>(block.end[0] - block.begin[0]) * sizeof(Sample));
            }
    }

private:
    // From x = -1, whole vectors: a copy of constant size is a few instructions, and what it takes from beyond
    // the box is another row's and as good as anything there.
    static constexpr int kCopied = sizeof(Sample) == 1 ? 16 : 12;

    void copyRows(SampleBlock<Sample>& block, const Sample* from, int x, auto count) const {
        const std::ptrdiff_t row = view_.stride(1), plane = view_.stride(2);
        for (int z = block.begin[2]; z < block.end[2]; ++z)
            for (int y = block.begin[1]; y < block.end[1]; ++y)
                std::memcpy(block.samples.data() + block.offset(x, y, z),
                            from + row * (y - block.begin[1]) + plane * (z - block.begin[2]), count * sizeof(Sample));
    }

    SampleView<Sample> view_;
    BrickGrid bricks_;
};

} // namespace isoslider::extract
