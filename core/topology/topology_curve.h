#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::topology {

/// What the surface at one isovalue is made of.
struct SurfaceCounts {
    std::int64_t components = 0; ///< pieces
    std::int64_t euler = 0;
    std::int64_t loops = 0; ///< boundary loops, on the box
    std::int64_t voids = 0; ///< components of what is below the isovalue that do not reach the boundary

    /// Tunnels: handles of all pieces together, the genus of a closed surface.
    std::int64_t handles() const { return (2 * components - loops - euler) / 2; }
    friend bool operator==(const SurfaceCounts&, const SurfaceCounts&) = default;
};

enum class EventKind : std::uint8_t { Vertex, FaceSaddle, BodySaddle };
/// "vertex", "face_saddle", "body_saddle".
const char* eventKindName(EventKind kind);

/// An isovalue at which the counts change; several at one isovalue are one.
struct TopologyEvent {
    double isovalue = 0.0; ///< the last at which `below` holds
    EventKind kind = EventKind::Vertex; ///< a vertex if a sample has this scalar
    std::array<float, 3> position{}; ///< of one of its places, in grid index units; of a saddle: the middle of its cell
    SurfaceCounts below, above; ///< at the isovalue, and beyond it
    /// Of a component of what is above or below the isovalue that comes or joins an elder one here: through how many
    /// values it lasts as a separate one. The greatest of several; 0 where none comes or joins.
    double persistence = 0.0;
};

/// The counts at every isovalue, by the isovalues at which they change. TOPOLOGY.md
class TopologyCurve {
public:
    /// Analyses a whole volume. Errors: InvalidArgument (missing values, 2^32 samples or more), Cancelled.
    static Result<TopologyCurve> analyse(const ScalarGrid& grid, const JobControl& job = {});

    /// Ascending.
    const std::vector<TopologyEvent>& events() const { return events_; }
    /// O(log n).
    SurfaceCounts at(double isovalue) const;

private:
    std::vector<TopologyEvent> events_;
};

} // namespace isoslider::topology
