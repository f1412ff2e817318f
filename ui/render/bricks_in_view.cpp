#include "ui/render/bricks_in_view.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace isoslider::render {
namespace {

using extract::PictureBrick;

/// The planes of the view: what is in it is on the positive side of each.
std::vector<glm::dvec4> viewPlanes(const glm::dmat4& modelToClip) {
    const auto row = [&](int i) {
        return glm::dvec4(modelToClip[0][i], modelToClip[1][i], modelToClip[2][i], modelToClip[3][i]);
    };
    return {row(3) + row(0), row(3) - row(0), row(3) + row(1), row(3) - row(1), row(3) + row(2), row(3) - row(2)};
}

bool isInView(const PictureBrick& brick, const std::vector<glm::dvec4>& planes) {
    const auto origin = brick.origin();
    const glm::dvec3 low(origin[0], origin[1], origin[2]);
    return std::all_of(planes.begin(), planes.end(), [&](const glm::dvec4& plane) {
        // The corner that lies farthest along the plane's normal.
        const glm::dvec3 corner =
            low + glm::dvec3(extract::kCellSide) * glm::dvec3(plane.x > 0.0, plane.y > 0.0, plane.z > 0.0);
        return glm::dot(glm::dvec3(plane), corner) + plane.w >= 0.0;
    });
}

} // namespace

void listBricksInView(std::span<const PictureBrick> bricks, const glm::dmat4& modelToClip,
                      std::span<const glm::dvec4> cuts, std::vector<BrickInView>& inView) {
    auto planes = viewPlanes(modelToClip);
    planes.insert(planes.end(), cuts.begin(), cuts.end());
    const glm::vec4 depth(modelToClip[0][3], modelToClip[1][3], modelToClip[2][3], 0.0); // w of a place
    const glm::vec4 along(modelToClip[0][2], modelToClip[1][2], modelToClip[2][2], 0.0); // z, for a parallel projection
    const bool isPerspective = glm::dot(depth, depth) > 0.0f;
    inView.clear();
    for (std::size_t slot = 0; slot < bricks.size(); ++slot) {
        const PictureBrick& brick = bricks[slot];
        if (brick.indexCount == 0 || !isInView(brick, planes))
            continue;
        const glm::vec4 place(brick.place[0], brick.place[1], brick.place[2], 0.0);
        inView.push_back({glm::dot(isPerspective ? depth : along, place), static_cast<std::uint32_t>(slot)});
    }
}

} // namespace isoslider::render
