#include "core/mesh/mesh_export.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "core/mesh/mesh_checks.h"
#include "core/mesh/mesh_import.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/mesh/test_meshes.h"

namespace isoslider::mesh {
namespace {

using test::TemporaryFolder;

Status exportCertified(const extract::SurfaceMesh& mesh, const std::filesystem::path& path) {
    return exportMesh(mesh, certify(mesh, {"test", {}}), path);
}

TEST(MeshExport, WritesUnitNormalsOfObliqueAxes) {
    auto mesh = test::torus(160, 64);
    mesh.geometry.spacing = {0.5, 0.25, 1.5};
    mesh.geometry.direction = glm::dmat3(1.0, 0.0, 0.0, 0.5, std::sqrt(0.75), 0.0, 0.1, 0.2, std::sqrt(0.95));
    // Normals of a torus that is stretched by the spacing, as samples would give them.
    for (glm::vec3& normal : mesh.normals)
        normal = glm::normalize(normal / glm::vec3(mesh.geometry.spacing));
    const TriangleSoup soup = worldSoup(mesh);
    for (const auto& [a, b, c] : soup.triangles) {
        const glm::dvec3 of =
            glm::normalize(glm::cross(soup.positions[b] - soup.positions[a], soup.positions[c] - soup.positions[a]));
        for (const std::uint32_t corner : {a, b, c}) {
            EXPECT_NEAR(glm::length(soup.normals[corner]), 1.0f, 1e-5f);
            EXPECT_GT(glm::dot(of, glm::dvec3(soup.normals[corner])), 0.9);
        }
    }
}

TEST(MeshExport, RefusesToWriteAnStlWhoseCornersFallTogether) {
    const TemporaryFolder folder;
    auto mesh = test::torus(40, 16);
    mesh.geometry.spacing = glm::dvec3(0.25);
    mesh.geometry.origin = glm::dvec3(100.0);
    EXPECT_TRUE(exportCertified(mesh, folder / "near.stl").isOk());
    mesh.geometry.origin = glm::dvec3(2e4); // coarse, but apart
    EXPECT_TRUE(exportCertified(mesh, folder / "farther.stl").isOk());
    mesh.geometry.origin = glm::dvec3(5e6);
    const Status status = exportCertified(mesh, folder / "far.stl");
    ASSERT_FALSE(status.isOk());
    EXPECT_EQ(status.error().code, ErrorCode::InvalidArgument);
    EXPECT_FALSE(std::filesystem::exists(folder / "far.stl"));
    EXPECT_TRUE(exportCertified(mesh, folder / "far.ply").isOk());
}

class EveryFormat : public testing::TestWithParam<const char*> {};

TEST_P(EveryFormat, ComesBackTheSame) {
    const TemporaryFolder folder;
    const auto path = folder / (std::string("torus") + GetParam());
    auto mesh = test::torus(40, 16);
    mesh.geometry.spacing = {0.5, 0.25, 1.5};
    mesh.geometry.origin = {-7.125, 3.3, 100.0};
    mesh.positions.emplace_back(1, 2, 3); // not used by any triangle
    mesh.normals.emplace_back(0, 0, 1);
    const Status status = exportCertified(mesh, path);
    ASSERT_TRUE(status.isOk()) << status.error().line();
    EXPECT_FALSE(std::filesystem::exists(path.string() + ".partial"));
    const auto report = checkMeshFile(path);
    ASSERT_TRUE(report.isOk()) << report.error().line();
    const MeshReport before = checkMesh(mesh);
    EXPECT_TRUE(report.value().isManifold && report.value().isClosed && report.value().isOriented);
    EXPECT_EQ(report.value().vertices, before.vertices);
    EXPECT_EQ(report.value().edges, before.edges);
    EXPECT_EQ(report.value().triangles, before.triangles);
    EXPECT_EQ(report.value().genus, 1);
    EXPECT_NEAR(report.value().enclosedVolume, before.enclosedVolume, 1e-4 * before.enclosedVolume);
    EXPECT_NEAR(report.value().area, before.area, 1e-4 * before.area);
}

TEST_P(EveryFormat, KeepsLeftHandedSurfacesOutward) {
    const TemporaryFolder folder;
    const auto path = folder / (std::string("mesh") + GetParam());
    auto mesh = test::tetrahedron();
    mesh.geometry.direction[2] = {0, 0, -1};
    ASSERT_TRUE(exportCertified(mesh, path).isOk());
    const auto report = checkMeshFile(path);
    ASSERT_TRUE(report.isOk()) << report.error().line();
    EXPECT_NEAR(report.value().enclosedVolume, 1.0 / 6.0, 1e-6);
}

TEST_P(EveryFormat, KeepsNonManifoldTriangles) {
    const TemporaryFolder folder;
    const auto path = folder / (std::string("book") + GetParam());
    ASSERT_TRUE(exportCertified(test::bookOfThree(), path).isOk());
    const auto report = checkMeshFile(path);
    ASSERT_TRUE(report.isOk()) << report.error().line();
    EXPECT_EQ(report.value().triangles, 3u);
}

TEST_P(EveryFormat, WritesAnEmptyMesh) {
    const TemporaryFolder folder;
    const auto path = folder / (std::string("empty") + GetParam());
    const Status status = exportCertified(extract::SurfaceMesh{}, path);
    ASSERT_TRUE(status.isOk()) << status.error().line();
    const auto report = checkMeshFile(path);
    ASSERT_TRUE(report.isOk()) << report.error().line();
    EXPECT_EQ(report.value().triangles, 0u);
}

TEST_P(EveryFormat, SaysWhyItCannotWrite) {
    const TemporaryFolder folder;
    const Status noFolder = exportCertified(test::tetrahedron(), folder / (std::string("none/mesh") + GetParam()));
    ASSERT_FALSE(noFolder.isOk());
    EXPECT_EQ(noFolder.error().code, ErrorCode::NotFound);
    const auto path = folder / (std::string("taken") + GetParam());
    std::filesystem::create_directory(path);
    EXPECT_EQ(exportCertified(test::tetrahedron(), path).error().code, ErrorCode::InvalidArgument);
}

TEST_P(EveryFormat, LeavesNothingWhenTheDiskFails) {
    const TemporaryFolder folder;
    const auto path = folder.write(std::string("mesh") + GetParam(), "old");
    const auto mesh = test::torus(400, 100);
    // A file size limit stands for a full disk.
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{100'000, before.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const Status status = exportCertified(mesh, path);
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, handler);
    ASSERT_FALSE(status.isOk());
    EXPECT_EQ(status.error().code, ErrorCode::IoError) << status.error().line();
    EXPECT_EQ(test::readText(path), "old");
    EXPECT_FALSE(std::filesystem::exists(path.string() + ".partial"));
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat, testing::Values(".ply", ".obj", ".stl", ".off", ".om"),
                         [](const auto& parameter) { return std::string(parameter.param).substr(1); });

TEST(MeshExport, RefusesUnknownSuffix) {
    const TemporaryFolder folder;
    EXPECT_EQ(exportCertified(test::tetrahedron(), folder / "a.xyz").error().code, ErrorCode::InvalidArgument);
    EXPECT_TRUE(isExportSuffix("A.PLY"));
    EXPECT_FALSE(isExportSuffix("ply"));
}

TEST(MeshExport, B103_RefusesWhatFormatsCannotNumber) {
    constexpr std::uint64_t kMostVertices = (std::uint64_t{1} << 31) - 1, kMostTriangles = (std::uint64_t{1} << 32) - 1;
    EXPECT_TRUE(checkExportSize(kMostVertices, kMostTriangles, "a.ply").isOk());
    for (const auto& [vertices, triangles] :
         {std::pair(kMostVertices + 1, std::uint64_t{1}), std::pair(std::uint64_t{3}, kMostTriangles + 1),
          std::pair(~std::uint64_t{0}, ~std::uint64_t{0})}) {
        const auto refused = checkExportSize(vertices, triangles, "a.ply");
        ASSERT_FALSE(refused.isOk());
        EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
        EXPECT_NE(refused.error().line().find("a.ply"), std::string::npos);
    }
}

TEST(MeshExport, KeepsVerticesApartFarFromTheOrigin) {
    const TemporaryFolder folder;
    auto mesh = test::tetrahedron();
    mesh.geometry.spacing = {1e-3, 1e-3, 1e-3};
    mesh.geometry.origin = {1e6, 1e6, 1e6};
    for (const char* suffix : {".ply", ".obj", ".off", ".om"})
        ASSERT_TRUE(exportCertified(mesh, folder / (std::string("far") + suffix)).isOk());
    EXPECT_NE(test::readText(folder / "far.obj").find("v 1000000.001 1e+06 1e+06\n"), std::string::npos);
    EXPECT_NE(test::readText(folder / "far.off").find("\n1000000.001 1e+06 1e+06 "), std::string::npos);
    EXPECT_NE(test::readText(folder / "far.ply").find("property double x"), std::string::npos);
    for (const char* suffix : {".ply", ".obj", ".off", ".om"}) {
        const auto report = checkMeshFile(folder / (std::string("far") + suffix));
        ASSERT_TRUE(report.isOk()) << report.error().line();
        EXPECT_NEAR(report.value().enclosedVolume, 1e-9 / 6.0, 1e-14) << suffix;
    }
}

TEST(MeshExport, KeepsVerticesApartInUnitsThatFloatsCannotHold) {
    for (const double spacing : {1e60, 1e39, 1e-46, 1e-60}) {
        const TemporaryFolder folder;
        auto mesh = test::tetrahedron();
        mesh.geometry.spacing = glm::dvec3(spacing);
        for (const char* suffix : {".ply", ".obj", ".off", ".om"}) {
            const auto path = folder / (std::string("mesh") + suffix);
            ASSERT_TRUE(exportCertified(mesh, path).isOk());
            const auto report = checkMeshFile(path);
            ASSERT_TRUE(report.isOk()) << report.error().line();
            const auto soup = readMeshFile(path);
            ASSERT_TRUE(soup.isOk());
            double farthest = 0.0;
            for (const auto& p : soup.value().positions)
                farthest = std::max({farthest, p.x, p.y, p.z});
            EXPECT_NEAR(farthest / spacing, 1.0, 1e-6) << suffix << " " << spacing;
        }
        const Status status = exportCertified(mesh, folder / "mesh.stl");
        ASSERT_FALSE(status.isOk()) << spacing;
        EXPECT_NE(status.error().line().find("STL"), std::string::npos);
        EXPECT_FALSE(std::filesystem::exists(folder / "mesh.stl"));
    }
}

TEST(MeshExport, KeepsVerticesHeldOffATieApartFarFromTheOrigin) {
    const TemporaryFolder folder;
    auto mesh = test::octahedronAtATie();
    // A float's step is 2^-11 there, more than the nudge, and the tie lies where both would round alike.
    mesh.geometry.spacing = glm::dvec3(0.7);
    mesh.geometry.origin = glm::dvec3(5002.0 - 0.35 / 2048 - 3 * 0.7);
    for (const char* suffix : {".ply", ".obj", ".off", ".om"}) {
        ASSERT_TRUE(exportCertified(mesh, folder / (std::string("tie") + suffix)).isOk());
        const auto report = checkMeshFile(folder / (std::string("tie") + suffix));
        ASSERT_TRUE(report.isOk()) << report.error().line();
        EXPECT_EQ(report.value().degenerateTriangles, 0u) << suffix;
        EXPECT_GT(report.value().enclosedVolume, 0.0) << suffix;
    }
}

TEST(MeshExport, WritesPositionsToTheLastBit) {
    for (const char* suffix : {".ply", ".obj", ".off", ".om", ".stl"}) {
        const TemporaryFolder folder;
        auto mesh = test::tetrahedron();
        mesh.positions[1].x = 1.00000012f;
        const auto path = folder / (std::string("mesh") + suffix);
        ASSERT_TRUE(exportCertified(mesh, path).isOk());
        const auto soup = readMeshFile(path);
        ASSERT_TRUE(soup.isOk());
        double largest = 0;
        for (const auto& p : soup.value().positions)
            largest = std::max(largest, p.x);
        EXPECT_EQ(static_cast<float>(largest), 1.00000012f) << suffix;
    }
}

} // namespace
} // namespace isoslider::mesh
