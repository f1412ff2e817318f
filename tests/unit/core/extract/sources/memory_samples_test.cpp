#include "core/extract/sources/memory_samples.h"

#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/scalar_type_of.h"

namespace isoslider::extract {
namespace {

template <class Sample>
class MemorySamplesTest : public testing::Test {};
using SampleTypes = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::int32_t, float, double>;
TYPED_TEST_SUITE(MemorySamplesTest, SampleTypes);

// Whole rows are copied where that stays in the volume; each brick of small boxes, the first and the last too.
TYPED_TEST(MemorySamplesTest, FillTheBox) {
    std::mt19937_64 random(7);
    for (int round = 0; round < 60; ++round) {
        GridGeometry geometry;
        for (auto& d : geometry.dims)
            d = 1 + static_cast<std::int64_t>(random() % 27);
        const GridDims& n = geometry.dims;
        std::vector<TypeParam> samples(static_cast<std::size_t>(n[0] * n[1] * n[2]));
        for (TypeParam& sample : samples)
            sample = static_cast<TypeParam>(random() % 128);
        const ScalarGrid grid = ScalarGrid::fromValues<TypeParam>(geometry, test::scalarTypeOf<TypeParam>(), samples);
        const MemorySamples<TypeParam> reader(grid);
        const BrickGrid bricks(geometry.dims);
        const auto block = std::make_unique<SampleBlock<TypeParam>>();
        for (std::uint64_t brick = 0; brick < bricks.brickCount(); ++brick) {
            readBlock(reader.rows(static_cast<BrickIndex>(brick)), *block);
            const auto coords = bricks.brickCoords(static_cast<BrickIndex>(brick));
            for (int z = -1; z < 10; ++z)
                for (int y = -1; y < 10; ++y)
                    for (int x = -1; x < 10; ++x) {
                        const std::int64_t gx = 8 * coords[0] + x, gy = 8 * coords[1] + y, gz = 8 * coords[2] + z;
                        const bool isInside = gx >= 0 && gx < n[0] && gy >= 0 && gy < n[1] && gz >= 0 && gz < n[2];
                        ASSERT_EQ(block->isInside(x, y, z), isInside);
                        if (!isInside)
                            continue;
                        ASSERT_EQ(block->samples[static_cast<std::size_t>(block->offset(x, y, z))],
                                  samples[static_cast<std::size_t>(gx + n[0] * (gy + n[1] * gz))]);
                    }
        }
    }
}

} // namespace
} // namespace isoslider::extract
