#include "core/volume_io/formats/images/nrrd_geometry.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "core/base/plain_text.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

/// Of the spaces that a header can name, all of three dimensions; those with time have lost it before. `toLps`: what
/// each coordinate is multiplied with.
struct Space {
    std::string_view name, shortName;
    glm::dvec3 toLps;
    bool isPatient; ///< else the directions of the axes have no meaning
};
const Space kSpaces[] = {{"right-anterior-superior", "ras", {-1.0, -1.0, 1.0}, true},
                         {"left-anterior-superior", "las", {1.0, -1.0, 1.0}, true},
                         {"left-posterior-superior", "lps", {1.0, 1.0, 1.0}, true},
                         {"scanner-xyz", "", {1.0, 1.0, 1.0}, false},
                         {"3d-right-handed", "", {1.0, 1.0, 1.0}, false},
                         {"3d-left-handed", "", {1.0, 1.0, 1.0}, false}};

struct World {
    std::size_t dimension = 0; ///< none where the header names no space
    glm::dvec3 toLps{1.0};
    bool isPatient = false;
};

Result<World> readWorld(const NrrdHeader& header, const fs::path& path) {
    const std::string name = lowerCase(header["space"]);
    const std::string_view dimension = header["space dimension"];
    if (!name.empty()) {
        const Space* found = std::ranges::find_if(
            kSpaces, [&](const Space& space) { return name == space.name || name == space.shortName; });
        if (found == std::end(kSpaces))
            return refuseField("space", inQuotes(header["space"]) + " is not a known space", path);
        if (!dimension.empty())
            return refuseField("space dimension", "is given beside a named space", path);
        return World{3, found->toLps, found->isPatient};
    }
    if (dimension.empty())
        return World{};
    const auto number = parseInteger(dimension);
    if (!number || *number < 1 || *number > 3)
        return refuseField("space dimension", inQuotes(dimension) + " is not a number from 1 to 3", path);
    return World{static_cast<std::size_t>(*number), glm::dvec3(1.0), false};
}

glm::dvec3 toVector(const std::vector<double>& numbers) {
    glm::dvec3 vector(0.0);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        vector[static_cast<int>(i)] = numbers[i];
    return vector;
}

using Axes = std::vector<const NrrdAxis*>;

// Without directions: distances, and places where all axes state them.
void placeByAxes(const Axes& axes, GridGeometry& geometry) {
    bool isPlaced = true;
    glm::dvec3 origin(0.0);
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const int axis = static_cast<int>(i);
        const auto spacing = parseReal(axes[i]->spacing), minimum = parseReal(axes[i]->minimum);
        isPlaced &= spacing && std::isfinite(*spacing) && minimum && std::isfinite(*minimum);
        if (spacing && std::isfinite(*spacing))
            geometry.spacing[axis] = *spacing;
        const bool isNode = axes[i]->center == "node"; // of what is not stated, teem takes samples to be cells
        if (isPlaced)
            origin[axis] = *minimum + (isNode ? 0.0 : *spacing / 2.0);
    }
    if (isPlaced)
        geometry.origin = origin;
}

Status placeByDirections(const Axes& axes, const World& world, GridGeometry& geometry, const fs::path& path) {
    for (std::size_t i = 0; i < axes.size(); ++i) {
        if (axes[i]->direction->size() != world.dimension)
            return refuseField("space directions",
                               "vectors of " + std::to_string(world.dimension) + " numbers expected, found " +
                                   std::to_string(axes[i]->direction->size()),
                               path);
        const glm::dvec3 step = toVector(*axes[i]->direction) * world.toLps;
        geometry.spacing[static_cast<int>(i)] = glm::length(step);
        geometry.direction[static_cast<int>(i)] = step / glm::length(step);
    }
    completeAxes(geometry.direction, static_cast<int>(axes.size()));
    return {};
}

Status placeOrigin(const NrrdHeader& header, const World& world, GridGeometry& geometry, const fs::path& path) {
    const std::string_view text = header["space origin"];
    if (text.empty())
        return {};
    const auto origin = parseNrrdVector(text);
    if (!origin || origin->size() != world.dimension)
        return refuseField(
            "space origin",
            "a vector of " + std::to_string(world.dimension) + " numbers expected, found " + inQuotes(text), path);
    if (!std::ranges::all_of(*origin, [](double number) { return std::isnan(number); })) // NaN: unknown
        geometry.origin = toVector(*origin) * world.toLps;
    return {};
}

} // namespace

Result<NrrdPlace> readNrrdPlace(const NrrdHeader& header, std::vector<std::string>& notes, const fs::path& path) {
    const auto world = readWorld(header, path);
    if (!world.isOk())
        return world.error();
    Axes axes;
    for (const NrrdAxis& axis : header.axes)
        if (axis.role == NrrdRole::Space)
            axes.push_back(&axis);
    NrrdPlace place;
    GridGeometry& geometry = place.geometry;
    geometry.dims = header.dims();
    const bool hasDirections =
        std::ranges::all_of(axes, [](const NrrdAxis* axis) { return axis->direction.has_value(); });
    if (hasDirections && world.value().dimension == 0)
        return refuseField("space directions", "need a space, or its dimension", path);
    if (world.value().dimension > 0)
        ISO_TRY(placeOrigin(header, world.value(), geometry, path));
    if (hasDirections) {
        ISO_TRY(placeByDirections(axes, world.value(), geometry, path));
        place.isPatientSpace = world.value().isPatient;
        return place;
    }
    for (const NrrdAxis* axis : axes)
        if (!axis->maximum.empty() && (axis->spacing.empty() || axis->spacing == "nan"))
            notes.push_back("axis mins " + inQuotes(axis->minimum) + " and axis maxs " + inQuotes(axis->maximum) +
                            " give no spacing: 1 is taken");
    if (world.value().dimension > 0)
        notes.push_back("names a space but no directions in it; the axes are taken as they are");
    placeByAxes(axes, geometry);
    return place;
}

} // namespace isoslider::io
