// Which neighbours are higher, under every instruction set that the machine has, against plain comparisons.

#include <array>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/extract/sources/sample_kernels.h"
#include "core/topology/analysis/higher_neighbours.h"

namespace isoslider::topology {
namespace {

class HigherNeighboursTest : public testing::TestWithParam<std::size_t> {
protected:
    void SetUp() override { extract::useKernelTarget(GetParam()); }
    void TearDown() override { extract::useKernelTarget(0); }
};

std::string nameOfTarget(const testing::TestParamInfo<std::size_t>& info) {
    return extract::kernelTargets().at(info.param);
}

INSTANTIATE_TEST_SUITE_P(Targets, HigherNeighboursTest, testing::Range(std::size_t{0}, extract::kernelTargets().size()),
                         nameOfTarget);

// Steps along x, y and z to each of the eighteen.
std::array<std::array<std::int64_t, 3>, 18> allSteps() {
    std::array<std::array<std::int64_t, 3>, 18> steps{};
    const auto edge = [](std::size_t neighbour) {
        std::array<std::int64_t, 3> step{};
        step[neighbour / 2] = neighbour % 2 == 0 ? -1 : 1;
        return step;
    };
    for (std::size_t n = 0; n < 6; ++n)
        steps[n] = edge(n);
    for (std::size_t f = 0; f < kFacePairs.size(); ++f)
        for (std::size_t a = 0; a < 3; ++a)
            steps[6 + f][a] = edge(kFacePairs[f][0])[a] + edge(kFacePairs[f][1])[a];
    return steps;
}

template <class Sample>
void expectAll(const GridDims& dims, bool hasBefore, bool hasAfter, int values) {
    SCOPED_TRACE(testing::Message() << dims[0] << " x " << dims[1] << " x " << dims[2] << ", " << values << " values");
    std::mt19937 random(static_cast<unsigned>(values));
    const std::int64_t plane = dims[0] * dims[1], first = hasBefore ? 1 : 0;
    const std::int64_t end = dims[2] - (hasAfter ? 1 : 0); // of the planes that are asked about
    std::vector<Sample> samples;
    for (std::int64_t i = 0; i < plane * dims[2]; ++i)
        samples.push_back(static_cast<Sample>(static_cast<int>(random() % static_cast<unsigned>(values)) - values / 2));
    HigherNeighbours higher;
    higher.find(samples.data() + plane * first, dims, end - first, hasBefore, hasAfter);
    const auto steps = allSteps();
    for (std::int64_t z = first; z < end; ++z)
        for (std::int64_t y = 0; y < dims[1]; ++y)
            for (std::int64_t x = 0; x < dims[0]; ++x) {
                const std::int64_t at = x + dims[0] * y + plane * z;
                const Neighbours found = higher.at(at - plane * first);
                ASSERT_EQ(found & 63, higher.edges()[at - plane * first]);
                ASSERT_EQ(found & ~kAllNeighbours, 0u);
                for (std::size_t n = 0; n < steps.size(); ++n) {
                    const std::array<std::int64_t, 3> to{x + steps[n][0], y + steps[n][1], z + steps[n][2]};
                    bool isThere = true;
                    for (std::size_t a = 0; a < 3; ++a)
                        isThere = isThere && to[a] >= 0 && to[a] < dims[a];
                    if (!isThere)
                        continue;
                    const std::int64_t other = to[0] + dims[0] * to[1] + plane * to[2];
                    const Sample own = samples[static_cast<std::size_t>(at)],
                                 its = samples[static_cast<std::size_t>(other)];
                    ASSERT_EQ((found >> n & 1u) != 0, its > own || (its == own && other > at))
                        << "neighbour " << n << " of " << x << ", " << y << ", " << z;
                }
            }
}

TEST_P(HigherNeighboursTest, AreThoseOfPlainComparisons) {
    for (const int values : {2, 100}) {
        for (const GridDims& dims : {GridDims{2, 2, 2}, GridDims{7, 3, 4}, GridDims{67, 5, 5}, GridDims{130, 2, 3}}) {
            expectAll<std::uint8_t>(dims, false, false, values);
            expectAll<std::int8_t>(dims, false, false, values);
            expectAll<std::uint16_t>(dims, false, false, values);
            expectAll<std::int16_t>(dims, false, false, values);
            expectAll<std::int32_t>(dims, false, false, values);
            expectAll<float>(dims, false, false, values);
            expectAll<double>(dims, false, false, values);
        }
        expectAll<std::int16_t>({40, 6, 6}, true, false, values);
        expectAll<float>({40, 6, 6}, true, true, values);
    }
}

} // namespace
} // namespace isoslider::topology
