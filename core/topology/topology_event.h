#pragma once

#include <array>
#include <cstdint>

namespace isoslider::topology {

/// What the surface at one isovalue is made of.
struct SurfaceCounts {
    std::int64_t components = 0; ///< pieces
    std::int64_t euler = 0;
    std::int64_t loops = 0; ///< boundary loops, on the box or where samples are missing
    std::int64_t voids = 0; ///< components of what is below the isovalue that do not reach the boundary

    /// Tunnels: handles of all pieces together, the genus of a closed surface.
    std::int64_t handles() const { return (2 * components - loops - euler) / 2; }
    friend bool operator==(const SurfaceCounts&, const SurfaceCounts&) = default;
};

enum class EventKind : std::uint8_t { Vertex, FaceSaddle, BodySaddle };
/// "vertex", "face_saddle", "body_saddle".
const char* eventKindName(EventKind kind);

/// What happens to pieces where the isovalue rises beyond an event; ties at one isovalue add up. Those that last no
/// while are not counted, so the sums may differ from the change of the counts only where there are none.
struct PieceChanges {
    std::uint32_t births = 0; ///< a piece comes, round a minimum
    std::uint32_t deaths = 0; ///< a piece goes, at a maximum
    std::uint32_t joins = 0; ///< two pieces become one
    std::uint32_t splits = 0; ///< a piece becomes two
    friend bool operator==(const PieceChanges&, const PieceChanges&) = default;
};

/// An isovalue at which the counts change; several at one isovalue are one.
struct TopologyEvent {
    double isovalue = 0.0; ///< the last at which `below` holds
    EventKind kind = EventKind::Vertex; ///< a vertex if a sample has this scalar
    std::array<float, 3> position{}; ///< of one of its places, in grid index units; of a saddle: the middle of its cell
    SurfaceCounts below, above; ///< at the isovalue, and beyond it
    PieceChanges pieces;
    /// Of a component of what is above or below the isovalue that comes or joins an elder one here: through how many
    /// values it lasts as a separate one. The greatest of several; 0 where none comes or joins.
    double persistence = 0.0;
};

} // namespace isoslider::topology
