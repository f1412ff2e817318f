#include "core/extract/merged/polygon_triangles.h"

#include <limits>
#include <utility>

#include <hwy/highway.h>

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
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::CappedTag<float, 4> d;
    const std::size_t lanes = hn::Lanes(d);
    constexpr float kNone = std::numeric_limits<float>::infinity();
    const std::size_t k = corners.size(), row = (k / 4 + 2) * 4;
    triangles.clear();
    for (auto* const places : {&x_, &y_, &z_})
        places->resize(row);
    for (std::size_t i = 0; i < k; ++i) {
        x_[i] = corners[i].position.x;
        y_[i] = corners[i].position.y;
        z_[i] = corners[i].position.z;
    }
    const auto isAllowed = [&](std::size_t i, std::size_t j) {
        return j == i + 1 || (i == 0 && j == k - 1) || (corners[i].faces & corners[j].faces) == 0;
    };
    least_.assign(k * row, kNone);
    leastTo_.assign(k * row, kNone);
    apex_.resize(k * row);
    for (std::size_t i = 0; i + 1 < k; ++i)
        least_[i * row + i + 1] = leastTo_[(i + 1) * row + i] = 0.0f;
    for (std::size_t span = 2; span < k; ++span)
        for (std::size_t i = 0; i + span < k; ++i) {
            const std::size_t j = i + span;
            if (!isAllowed(i, j))
                continue;
            const auto xi = hn::Set(d, x_[i]), yi = hn::Set(d, y_[i]), zi = hn::Set(d, z_[i]);
            const auto bx = hn::Sub(hn::Set(d, x_[j]), xi), by = hn::Sub(hn::Set(d, y_[j]), yi),
                       bz = hn::Sub(hn::Set(d, z_[j]), zi);
            float least = kNone;
            // Beyond j there are no polygons yet, and the sum is infinite.
            for (std::size_t m = i + 1; m < j; m += lanes) {
                const auto parts = hn::Add(hn::LoadU(d, &least_[i * row + m]), hn::LoadU(d, &leastTo_[j * row + m]));
                if (hn::AllFalse(d, hn::Lt(parts, hn::Set(d, least))))
                    continue; // not there, or too much already
                const auto ax = hn::Sub(hn::LoadU(d, &x_[m]), xi), ay = hn::Sub(hn::LoadU(d, &y_[m]), yi),
                           az = hn::Sub(hn::LoadU(d, &z_[m]), zi);
                const auto cx = hn::Sub(hn::Mul(ay, bz), hn::Mul(by, az)),
                           cy = hn::Sub(hn::Mul(az, bx), hn::Mul(bz, ax)),
                           cz = hn::Sub(hn::Mul(ax, by), hn::Mul(bx, ay));
                const auto area = hn::Sqrt(hn::Add(hn::Add(hn::Mul(cx, cx), hn::Mul(cy, cy)), hn::Mul(cz, cz)));
                const auto sum = hn::Add(parts, area);
                if (hn::AllFalse(d, hn::Lt(sum, hn::Set(d, least))))
                    continue;
                alignas(16) std::array<float, 4> all;
                hn::Store(sum, d, all.data());
                for (std::size_t lane = 0; lane < lanes; ++lane)
                    if (all[lane] < least) { // the first of several
                        least = all[lane];
                        apex_[i * row + j] = static_cast<std::uint32_t>(m + lane);
                    }
            }
            least_[i * row + j] = leastTo_[j * row + i] = least;
        }
    if (least_[k - 1] == kNone)
        return;
    open_.assign(1, {0, static_cast<std::uint32_t>(k - 1)});
    while (!open_.empty()) {
        const auto [i, j] = open_.back();
        open_.pop_back();
        if (j - i < 2)
            continue;
        const std::uint32_t m = apex_[i * row + j];
        triangles.push_back({i, m, j});
        open_.emplace_back(i, m);
        open_.emplace_back(m, j);
    }
}

} // namespace isoslider::extract
