#pragma once

#include <algorithm>
#include <cstring>

#include "core/extract/sample_block.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::extract {

/// The samples of a volume in memory.
template <class Sample>
class MemorySamples final : public SampleReader<Sample> {
public:
    /// `grid` must outlive the reader.
    explicit MemorySamples(const ScalarGrid& grid) : view_{grid.values<Sample>().data(), grid.dims()}, bricks_(grid.dims()) {}

    Status read(BrickIndex brick, SampleBlock<Sample>& block, std::uint64_t&) const override {
        const auto coords = bricks_.brickCoords(brick);
        const std::array<std::int64_t, 3> origin{coords[0] * kBrickSide, coords[1] * kBrickSide, coords[2] * kBrickSide};
        block.place(view_.dims, origin);
        const std::size_t count = static_cast<std::size_t>(block.end[0] - block.begin[0]) * sizeof(Sample);
        for (int z = block.begin[2]; z < block.end[2]; ++z)
            for (int y = block.begin[1]; y < block.end[1]; ++y)
                std::memcpy(block.samples.data() + block.offset(block.begin[0], y, z),
                            view_.samples + view_.offset(origin[0] + block.begin[0], origin[1] + y, origin[2] + z), count);
        return {};
    }

private:
    SampleView<Sample> view_;
    BrickGrid bricks_;
};

} // namespace isoslider::extract
