// Forecasts of real volumes, where the folder with further test data is there.

#include <gtest/gtest.h>

#include "core/index/format/index_format.h"
#include "core/index/index_reader.h"
#include "core/topology/stored_topology.h"
#include "core/topology/topology_analysis.h"
#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace isoslider::preprocess {
namespace {

using test::IsOk;

class OfRealVolume : public testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(volume_))
            GTEST_SKIP() << "further test data is not here: " << volume_;
    }
    const std::filesystem::path volume_ = std::filesystem::path(test::sharedFolder()) / "data" / GetParam();
    const test::TemporaryFolder folder_;
};

class ForecastOfRealVolume : public OfRealVolume {};

TEST_P(ForecastOfRealVolume, IsNearTheTruth) {
    for (const auto kind : {index::IndexKind::Edges, index::IndexKind::Metacells}) {
        SCOPED_TRACE(index::indexKindName(kind));
        const auto source = io::openVolume(volume_);
        ASSERT_THAT(source, IsOk());
        BuildOptions options;
        options.kind = kind;
        const auto built = buildIndex(*source.value(), folder_ / "a.isx", options);
        ASSERT_THAT(built, IsOk());
        const BuildReport& report = built.value();
        const double ratio =
            static_cast<double>(report.forecast.indexBytes) / static_cast<double>(report.info.indexBytes);
        RecordProperty(index::indexKindName(kind), std::to_string(ratio));
        EXPECT_NEAR(ratio, 1.0, 0.15);
        EXPECT_LE(report.temporaryBytes, report.forecast.temporaryBytes);
    }
}

class ForecastOfRealTopology : public OfRealVolume {};

TEST_P(ForecastOfRealTopology, IsNearTheTruth) {
    const auto grid = io::readVolume(volume_);
    ASSERT_THAT(grid, IsOk());
    BuildOptions options;
    options.kind = index::IndexKind::Metacells;
    options.withTopology = true;
    const auto built = buildIndex(*io::openVolume(volume_).value(), folder_ / "a.isx", options);
    ASSERT_THAT(built, IsOk());
    const auto curve = topology::analyseTopology(topology::planesOf(*grid.value()));
    const auto reader = index::IndexReader::open(folder_ / "a.isx");
    ASSERT_THAT(topology::storeTopology(*reader.value(), curve.value()), IsOk());
    const DiskForecast& forecast = built.value().forecast;
    const double ratio = static_cast<double>(forecast.indexBytes + forecast.topologyBytes) /
                         static_cast<double>(std::filesystem::file_size(folder_ / "a.isx"));
    RecordProperty("ratio", std::to_string(ratio));
    EXPECT_NEAR(ratio, 1.0, 0.15);
    EXPECT_GT(forecast.topologyBytes, forecast.indexBytes / 3);
}

constexpr auto nameOf = [](const auto& test) {
    std::string name(test.param);
    for (char& c : name)
        c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return name;
};

INSTANTIATE_TEST_SUITE_P(Volumes, ForecastOfRealTopology,
                         testing::Values("nifti/mricron_ch2.nii.gz", "nrrd/tooth/tooth.nhdr",
                                         "density/JMJD2DA-x336_event2.ccp4.gz"),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Volumes, ForecastOfRealVolume,
                         testing::Values("mhd/cranium.mhd", "nifti/mricron_ch2.nii.gz",
                                         "nifti/mricron_inia19-t1-brain.nii.gz", "nrrd/tooth/tooth.nhdr",
                                         "mha/hydrogenAtom.mha", "mha/neghip.mha", "mha/blob0.mha", "vti/vase.vti",
                                         "vti/isabel_02.vti", "vti/viscousfingers_001.vti",
                                         "density/JMJD2DA-x336_event2.ccp4.gz", "nrrd/pyradiomics_brain1_image.nrrd"),
                         nameOf);

} // namespace
} // namespace isoslider::preprocess
