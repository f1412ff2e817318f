#include "ui/model/surface/coarse_picture.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "core/extract/full_extraction.h"

namespace isoslider::model {
namespace {

constexpr double kRadius = 14.0; // cells
constexpr glm::vec3 kMiddle(19.5f);

/// A sphere within 40^3 grid points.
extract::SurfaceFrame sphereFrame() {
    GridGeometry geometry;
    geometry.dims = {40, 40, 40};
    std::vector<float> values;
    for (int z = 0; z < 40; ++z)
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 40; ++x)
                values.push_back(-glm::length(glm::vec3(x, y, z) - kMiddle));
    auto mesh =
        extract::extractFull(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values), -kRadius).value();
    extract::SurfaceFrame frame;
    frame.geometry = geometry;
    frame.positions = std::move(mesh.positions);
    frame.normals = std::move(mesh.normals);
    frame.indices = std::move(mesh.triangles);
    frame.stats.triangles = frame.indices.size() / 3;
    return frame;
}

double areaOf(const extract::SurfaceFrame& frame) {
    double area = 0.0;
    const auto corner = [&](std::size_t i) { return glm::dvec3(frame.positions[frame.indices[i]]); };
    for (std::size_t i = 0; i + 2 < frame.indices.size(); i += 3)
        area += 0.5 * glm::length(glm::cross(corner(i + 1) - corner(i), corner(i + 2) - corner(i)));
    return area;
}

TEST(CoarsePicture, StaysOnTheSurfaceAndCoversIt) {
    for (const int block : {2, 4}) {
        auto frame = sphereFrame();
        const auto triangles = frame.indices.size() / 3;
        mergeVertices(frame, block);
        EXPECT_EQ(frame.mergedCells, block);
        EXPECT_LT(frame.indices.size() / 3, triangles / (block * block / 2));
        EXPECT_EQ(frame.positions.size(), frame.normals.size());
        EXPECT_EQ(frame.stats.triangles, triangles) << "of the whole surface";
        EXPECT_NEAR(areaOf(frame) / (4.0 * std::numbers::pi * kRadius * kRadius), 1.0, 0.02 * block);
        for (std::size_t i = 0; i < frame.positions.size(); ++i) {
            EXPECT_NEAR(glm::length(frame.positions[i] - kMiddle), kRadius, 0.1 * block);
            EXPECT_NEAR(glm::length(frame.normals[i]), 1.0, 1e-5);
            EXPECT_GT(glm::dot(frame.normals[i], frame.positions[i] - kMiddle), 0.9 * kRadius) << "outwards";
        }
    }
}

TEST(CoarsePicture, IsAsCoarseAsItMustBe) {
    auto frame = sphereFrame();
    const auto whole = extract::pictureBytes(frame);
    fitPicture(frame, whole);
    EXPECT_EQ(frame.mergedCells, 1);
    EXPECT_EQ(extract::pictureBytes(frame), whole);
    fitPicture(frame, whole - 1);
    EXPECT_EQ(frame.mergedCells, 2);
    fitPicture(frame, whole / 10);
    EXPECT_EQ(frame.mergedCells, 4);
    EXPECT_LE(extract::pictureBytes(frame), whole / 10);
    fitPicture(frame, 0);
    EXPECT_LT(extract::pictureBytes(frame), 1000u);
}

TEST(CoarsePicture, LeavesOutVerticesOfNoTriangle) {
    auto frame = sphereFrame();
    auto other = frame;
    other.positions.emplace_back(std::nanf("")); // room that is not filled
    other.normals.emplace_back(0.0f);
    other.indices.insert(other.indices.begin(), {0, 0, 0});
    mergeVertices(frame, 2);
    mergeVertices(other, 2);
    EXPECT_EQ(other.positions, frame.positions);
    EXPECT_EQ(other.indices, frame.indices);
}

TEST(CoarsePicture, KeepsWhatChanged) {
    auto frame = sphereFrame();
    frame.changedIndices.assign(frame.indices.begin(), frame.indices.begin() + 3 * 200);
    mergeVertices(frame, 2);
    EXPECT_GT(frame.changedIndices.size(), 3u * 20);
    EXPECT_EQ(
        std::vector<std::uint32_t>(frame.indices.begin(),
                                   frame.indices.begin() + static_cast<std::ptrdiff_t>(frame.changedIndices.size())),
        frame.changedIndices);
}

} // namespace
} // namespace isoslider::model
