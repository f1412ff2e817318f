#pragma once

#include <cstdint>
#include <vector>

#include "core/topology/analysis/boundary_part.h"
#include "core/topology/analysis/boundary_rows.h"
#include "core/topology/analysis/forest_stream.h"
#include "core/topology/analysis/strip_changes.h"
#include "core/topology/analysis/strip_components.h"
#include "core/topology/topology_event.h"

namespace isoslider::topology {

/// The counts at some thousand isovalues, without the events between them: for volumes with more of these than memory
/// holds. Takes layers as they come, and keeps what the next may change: memory for some planes of samples.
class CoarseCounts {
public:
    /// `isovalues` ascend; `boundaryPointsAtOnce` as in BoundaryRows.
    CoarseCounts(std::vector<double> isovalues, std::size_t boundaryPointsAtOnce);
    CoarseCounts(const CoarseCounts&) = delete;
    CoarseCounts& operator=(const CoarseCounts&) = delete;

    /// The next layer; `bottom` and `top`: scalars of its outer planes.
    void add(const StripComponents& above, const StripComponents& below, const StripChanges& changes,
             const BoundaryPart& boundary, const std::vector<double>& bottom, const std::vector<double>& top);
    std::uint64_t sizeBytes() const;

    /// Once all layers are there. At each isovalue.
    std::vector<SurfaceCounts> finish();
    const std::vector<double>& isovalues() const { return isovalues_; }
    /// Whether counts are exact; after finish(). See DomainBoundary::isOfSpheres.
    bool areExact() const;

private:
    // Components of one side in the layers so far. Of what is below, those that are no voids can be left out.
    class Components {
    public:
        Components(Side side, const std::vector<double>& isovalues, bool areVoids);
        void add(const StripComponents& layer, const std::vector<double>& bottom, const std::vector<double>& top);
        void end();
        ForestStream forest;

    private:
        void settle(std::vector<double> opens);
        Side side_;
        ForestStream::Node outside_ = ForestStream::kNone;
        std::vector<ForestStream::Node> top_; ///< by grid point of the last plane
    };

    // The same on the domain's boundary, as BoundaryRows fills it.
    struct OnBoundary {
        ForestStream::Node addNode(Point, double scalar) { return forest.addNode(scalar); }
        void addLink(double isovalue, const Cause&, ForestStream::Node a, ForestStream::Node b) {
            forest.addLink(isovalue, a, b);
        }
        ForestStream::Node nodes() const { return forest.nodes(); }
        std::vector<ForestStream::Node> settle(const std::vector<double>& opens) { return forest.settle(opens); }

        ForestStream forest;
    };

    std::vector<double> isovalues_;
    Components above_, below_, voids_;
    BoundaryRows<OnBoundary> boundaryAbove_, boundaryBelow_;
    std::vector<std::int64_t> euler_; ///< changes, as in ForestStream
    std::int64_t boundaryEuler_ = 0;
    bool isManifold_ = true;
};

} // namespace isoslider::topology
