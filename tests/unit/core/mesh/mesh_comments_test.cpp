#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "core/mesh/mesh_export.h"
#include "core/mesh/mesh_import.h"
#include "core/mesh/open_mesh_adapter.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/mesh/test_meshes.h"

namespace isoslider::mesh {
namespace {

using test::TemporaryFolder;

/// The facts in a file's comments. Nothing else in the files begins with these marks.
std::map<std::string, std::string> factsIn(const std::filesystem::path& path) {
    std::map<std::string, std::string> facts;
    std::istringstream lines(test::readText(path));
    for (std::string line; std::getline(lines, line);) {
        for (const std::string mark : {"comment ", "# "})
            if (line.rfind(mark, 0) == 0) {
                const auto colon = line.find(": ");
                if (colon != std::string::npos)
                    facts[line.substr(mark.size(), colon - mark.size())] = line.substr(colon + 2);
            }
    }
    return facts;
}

extract::SurfaceMesh placedTorus() {
    auto mesh = test::torus(40, 16);
    mesh.isovalue = 0.1;
    mesh.geometry.spacing = {0.5, 0.25, 1.5};
    mesh.geometry.origin = {-7.125, 3.25, 100.0};
    return mesh;
}

class EveryCommentedFormat : public testing::TestWithParam<const char*> {};

TEST_P(EveryCommentedFormat, SaysTheFactsOfTheMeshThatFollows) {
    const TemporaryFolder folder;
    const auto path = folder / (std::string("torus") + GetParam());
    const auto mesh = placedTorus();
    const auto certificate = certify(mesh, {"torus.mha", 0});
    ASSERT_TRUE(exportMesh(mesh, certificate, path).isOk());
    const auto facts = factsIn(path);
    const auto report = checkMeshFile(path);
    ASSERT_TRUE(report.isOk()) << report.error().line();
    EXPECT_EQ(facts.at("source"), "torus.mha");
    EXPECT_EQ(std::stod(facts.at("isovalue")), 0.1);
    EXPECT_EQ(std::stoull(facts.at("vertices")), report.value().vertices);
    EXPECT_EQ(std::stoull(facts.at("triangles")), report.value().triangles);
    EXPECT_EQ(std::stoull(facts.at("components")), report.value().components);
    EXPECT_EQ(std::stoll(facts.at("Euler number")), report.value().euler);
    EXPECT_EQ(std::stoull(facts.at("boundary loops")), report.value().boundaryLoops);
    EXPECT_EQ(std::stoll(facts.at("genus")), 1);
    EXPECT_EQ(std::stod(facts.at("area")), certificate.report.area);
    EXPECT_EQ(std::stod(facts.at("enclosed volume")), certificate.report.enclosedVolume);
    EXPECT_NEAR(std::stod(facts.at("area")), report.value().area, 1e-4 * report.value().area);
    EXPECT_EQ(facts.at("closed"), "yes");
    EXPECT_EQ(facts.at("valid"), "yes");
    EXPECT_EQ(facts.size(), linesOf(certificate).size());
}

TEST_P(EveryCommentedFormat, SaysThatAMeshIsNotSound) {
    const TemporaryFolder folder;
    const auto path = folder / (std::string("book") + GetParam());
    ASSERT_TRUE(exportMesh(test::bookOfThree(), certify(test::bookOfThree(), {"book", {}}), path).isOk());
    EXPECT_EQ(factsIn(path).at("valid").rfind("no: not manifold", 0), 0u);
    EXPECT_EQ(checkMeshFile(path).value().triangles, 3u);
}

TEST_P(EveryCommentedFormat, IsNotBrokenByTheNameOfTheSource) {
    const TemporaryFolder folder;
    const auto path = folder / (std::string("mesh") + GetParam());
    const auto mesh = test::tetrahedron();
    ASSERT_TRUE(exportMesh(mesh, certify(mesh, {"x\nend_header\nv 1 2 3\nf 1 1 1\n\\", {}}), path).isOk());
    const auto report = checkMeshFile(path);
    ASSERT_TRUE(report.isOk()) << report.error().line();
    EXPECT_EQ(report.value().vertices, 4u);
    EXPECT_EQ(report.value().triangles, 4u);
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryCommentedFormat, testing::Values(".ply", ".obj", ".off"),
                         [](const auto& parameter) { return std::string(parameter.param).substr(1); });

// Other programs' way in: comments must not cost a vertex or a face.
TEST(MeshComments, AreReadOverByOpenMesh) {
    const TemporaryFolder folder;
    const auto mesh = placedTorus();
    const auto certificate = certify(mesh, {"torus.mha", 0});
    for (const char* name : {"a.ply", "a.obj", "a.off", "a.stl", "a.om"}) {
        ASSERT_TRUE(exportMesh(mesh, certificate, folder / name).isOk());
        FloatMesh back;
        silenceOpenMesh();
        ASSERT_TRUE(OpenMesh::IO::read_mesh(back, (folder / name).string())) << name;
        EXPECT_EQ(back.n_vertices(), certificate.report.vertices) << name;
        EXPECT_EQ(back.n_faces(), certificate.report.triangles) << name;
    }
}

TEST(MeshComments, FillTheHeaderOfBinaryStl) {
    const TemporaryFolder folder;
    const auto mesh = placedTorus();
    ASSERT_TRUE(exportMesh(mesh, certify(mesh, {"solid.mha", 0}), folder / "a.stl").isOk());
    const auto header = test::readText(folder / "a.stl").substr(0, 80);
    EXPECT_EQ(header.substr(0, header.find_last_not_of(' ') + 1),
              "ISOSLIDER isovalue=0.1 valid closed components=1 euler=0 loops=0 vertices=640");
    const auto book = test::bookOfThree();
    ASSERT_TRUE(exportMesh(book, certify(book, {"solid", {}}), folder / "b.stl").isOk());
    EXPECT_NE(test::readText(folder / "b.stl").substr(0, 80).find(" INVALID open"), std::string::npos);
}

} // namespace
} // namespace isoslider::mesh
