#pragma once

#include <cstdint>
#include <vector>

#include "core/topology/analysis/domain_boundary.h"
#include "core/topology/analysis/forest_stream.h"
#include "core/topology/analysis/layer_components.h"
#include "core/topology/analysis/layer_euler.h"
#include "core/topology/topology_event.h"

namespace isoslider::topology {

/// The counts at some thousand isovalues, without the events between them: for volumes with more of these than memory
/// holds. Takes layers as they come, and keeps what the next may change: memory for some planes of samples.
class CoarseCounts {
public:
    /// `isovalues` ascend.
    explicit CoarseCounts(std::vector<double> isovalues);
    CoarseCounts(const CoarseCounts&) = delete;
    CoarseCounts& operator=(const CoarseCounts&) = delete;

    /// The next layer; `bottom` and `top`: scalars of its outer planes.
    void add(const LayerComponents& above, const LayerComponents& below, const LayerChanges& changes,
             const DomainBoundary::Part& boundary, const std::vector<double>& bottom, const std::vector<double>& top);
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
        void add(const LayerComponents& layer, const std::vector<double>& bottom, const std::vector<double>& top);
        void end();
        ForestStream forest;

    private:
        void settle(std::vector<double> opens);
        Side side_;
        ForestStream::Node outside_ = ForestStream::kNone;
        std::vector<ForestStream::Node> top_; ///< by grid point of the last plane
    };

    // The same on the domain's boundary, where each grid point is a component at first.
    class OnBoundary {
    public:
        OnBoundary(Side side, const std::vector<double>& isovalues) : forest(side, isovalues), side_(side) {}
        void add(const DomainBoundary::Part& part);
        void end();
        ForestStream forest;

    private:
        struct Waiting { // a link to a grid point of the next layer
            double isovalue; ///< the earliest that it may have
            std::array<Point, 2> points;
            bool isEdge; ///< of the grid: from the later of both scalars on
        };
        struct Place {
            ForestStream::Node node;
            double scalar;
        };
        Place find(Point point) const;
        bool addLink(const Waiting& link);

        Side side_;
        std::vector<Point> points_; ///< of the last layer, ascending
        std::vector<Place> places_; ///< of each
        std::vector<Waiting> waiting_;
    };

    std::vector<double> isovalues_;
    Components above_, below_, voids_;
    OnBoundary boundaryAbove_, boundaryBelow_;
    std::vector<std::int64_t> euler_; ///< changes, as in ForestStream
    std::int64_t boundaryEuler_ = 0;
    bool isManifold_ = true;
};

} // namespace isoslider::topology
