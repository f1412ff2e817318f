#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "core/base/job_control.h"
#include "core/extract/live/brick_picture.h"
#include "core/extract/surface_frame.h"

namespace isoslider::model {

/// Calls `visit` with the place of each vertex that a triangle has, some of them several times; in index units of the
/// frame. False when stopped.
template <class Visit>
bool visitVertices(const extract::SurfaceFrame& frame, const JobControl& job, Visit&& visit) {
    constexpr std::size_t kBricksTogether = 1 << 10; // between two looks at whether to stop
    if (frame.bricks == nullptr) {
        for (const std::uint32_t vertex : frame.indices)
            visit(glm::dvec3(frame.positions[vertex]));
        return !job.isStopRequested();
    }
    const auto bricks = frame.bricks->bricks();
    std::vector<glm::vec3> places;
    std::vector<char> isUsed;
    for (std::size_t slot = 0; slot < bricks.size(); ++slot) {
        if (slot % kBricksTogether == 0 && job.isStopRequested())
            return false;
        const extract::PictureBrick& brick = bricks[slot];
        isUsed.assign(brick.vertexCount, 0);
        const std::uint16_t* const indices = frame.bricks->indices(brick);
        for (std::uint32_t k = 0; k < brick.indexCount; ++k)
            isUsed[indices[k]] = 1;
        if (brick.indexCount == 0)
            continue;
        extract::placesOf(*frame.bricks, brick, frame.isovalue, places);
        for (std::size_t vertex = 0; vertex < isUsed.size(); ++vertex)
            if (isUsed[vertex])
                visit(glm::dvec3(places[vertex]));
    }
    return true;
}

} // namespace isoslider::model
