#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::index {

/// Single samples by place, for walks through a part of a volume: blocks of 16^3 are read when they are first needed,
/// and kept while there is room (kMostBlocks, 128 MB). One thread at a time.
class SampleBlocks {
public:
    static constexpr std::int64_t kSide = 16;
    static constexpr std::size_t kSamples = std::size_t{kSide} * kSide * kSide;
    static constexpr std::size_t kMostBlocks = 4096;

    virtual ~SampleBlocks() = default;
    SampleBlocks(const SampleBlocks&) = delete;
    SampleBlocks& operator=(const SampleBlocks&) = delete;

    const GridDims& dims() const { return dims_; }
    /// NaN for a missing sample, outside the grid, and once reading has failed.
    double at(std::int64_t x, std::int64_t y, std::int64_t z) {
        if (static_cast<std::uint64_t>(x) >= static_cast<std::uint64_t>(dims_[0]) ||
            static_cast<std::uint64_t>(y) >= static_cast<std::uint64_t>(dims_[1]) ||
            static_cast<std::uint64_t>(z) >= static_cast<std::uint64_t>(dims_[2]))
            return std::numeric_limits<double>::quiet_NaN();
        const double* const block = blockAt(x / kSide, y / kSide, z / kSide);
        return block == nullptr ? std::numeric_limits<double>::quiet_NaN()
                                : block[x % kSide + kSide * (y % kSide + kSide * (z % kSide))];
    }
    /// Whether all reads have succeeded. Errors: IoError, Corruption, OutOfSpace.
    const Status& status() const { return status_; }

protected:
    explicit SampleBlocks(const GridDims& dims);
    /// Fills `out`, x fastest, missing samples NaN; what lies outside the grid may be left as it is.
    virtual Status read(const std::array<std::int64_t, 3>& block, std::span<double, kSamples> out) = 0;

private:
    const double* blockAt(std::int64_t bx, std::int64_t by, std::int64_t bz) {
        const auto number = static_cast<std::size_t>(bx + count_[0] * (by + count_[1] * bz));
        const double* const block = blocks_[number].get();
        return block != nullptr ? block : load(number, {bx, by, bz});
    }
    const double* load(std::size_t number, const std::array<std::int64_t, 3>& block);

    GridDims dims_;
    std::array<std::int64_t, 3> count_; ///< blocks along each axis
    std::vector<std::unique_ptr<double[]>> blocks_; ///< by number; null: not read
    std::vector<std::size_t> kept_;
    Status status_;
};

/// Of a volume in memory.
std::shared_ptr<SampleBlocks> makeSampleBlocks(std::shared_ptr<const ScalarGrid> grid);
/// Of an index. Errors: those of opening it.
Result<std::shared_ptr<SampleBlocks>> openSampleBlocks(const std::filesystem::path& indexPath);

} // namespace isoslider::index
