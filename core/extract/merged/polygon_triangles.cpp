#include "core/extract/merged/polygon_triangles.h"

#include <limits>
#include <utility>

#include <glm/geometric.hpp>

#include "core/cell/cell_numbering.h"
#include "core/cell/cell_states.h"

namespace isoslider::extract {

const std::array<CellPolygon, 256>& cellPolygons() {
    static const auto polygons = [] {
        std::array<CellPolygon, 256> made{};
        for (std::size_t signs = 0; signs < made.size(); ++signs) {
            const auto corners = cell::cellStates()[signs].triangles;
            CellPolygon& polygon = made[signs];
            if (cell::isAmbiguous(static_cast<std::uint8_t>(signs)))
                continue;
            std::array<std::uint32_t, 12> numbers{};
            for (std::uint8_t e = 0; e < 12; ++e)
                if (cell::activeEdges(static_cast<std::uint8_t>(signs)) >> e & 1) {
                    numbers[e] = polygon.edgeCount;
                    polygon.edges[polygon.edgeCount++] = e;
                }
            for (std::size_t k = 0; k < corners.size(); k += 3)
                polygon.triangles[polygon.triangleCount++] = {numbers[corners[k]], numbers[corners[k + 1]],
                                                              numbers[corners[k + 2]]};
        }
        return made;
    }();
    return polygons;
}

void PolygonTriangulation::make(std::span<const PolygonCorner> corners,
                                std::vector<std::array<std::uint32_t, 3>>& triangles) {
    constexpr float kNone = std::numeric_limits<float>::infinity();
    const std::size_t k = corners.size();
    triangles.clear();
    const auto isAllowed = [&](std::size_t i, std::size_t j) {
        return j == i + 1 || (i == 0 && j == k - 1) || (corners[i].faces & corners[j].faces) == 0;
    };
    const auto area = [&](std::size_t i, std::size_t m, std::size_t j) {
        return glm::length(
            glm::cross(corners[m].position - corners[i].position, corners[j].position - corners[i].position));
    };
    least_.assign(k * k, kNone);
    apex_.resize(k * k);
    for (std::size_t i = 0; i + 1 < k; ++i)
        least_[i * k + i + 1] = 0.0f;
    for (std::size_t span = 2; span < k; ++span)
        for (std::size_t i = 0; i + span < k; ++i) {
            const std::size_t j = i + span;
            if (!isAllowed(i, j))
                continue;
            for (std::size_t m = i + 1; m < j; ++m) {
                const float parts = least_[i * k + m] + least_[m * k + j];
                if (parts >= least_[i * k + j])
                    continue; // not there, or too much already
                if (const float all = parts + area(i, m, j); all < least_[i * k + j]) {
                    least_[i * k + j] = all;
                    apex_[i * k + j] = static_cast<std::uint32_t>(m);
                }
            }
        }
    if (least_[k - 1] == kNone)
        return;
    open_.assign(1, {0, static_cast<std::uint32_t>(k - 1)});
    while (!open_.empty()) {
        const auto [i, j] = open_.back();
        open_.pop_back();
        if (j - i < 2)
            continue;
        const std::uint32_t m = apex_[i * k + j];
        triangles.push_back({i, m, j});
        open_.emplace_back(i, m);
        open_.emplace_back(m, j);
    }
}

} // namespace isoslider::extract
