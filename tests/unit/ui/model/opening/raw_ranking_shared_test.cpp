// The samples of real volumes, written without their headers, in either byte order.
#include <algorithm>

#include <gtest/gtest.h>

#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"
#include "ui/model/opening/raw_ranking.h"

namespace isoslider::model {
namespace {

using test::IsOk;

const std::filesystem::path kData = std::filesystem::path(test::sharedFolder()) / "data";

class RawRankingOf : public testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(kData / GetParam()))
            GTEST_SKIP() << "further test data is not here: " << kData / GetParam();
    }
    test::TemporaryFolder folder_;
};

std::string samplesOf(const ScalarGrid& grid, bool isBigEndian) {
    const auto bytes = grid.bytes();
    std::string raw(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto size = static_cast<std::ptrdiff_t>(scalarTypeSizeBytes(grid.type()));
    for (auto sample = raw.begin(); isBigEndian && sample != raw.end(); sample += size)
        std::reverse(sample, sample + size);
    return raw;
}

bool hasNegative(const ScalarGrid& grid) {
    return grid.visit(
        [](auto samples) { return std::any_of(samples.begin(), samples.end(), [](auto value) { return value < 0; }); });
}

TEST_P(RawRankingOf, PutsTheTrueArrangementFirst) {
    const auto grid = io::readVolume(kData / GetParam());
    ASSERT_THAT(grid, IsOk());
    const bool hasOrder = scalarTypeSizeBytes(grid.value()->type()) > 1;
    for (const bool isBigEndian : {false, true}) {
        const auto guesses = rankRawLayouts(folder_.write("real.raw", samplesOf(*grid.value(), isBigEndian)));
        ASSERT_THAT(guesses, IsOk());
        ASSERT_FALSE(guesses.value().empty());
        for (const auto& guess : guesses.value())
            std::printf("%lld x %lld x %lld %s %s, %.2f, cost %.2f\n", static_cast<long long>(guess.layout.dims[0]),
                        static_cast<long long>(guess.layout.dims[1]), static_cast<long long>(guess.layout.dims[2]),
                        std::string(scalarTypeName(guess.layout.type)).c_str(),
                        guess.layout.isBigEndian ? "big" : "little", guess.smoothness, guess.cost);
        const auto& found = guesses.value().front().layout;
        EXPECT_EQ(found.dims, grid.value()->dims());
        // What is never negative is the same with and without a sign.
        const bool isTwin =
            grid.value()->type() == ScalarType::I16 && found.type == ScalarType::U16 && !hasNegative(*grid.value());
        EXPECT_TRUE(isTwin || found.type == grid.value()->type()) << scalarTypeName(found.type);
        EXPECT_EQ(found.isBigEndian, isBigEndian && hasOrder);
        EXPECT_EQ(found.skipBytes, 0u);
    }
}

INSTANTIATE_TEST_SUITE_P(Real, RawRankingOf,
                         testing::Values("mha/hydrogenAtom.mha", "mha/neghip.mha", "mha/fuel.mha", "mhd/cranium.mhd",
                                         "nifti/mricron_ch2.nii.gz", "nrrd/tooth/tooth.nhdr",
                                         "nrrd/pyradiomics_brain1_image.nrrd", "vti/vase.vti",
                                         "vti/viscousfingers_001.vti", "vti/isabel_02.vti"));

} // namespace
} // namespace isoslider::model
