#include "ui/model/surface/stage.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

constexpr double kNeedle = 10.0; // longest side of the box over the shortest
constexpr double kOtherUnit = 5.0; // largest spacing over the smallest
constexpr double kSurelyOtherUnit = 20.0; // the same, where it is so even for few points along the longest side
constexpr double kTower = 2.0; // that longest side over the middle one
constexpr double kFlat = 4.0; // what a side is shorter at most than the middle one, and longer

/// The nearest of 1, 2, 5, 10, ... in ratio.
double roundFactor(double factor) {
    const double power = std::pow(10.0, std::floor(std::log10(factor)));
    double best = power;
    for (const double digit : {2.0, 5.0, 10.0})
        if (std::abs(std::log(digit * power / factor)) < std::abs(std::log(best / factor)))
            best = digit * power;
    return best;
}

} // namespace

bool isStretched(const glm::dvec3& stretch) { return stretch != glm::dvec3(1.0); }

glm::dvec3 stretchWithin(const glm::dvec3& stretch) {
    glm::dvec3 within(1.0);
    for (int axis = 0; axis < 3; ++axis)
        if (std::isfinite(stretch[axis]) && stretch[axis] > 0.0)
            within[axis] = std::clamp(stretch[axis], 1.0 / kMostStretch, kMostStretch);
    return within;
}

glm::dmat3 stretchMatrix(const glm::dvec3& stretch, const GridGeometry& volume) {
    if (!isStretched(stretch))
        return glm::dmat3(1.0);
    glm::dmat3 along = volume.direction;
    for (int axis = 0; axis < 3; ++axis)
        along[axis] *= stretch[axis];
    return along * glm::inverse(volume.direction);
}

GridGeometry stretched(GridGeometry geometry, const glm::dvec3& stretch) {
    geometry.spacing *= stretch;
    return geometry;
}

std::optional<glm::dvec3> suggestedStretch(const GridGeometry& volume) {
    glm::dvec3 sides(0.0);
    for (int axis = 0; axis < 3; ++axis)
        sides[axis] =
            std::abs(volume.spacing[axis]) * static_cast<double>(volume.dims[static_cast<std::size_t>(axis)] - 1);
    const glm::dvec3 steps = glm::abs(volume.spacing);
    std::array<double, 3> sorted{sides.x, sides.y, sides.z};
    std::sort(sorted.begin(), sorted.end());
    const auto [least, most] = std::minmax({steps.x, steps.y, steps.z});
    if (!(sorted[0] > 0.0) || !std::isfinite(sorted[2]))
        return std::nullopt;
    const bool isNeedle = sorted[2] >= kNeedle * sorted[0] && most >= kOtherUnit * least;
    const bool isTower = sorted[2] >= kTower * sorted[1] && most >= kSurelyOtherUnit * least;
    if (!isNeedle && !isTower)
        return std::nullopt;
    const double longest = isTower ? kTower : kFlat;
    glm::dvec3 stretch(1.0);
    for (int axis = 0; axis < 3; ++axis) {
        if (sides[axis] > longest * sorted[1])
            stretch[axis] = roundFactor(sorted[1] / sides[axis]);
        else if (sides[axis] < sorted[1] / kFlat)
            stretch[axis] = roundFactor(0.5 * sorted[1] / sides[axis]);
    }
    stretch = stretchWithin(stretch);
    return isStretched(stretch) ? std::optional(stretch) : std::nullopt;
}

std::string stretchText(const glm::dvec3& stretch, const AxisNames& names) {
    std::string text;
    for (int axis = 0; axis < 3; ++axis)
        if (stretch[axis] != 1.0)
            text += (text.empty() ? "" : ", ") + names.nameOf(axis) + " × " + valueText(stretch[axis], 4);
    return text;
}

} // namespace isoslider::model
