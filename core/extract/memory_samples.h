#pragma once

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "core/extract/sample_reader.h"
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
    Result<Sample> sampleAt(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t&) const override {
        return view_.samples[view_.offset(x, y, z)];
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
