#pragma once

#include <algorithm>
#include <cstring>

#include "core/extract/sample_reader.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::extract {

/// The samples of a volume in memory.
template <class Sample>
class MemorySamples final : public SampleReader<Sample> {
public:
    /// `grid` must outlive the reader.
    explicit MemorySamples(const ScalarGrid& grid) : view_{grid.values<Sample>().data(), grid.dims()}, bricks_(grid.dims()) {}

    std::uint64_t orderOf(BrickIndex brick) const override { return brick; }
    Result<std::size_t> prepare(std::span<const BrickIndex> bricks, SlideStats&, std::stop_token) override { return bricks.size(); }
    Result<Sample> sampleAt(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t&) const override {
        return view_.samples[view_.offset(x, y, z)];
    }

    void read(BrickIndex brick, SampleBlock<Sample>& block) const override {
        const auto coords = bricks_.brickCoords(brick);
        const std::array<std::int64_t, 3> origin{coords[0] * kBrickSide, coords[1] * kBrickSide, coords[2] * kBrickSide};
        block.place(view_.dims, origin);
        const std::size_t count = static_cast<std::size_t>(block.end[0] - block.begin[0]) * sizeof(Sample);
        for (int z = block.begin[2]; z < block.end[2]; ++z)
            for (int y = block.begin[1]; y < block.end[1]; ++y)
                std::memcpy(block.samples.data() + block.offset(block.begin[0], y, z),
                            view_.samples + view_.offset(origin[0] + block.begin[0], origin[1] + y, origin[2] + z), count);
    }

private:
    SampleView<Sample> view_;
    BrickGrid bricks_;
};

} // namespace isoslider::extract
