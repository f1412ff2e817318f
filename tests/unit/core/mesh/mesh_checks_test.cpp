#include "core/mesh/mesh_checks.h"

#include <sys/stat.h>

#include <chrono>
#include <cstring>

#include <gtest/gtest.h>

#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/mesh/test_meshes.h"

namespace isoslider::mesh {
namespace {

using test::TemporaryFolder;

TEST(MeshChecks, AcceptsATetrahedron) {
    const MeshReport report = checkMesh(test::tetrahedron());
    EXPECT_TRUE(report.isManifold && report.isClosed && report.isOriented);
    EXPECT_EQ(report.vertices, 4u);
    EXPECT_EQ(report.edges, 6u);
    EXPECT_EQ(report.triangles, 4u);
    EXPECT_EQ(report.components, 1u);
    EXPECT_EQ(report.euler, 2);
    EXPECT_EQ(report.genus, 0);
    EXPECT_EQ(report.boundaryLoops, 0u);
    EXPECT_EQ(report.degenerateTriangles + report.duplicateTriangles + report.refusedByOpenMesh, 0u);
    EXPECT_NEAR(report.enclosedVolume, 1.0 / 6.0, 1e-12);
    EXPECT_NEAR(report.area, 1.5 + std::sqrt(3.0) / 2, 1e-6);
}

TEST(MeshChecks, FindsTheHoleOfATorus) {
    const MeshReport report = checkMesh(test::torus(64, 24));
    EXPECT_TRUE(report.isManifold && report.isClosed && report.isOriented);
    EXPECT_EQ(report.euler, 0);
    EXPECT_EQ(report.genus, 1);
    EXPECT_NEAR(report.enclosedVolume, 2 * std::numbers::pi * std::numbers::pi * 10 * 9, 30);
}

TEST(MeshChecks, CountsComponentsAndIgnoresUnusedVertices) {
    auto mesh = test::twoTetrahedra();
    mesh.positions.emplace_back(9, 9, 9);
    const MeshReport report = checkMesh(mesh);
    EXPECT_EQ(report.components, 2u);
    EXPECT_EQ(report.vertices, 8u);
    EXPECT_EQ(report.euler, 4);
    EXPECT_EQ(report.genus, 0);
    EXPECT_NEAR(report.enclosedVolume, 1.0 / 3.0, 1e-6);
}

TEST(MeshChecks, SeesTheBorderOfADisk) {
    const MeshReport report = checkMesh(test::openDisk());
    EXPECT_TRUE(report.isManifold && report.isOriented);
    EXPECT_FALSE(report.isClosed);
    EXPECT_EQ(report.boundaryLoops, 1u);
    EXPECT_EQ(report.euler, 1);
    EXPECT_EQ(report.genus, 0);
}

TEST(MeshChecks, SeesTwoFansAtABowTie) {
    const MeshReport report = checkMesh(test::bowTie());
    EXPECT_FALSE(report.isManifold);
    EXPECT_EQ(report.nonManifoldVertices, 1u);
    EXPECT_EQ(report.components, 1u);
    EXPECT_EQ(report.boundaryLoops, 2u);
}

TEST(MeshChecks, SeesAnEdgeWithThreeTriangles) {
    const MeshReport report = checkMesh(test::bookOfThree());
    EXPECT_FALSE(report.isManifold);
    EXPECT_EQ(report.nonManifoldEdges, 1u);
    EXPECT_FALSE(report.isOriented);
    EXPECT_GT(report.refusedByOpenMesh, 0u);
    EXPECT_EQ(report.edges, 7u);
}

TEST(MeshChecks, SeesAFlippedTriangle) {
    auto mesh = test::tetrahedron();
    std::swap(mesh.triangles[1], mesh.triangles[2]);
    const MeshReport report = checkMesh(mesh);
    EXPECT_TRUE(report.isManifold);
    EXPECT_TRUE(report.isClosed);
    EXPECT_FALSE(report.isOriented);
    EXPECT_GT(report.refusedByOpenMesh, 0u);
}

TEST(MeshChecks, CountsDuplicates) {
    auto mesh = test::openDisk();
    mesh.triangles.insert(mesh.triangles.end(), {1, 2, 0, 0, 2, 1});
    const MeshReport report = checkMesh(mesh);
    EXPECT_EQ(report.duplicateTriangles, 2u);
    EXPECT_FALSE(report.isManifold);
}

TEST(MeshChecks, CountsDegenerates) {
    auto mesh = test::tetrahedron();
    mesh.positions.emplace_back(2, 0, 0);
    mesh.triangles.insert(mesh.triangles.end(), {0, 1, 4, 2, 2, 3});
    const MeshReport report = checkMesh(mesh);
    EXPECT_EQ(report.degenerateTriangles, 2u);
    EXPECT_EQ(report.triangles, 6u);
    EXPECT_FALSE(report.isManifold);
}

TEST(MeshChecks, AcceptsNothing) {
    const MeshReport report = checkMesh(extract::SurfaceMesh{});
    EXPECT_TRUE(report.isManifold && report.isClosed && report.isOriented);
    EXPECT_EQ(report.triangles, 0u);
    EXPECT_EQ(report.euler, 0);
}

TEST(MeshChecks, TakesWorldUnitsFromTheGeometry) {
    auto mesh = test::tetrahedron();
    mesh.geometry.spacing = {2, 3, 4};
    mesh.geometry.origin = {1e6, -1e6, 5};
    EXPECT_NEAR(checkMesh(mesh).enclosedVolume, 4.0, 1e-6);
}

TEST(MeshChecks, KeepsLeftHandedSurfacesOutward) {
    auto mesh = test::tetrahedron();
    mesh.geometry.direction[1] = {0, -1, 0};
    EXPECT_NEAR(checkMesh(mesh).enclosedVolume, 1.0 / 6.0, 1e-12);
}

TEST(MeshChecks, ManagesTwoMillionTrianglesInSeconds) {
    const auto begin = std::chrono::steady_clock::now();
    const MeshReport report = checkMesh(test::torus(2000 / test::kSparser, 500));
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    EXPECT_EQ(report.triangles, 2'000'000u / test::kSparser);
    EXPECT_EQ(report.genus, 1);
    RecordProperty("seconds", std::to_string(elapsed.count()));
    EXPECT_LT(elapsed.count(), 30.0); // a few seconds alone; machines are shared
}

struct BadFile {
    const char* name;
    std::string bytes;
    ErrorCode code;
    const char* says;
};

std::string binaryStl(std::uint32_t count, std::size_t bytes) {
    std::string text(bytes, '\0');
    std::memcpy(text.data() + 80, &count, 4);
    return text;
}

TEST(CheckMeshFile, RefusesWhatIsNoMesh) {
    const BadFile files[] = {
        {"a.txt", "hello", ErrorCode::InvalidArgument, "expected .ply"},
        {"empty.ply", "", ErrorCode::InvalidArgument, "not a readable ply"},
        {"text.ply", "hello\nworld\n", ErrorCode::InvalidArgument, "not a readable ply"},
        {"short.stl", "x", ErrorCode::InvalidArgument, "STL"},
        {"count.stl", binaryStl(1000, 184), ErrorCode::Corruption, "50084"},
        {"text.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n", ErrorCode::InvalidArgument, "zero"},
        {"end.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", ErrorCode::Corruption, "early"},
        {"cut.ply", "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n1\n", ErrorCode::Corruption,
         "vertex 1"},
        {"huge.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n1\n",
         ErrorCode::Corruption, "4000000000"},
        {"list.ply",
         "ply\nformat ascii 1.0\nelement face 1\nproperty list uint int vertex_indices\nend_header\n4000000000 1 2\n",
         ErrorCode::Corruption, "face 0"},
        {"index.obj", "v 0 0 0\nf 1 2 x\n", ErrorCode::InvalidArgument, "line 2"},
        {"before.obj", "v 0 0 0\nf -1 -2 -3\n", ErrorCode::InvalidArgument, "vertex -1"},
        {"text.obj", "hello world\n", ErrorCode::InvalidArgument, "obj"},
        {"cut.off", "OFF\n3 1 0\n0 0 0\n", ErrorCode::Corruption, "vertex 1"},
        {"range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", ErrorCode::InvalidArgument, "vertex 7"},
        {"huge.off", "OFF\n2000000000 1 0\n0 0 0\n", ErrorCode::InvalidArgument, "header"},
        {"nan.stl", "solid a\nvertex nan 0 0\nvertex 0 0 0\nvertex 1 0 0\nendsolid\n", ErrorCode::InvalidArgument,
         "not finite"},
        {"bad.om", "not om at all", ErrorCode::InvalidArgument, "om mesh"},
    };
    for (const BadFile& file : files) {
        const TemporaryFolder folder;
        const auto report = checkMeshFile(folder.write(file.name, file.bytes));
        ASSERT_FALSE(report.isOk()) << file.name;
        EXPECT_EQ(report.error().code, file.code) << report.error().line();
        EXPECT_NE(report.error().line().find(file.says), std::string::npos) << report.error().line();
    }
}

TEST(CheckMeshFile, RefusesWhatIsNoFile) {
    const TemporaryFolder folder;
    EXPECT_EQ(checkMeshFile(folder / "none.ply").error().code, ErrorCode::NotFound);
    ASSERT_EQ(::mkfifo((folder / "pipe.ply").c_str(), 0600), 0);
    EXPECT_EQ(checkMeshFile(folder / "pipe.ply").error().code, ErrorCode::InvalidArgument);
    std::filesystem::create_directory(folder / "folder.obj");
    EXPECT_EQ(checkMeshFile(folder / "folder.obj").error().code, ErrorCode::InvalidArgument);
}

TEST(CheckMeshFile, CutsPolygonsAndKeepsNonManifoldFaces) {
    const TemporaryFolder folder;
    const auto quad = checkMeshFile(folder.write("q.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"));
    ASSERT_TRUE(quad.isOk()) << quad.error().line();
    EXPECT_EQ(quad.value().triangles, 2u);
    EXPECT_DOUBLE_EQ(quad.value().area, 1.0);
    const auto book = checkMeshFile(
        folder.write("b.obj", "v 0 0 0\nv 0 0 1\nv 1 0 0\nv -1 1 0\nv -1 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n"));
    ASSERT_TRUE(book.isOk()) << book.error().line();
    EXPECT_EQ(book.value().triangles, 3u);
    EXPECT_EQ(book.value().nonManifoldEdges, 1u);
}

TEST(CheckMeshFile, ReadsEveryKindOfPly) {
    const TemporaryFolder folder;
    const std::string header = " 1.0\ncomment of somebody\nelement vertex 3\nproperty double x\nproperty float y\n"
                               "property float z\nproperty uchar red\nelement other 1\nproperty list uchar short l\n"
                               "element face 1\nproperty list uchar uint vertex_index\nend_header\n";
    std::string bigEndian;
    const auto add = [&](auto value) {
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        bigEndian.append(std::make_reverse_iterator(bytes + sizeof value), std::make_reverse_iterator(bytes));
    };
    for (int i = 0; i < 3; ++i) {
        add(i == 1 ? 2.0 : 0.0);
        add(i == 2 ? 3.0f : 0.0f);
        add(0.0f);
        add(std::uint8_t{7});
    }
    for (const int number : {1, 258})
        number == 1 ? add(std::uint8_t{1}) : add(std::int16_t{258});
    add(std::uint8_t{3});
    for (const std::uint32_t corner : {0u, 1u, 2u})
        add(corner);
    const std::string files[] = {
        "ply\nformat ascii" + header + "0 0 0 7\n2 0 0 7\n0 3 0 7\n1 258\n3 0 1 2\n",
        "ply\r\nformat binary_big_endian" + header + bigEndian,
    };
    for (const std::string& bytes : files) {
        const auto report = checkMeshFile(folder.write("a.ply", bytes));
        ASSERT_TRUE(report.isOk()) << report.error().line();
        EXPECT_DOUBLE_EQ(report.value().area, 3.0);
        // Of a text, blank lines are nothing; other bytes behind the last face are a fault.
        const bool isText = bytes.find("ascii") != std::string::npos;
        EXPECT_EQ(checkMeshFile(folder.write("a.ply", bytes + "\n \n")).isOk(), isText);
        const auto longer = checkMeshFile(folder.write("a.ply", bytes + "3 0 1 2\n"));
        ASSERT_FALSE(longer.isOk());
        EXPECT_EQ(longer.error().code, ErrorCode::Corruption);
        EXPECT_EQ(longer.error().message, "has bytes behind the last element that its header names");
    }
}

} // namespace
} // namespace isoslider::mesh
