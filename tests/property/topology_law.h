#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/extract/slide_engine.h"
#include "core/extract/surface_mesh.h"
#include "tests/support/slab_oracle.h"
#include "tests/support/topology_grids.h"

namespace isoslider::test {

/// Empty, or the first thing that is wrong with a surface of the grid: other components, Euler number,
/// boundary loops or active edges than the trilinear interpolant's, an edge or vertex that is no manifold's,
/// a triangle twice or with a vertex twice, a border off the box, a vertex outside it or not finite.
std::string surfaceFault(const extract::SurfaceMesh& mesh, const TopologyGrid& grid);
/// The same with the counts known beforehand.
std::string surfaceFault(const extract::SurfaceMesh& mesh, const TopologyGrid& grid, const GridTopology& expected);

/// Extracts the grid afresh and judges it.
std::string freshFault(const TopologyGrid& grid, double isovalue);

/// A grid with an index and an engine on it.
class TopologyWalker {
public:
    /// `skipLevels` and `threshold` as in preprocess::BuildOptions.
    TopologyWalker(const TopologyGrid& grid, const std::filesystem::path& path, int skipLevels, double threshold);

    /// Empty when the engine is open.
    const std::string& fault() const { return fault_; }

    /// Slides there; empty, or how the surface differs from the fresh one (or what is wrong with that one,
    /// where `isJudged`).
    std::string slideFault(double isovalue, bool isJudged);

    /// Somewhere to go next (see topologyIsovalue), half of the time not far: so that the engine patches.
    double nextIsovalue(Random& random) const;
    std::int64_t patchedMoves() const { return patchedMoves_; }

private:
    const TopologyGrid& grid_;
    std::unique_ptr<extract::SlideEngine> engine_;
    std::string fault_;
    double isovalue_ = 0.0;
    std::int64_t patchedMoves_ = 0;
};

} // namespace isoslider::test
