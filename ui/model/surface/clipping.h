#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "core/grid/grid_geometry.h"

namespace isoslider::model {

/// Whole cells of a volume: those between two planes of grid points along each axis.
struct CropBox {
    std::array<std::int64_t, 3> low{}, high{}; ///< grid points

    bool operator==(const CropBox&) const = default;
};

/// What closes a surface on a clip plane: nothing, one colour, or the samples in grey.
enum class Cap { None, Colour, Values };

/// A plane in world units about the volume's centre; what lies on the side of its normal is not drawn.
struct ClipPlane {
    bool isOn = false;
    glm::dvec3 normal{1.0, 0.0, 0.0}; ///< unit
    double offset = 0.0; ///< of the plane from the centre, along the normal
    Cap cap = Cap::Colour;

    bool operator==(const ClipPlane&) const = default;
};

/// As many as every graphics card clips by, beside the crop box's faces.
inline constexpr std::size_t kClipPlanes = 2;

/// What of a surface is not drawn because of where it lies.
struct Clipping {
    bool isCropped = false;
    std::optional<CropBox> crop; ///< none: the whole volume
    std::array<ClipPlane, kClipPlanes> planes{ClipPlane(), ClipPlane{false, {0.0, 1.0, 0.0}}};
    std::size_t active = 0; ///< of the planes: that which handles, keys and fields move

    ClipPlane& plane() { return planes[active]; }
    const ClipPlane& plane() const { return planes[active]; }
    bool hasPlane() const { return planes[0].isOn || planes[1].isOn; }
    bool clipsAnything() const { return isCropped || hasPlane(); }

    bool operator==(const Clipping&) const = default;
};

CropBox wholeBox(const GridDims& dims);
/// Brought within the volume, with at least one cell along each axis; the whole volume for none. REQUIRES: dims of at
/// least 2.
CropBox cropWithin(const std::optional<CropBox>& crop, const GridDims& dims);
/// With one face moved to the plane of grid points nearest to `at`, at least one cell away from the face opposite.
CropBox withFace(CropBox box, int axis, bool isHigh, double at, const GridDims& dims);

/// Half-spaces, all of which a place must lie in to be drawn: dot(xyz, place) + w >= 0, in index units of `grid`, which
/// is `volume`, every n-th of its points, or that of another volume in the same space. The six of the crop box come
/// first, then those of the planes.
std::vector<glm::dvec4> cutsOf(const Clipping& clipping, const GridGeometry& grid, const GridGeometry& volume);
inline constexpr std::size_t kMostCuts = 6 + kClipPlanes;

bool isWithin(std::span<const glm::dvec4> cuts, const glm::dvec3& place);
/// What of a segment lies in all half-spaces; none if nothing does.
std::optional<std::pair<glm::dvec3, glm::dvec3>> partWithin(std::span<const glm::dvec4> cuts, glm::dvec3 from,
                                                            glm::dvec3 to);

/// Index units of `grid` to world axes, moved so that the centre of `volume` is the origin.
glm::dvec3 centredWorldOf(const glm::dvec3& place, const GridGeometry& grid, const GridGeometry& volume);

/// The other way round.
glm::dvec3 indexOfCentred(const glm::dvec3& place, const GridGeometry& grid, const GridGeometry& volume);

/// The volume's extent along a unit direction of the world, from its centre: planes farther away miss it.
double reachAlong(const glm::dvec3& direction, const GridGeometry& volume);
/// With a unit normal and an offset that does not leave the volume; as it is without a volume.
ClipPlane planeWithin(ClipPlane plane, const GridGeometry& volume);
/// Turned about a place that stays on it.
ClipPlane turnedTo(ClipPlane plane, const glm::dvec3& normal, const glm::dvec3& about);
ClipPlane flipped(ClipPlane plane);

} // namespace isoslider::model
