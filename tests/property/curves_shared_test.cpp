// Curves of real volumes against the surfaces that are extracted, where the folder with further test data is there.

#include <cmath>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/mesh/mesh_checks.h"
#include "core/topology/measuring.h"
#include "core/topology/topology_analysis.h"
#include "core/topology/topology_curve.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/test_paths.h"

namespace isoslider::topology {
namespace {

using test::IsOk;

class CurvesShared : public testing::TestWithParam<const char*> {};

TEST_P(CurvesShared, AreWithinHalfAPercent) {
    const auto path = std::filesystem::path(test::sharedFolder()) / "data" / GetParam();
    if (!std::filesystem::exists(path))
        GTEST_SKIP() << "further test data is not here: " << path;
    const auto read = io::readVolume(path);
    ASSERT_THAT(read, IsOk());
    const ScalarGrid& grid = *read.value();
    AnalysisOptions options;
    options.measures = planMeasures(grid);
    const auto analysed = analyseTopology(planesOf(grid), options);
    ASSERT_THAT(analysed, IsOk());
    const MeasureCurves& curves = analysed.value().curves();
    ASSERT_GT(curves.isovalues.size(), 100u);
    for (std::size_t at = curves.isovalues.size() / 12; at < curves.isovalues.size();
         at += curves.isovalues.size() / 6) {
        const auto surface = extract::extractFull(grid, curves.isovalues[at]);
        ASSERT_THAT(surface, IsOk());
        const mesh::MeshReport mesh = mesh::checkMesh(surface.value());
        const SurfaceMeasures& measures = curves.measures[at];
        EXPECT_NEAR(measures.area, mesh.area, 0.005 * mesh.area) << curves.isovalues[at];
        const auto triangles = static_cast<double>(mesh.triangles);
        EXPECT_NEAR(measures.triangles, triangles, 0.01 * triangles) << curves.isovalues[at];
        if (mesh.isClosed) {
            EXPECT_NEAR(measures.volume, std::abs(mesh.enclosedVolume), 0.005 * std::abs(mesh.enclosedVolume));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Volumes, CurvesShared,
                         testing::Values("mhd/cranium.mhd", "density/JMJD2DA-x336_event2.ccp4.gz",
                                         "plot3d/bluntfinxyz.bin"),
                         [](const auto& parameter) {
                             const std::string name = std::filesystem::path(parameter.param).stem().string();
                             return name.substr(0, name.find_first_of("-."));
                         });

} // namespace
} // namespace isoslider::topology
