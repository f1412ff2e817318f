#include "core/mesh/certificate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "tests/unit/core/mesh/test_meshes.h"

namespace isoslider::mesh {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

// Three different lengths: a face taken for another one does not fit.
GridGeometry boxGeometry() {
    GridGeometry geometry;
    geometry.dims = {12, 13, 14};
    return geometry;
}

extract::SurfaceMesh extracted(const GridGeometry& geometry, double isovalue,
                               const std::function<float(int x, int y, int z)>& valueAt) {
    std::vector<float> values;
    for (int z = 0; z < geometry.dims[2]; ++z)
        for (int y = 0; y < geometry.dims[1]; ++y)
            for (int x = 0; x < geometry.dims[0]; ++x)
                values.push_back(valueAt(x, y, z));
    auto mesh = extract::extractFull(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, values), isovalue);
    EXPECT_TRUE(mesh.isOk());
    return std::move(mesh).value();
}

extract::SurfaceMesh ballAround(const glm::vec3& middle, float radius, const GridGeometry& geometry = boxGeometry()) {
    return extracted(geometry, -radius, [&](int x, int y, int z) {
        return -glm::length(glm::vec3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) - middle);
    });
}

/// One grid point at 1 among zeros: at isovalue 1 all six vertices and eight triangles shrink to it.
extract::SurfaceMesh lonePoint(double isovalue, GridGeometry geometry = boxGeometry()) {
    return extracted(geometry, isovalue, [](int x, int y, int z) { return x == 3 && y == 4 && z == 5 ? 1.0f : 0.0f; });
}

/// The plane z = 5.5, with one sample missing just below it.
extract::SurfaceMesh planeMissing(int missingX, int missingY) {
    return extracted(boxGeometry(), 5.5, [=](int x, int y, int z) {
        return x == missingX && y == missingY && z == 5 ? kMissing : static_cast<float>(z);
    });
}

std::string valueOf(const Certificate& certificate, const std::string& name) {
    for (const auto& line : linesOf(certificate))
        if (line.name == name)
            return line.value;
    return "no line " + name;
}

std::uint64_t edgesIn(const Certificate& certificate) {
    std::uint64_t edges = 0;
    for (const Opening& opening : certificate.openings)
        edges += opening.edges;
    return edges;
}

TEST(Certificate, OfASphereIsClosed) {
    const auto mesh = ballAround({5.3f, 6.1f, 6.4f}, 4.0f);
    const auto certificate = certify(mesh, {"ball.mha", 0});
    EXPECT_TRUE(isValid(certificate));
    EXPECT_TRUE(certificate.report.isClosed);
    EXPECT_EQ(openingText(certificate), "closed");
    EXPECT_EQ(edgesIn(certificate), 0u);
    EXPECT_EQ(certificate.report.components, 1u);
    EXPECT_EQ(certificate.report.genus, 0);
    EXPECT_EQ(certificate.activeEdges, mesh.edgeIds.size());
    EXPECT_EQ(certificate.innerVertices, 0u);
    EXPECT_EQ(certificate.isovalue, -4.0);
    EXPECT_EQ(certificate.nudge.vertices, 0u);
    EXPECT_EQ(valueOf(certificate, "valid"), "yes");
    EXPECT_EQ(valueOf(certificate, "source"), "ball.mha");
    EXPECT_EQ(valueOf(certificate, "isovalue"), "-4");
    EXPECT_EQ(valueOf(certificate, "grid"), "12 x 13 x 14 points, spacing 1 1 1, origin 0 0 0, right-handed");
    EXPECT_EQ(std::stod(valueOf(certificate, "enclosed volume")), certificate.report.enclosedVolume);
    EXPECT_GT(certificate.report.enclosedVolume, 200.0);
}

class EveryFace : public testing::TestWithParam<int> {};

TEST_P(EveryFace, IsNamedWhereItCutsTheSurface) {
    const int axis = GetParam() / 2;
    const bool isUpper = GetParam() % 2 == 1;
    glm::vec3 middle(5.3f, 6.1f, 6.4f);
    middle[axis] = isUpper ? static_cast<float>(boxGeometry().dims[static_cast<std::size_t>(axis)]) - 2.6f : 1.6f;
    const auto certificate = certify(ballAround(middle, 3.0f), {"ball", 0});
    const Opening& opening = certificate.openings[static_cast<std::size_t>(GetParam())];
    EXPECT_TRUE(isValid(certificate)) << valueOf(certificate, "valid");
    EXPECT_FALSE(certificate.report.isClosed);
    EXPECT_EQ(opening.loops, 1u);
    EXPECT_GT(opening.edges, 8u);
    EXPECT_EQ(edgesIn(certificate), opening.edges);
    const std::string name(kOpenAtNames[static_cast<std::size_t>(GetParam())]);
    EXPECT_EQ(openingText(certificate), "open at " + name + " (1 loop, " + std::to_string(opening.edges) + " edges)");
    EXPECT_EQ(valueOf(certificate, "enclosed volume"), "none: open");
}

INSTANTIATE_TEST_SUITE_P(Faces, EveryFace, testing::Range(0, 6), [](const auto& parameter) {
    return std::string(kOpenAtNames[static_cast<std::size_t>(parameter.param)]);
});

TEST(Certificate, IsNotOpenAtAFaceThatItRunsAlong) {
    for (int axis = 0; axis < 3; ++axis) { // the plane half a cell from a face: its vertices' edges begin on that face
        const auto mesh = extracted(boxGeometry(), 0.5, [axis](int x, int y, int z) {
            return static_cast<float>(std::array{x, y, z}[static_cast<std::size_t>(axis)]);
        });
        const auto certificate = certify(mesh, {"plane", 0});
        for (std::size_t face = 0; face < 6; ++face)
            EXPECT_EQ(certificate.openings[face].loops, face / 2 == static_cast<std::size_t>(axis) ? 0u : 1u)
                << axis << face;
        EXPECT_TRUE(isValid(certificate));
    }
}

TEST(Certificate, CountsALoopAtEachFaceThatItRunsOver) {
    const auto certificate = certify(ballAround({0.2f, 0.3f, 0.1f}, 4.0f), {"ball", 0});
    EXPECT_EQ(certificate.report.boundaryLoops, 1u);
    for (const OpenAt place : {OpenAt::X0, OpenAt::Y0, OpenAt::Z0})
        EXPECT_EQ(certificate.openAt(place).loops, 1u);
    for (const OpenAt place : {OpenAt::X1, OpenAt::Y1, OpenAt::Z1, OpenAt::Missing, OpenAt::Elsewhere})
        EXPECT_EQ(certificate.openAt(place).edges, 0u);
    EXPECT_EQ(certificate.sharedLoops, 1u);
    EXPECT_TRUE(openingText(certificate).ends_with("; 1 loop meets several of these")) << openingText(certificate);
}

TEST(Certificate, SaysWhichLoopsCountTwice) {
    // A ball over an edge of the box, and one at each of the two faces beside it.
    const auto mesh = extracted(boxGeometry(), -2.0, [](int x, int y, int z) {
        const glm::vec3 p(x, y, z);
        return -std::min({glm::distance(p, {5.2f, 0.1f, 0.2f}), glm::distance(p, {5.3f, 6.4f, 0.1f}),
                          glm::distance(p, {5.1f, 0.2f, 6.3f})});
    });
    const auto certificate = certify(mesh, {"balls", 0});
    EXPECT_EQ(certificate.report.boundaryLoops, 3u);
    EXPECT_EQ(certificate.openAt(OpenAt::Y0).loops, 2u);
    EXPECT_EQ(certificate.openAt(OpenAt::Z0).loops, 2u);
    EXPECT_EQ(certificate.sharedLoops, 1u);
    EXPECT_TRUE(openingText(certificate).ends_with("; 1 loop meets both")) << openingText(certificate);
}

TEST(Certificate, TellsTwoLoopsAtOneFaceApart) {
    const auto mesh = extracted(boxGeometry(), -2.5, [](int x, int y, int z) { // two rods that end at x1
        const float a = std::hypot(static_cast<float>(y) - 3.2f, static_cast<float>(z) - 3.1f);
        const float b = std::hypot(static_cast<float>(y) - 9.1f, static_cast<float>(z) - 9.3f);
        return -std::max(std::min(a, b), 5.0f - static_cast<float>(x));
    });
    const auto certificate = certify(mesh, {"rods", 0});
    EXPECT_EQ(certificate.report.components, 2u);
    EXPECT_EQ(certificate.openAt(OpenAt::X1).loops, 2u);
    EXPECT_EQ(edgesIn(certificate), certificate.openAt(OpenAt::X1).edges);
}

TEST(Certificate, KnowsAHoleAtAMissingValue) {
    const auto certificate = certify(planeMissing(6, 7), {"plane", 1});
    EXPECT_TRUE(isValid(certificate));
    EXPECT_EQ(certificate.openAt(OpenAt::Missing).loops, 1u);
    EXPECT_EQ(certificate.openAt(OpenAt::Missing).edges, 8u); // round four cells
    EXPECT_EQ(certificate.openAt(OpenAt::X0).edges, 12u);
    EXPECT_EQ(certificate.openAt(OpenAt::Y1).edges, 11u);
    EXPECT_EQ(certificate.openAt(OpenAt::Z0).edges, 0u);
    EXPECT_EQ(certificate.report.boundaryLoops, 2u);
    EXPECT_EQ(valueOf(certificate, "boundary"), "open at x0 (1 loop, 12 edges), x1 (1 loop, 12 edges), "
                                                "y0 (1 loop, 11 edges), y1 (1 loop, 11 edges), "
                                                "missing values (1 loop, 8 edges); 1 loop meets several of these");
}

TEST(Certificate, KnowsAHoleAtAMissingValueThatMeetsTheBox) {
    const auto certificate = certify(planeMissing(0, 7), {"plane", 1});
    EXPECT_EQ(certificate.openAt(OpenAt::Missing).edges, 4u);
    EXPECT_EQ(certificate.openAt(OpenAt::X0).edges, 10u);
    EXPECT_EQ(certificate.report.boundaryLoops, 1u);
}

TEST(Certificate, CallsAHoleACrackWhereNothingIsMissing) {
    const auto unknown = certify(planeMissing(6, 7), {"plane", {}});
    EXPECT_TRUE(isValid(unknown));
    const auto certificate = certify(planeMissing(6, 7), {"plane", 0});
    EXPECT_FALSE(isValid(certificate));
    EXPECT_EQ(certificate.openAt(OpenAt::Elsewhere).edges, 8u);
    EXPECT_EQ(certificate.openAt(OpenAt::Missing).edges, 0u);
    EXPECT_EQ(valueOf(certificate, "valid"), "no: 8 boundary edges neither on the box nor at a missing value");
}

TEST(Certificate, HoldsVerticesOffATie) {
    GridGeometry geometry = boxGeometry();
    geometry.spacing = {1.0, 2.0, 3.0};
    const auto certificate = certify(lonePoint(1.0, geometry), {"tie", 0});
    EXPECT_TRUE(isValid(certificate)) << valueOf(certificate, "valid");
    EXPECT_EQ(certificate.report.triangles, 8u);
    EXPECT_EQ(certificate.report.degenerateTriangles, 0u);
    EXPECT_EQ(certificate.report.euler, 2);
    EXPECT_GT(certificate.report.enclosedVolume, 0.0);
    EXPECT_EQ(certificate.nudge.vertices, 6u);
    EXPECT_EQ(certificate.nudge.largestCells, 1.0 / 2048);
    EXPECT_EQ(certificate.nudge.largestWorld, 3.0 / 2048);
    EXPECT_EQ(valueOf(certificate, "nudged vertices"),
              "6, held off grid points, by at most 0.00048828125 cells (0.00146484375 units)");
}

TEST(Certificate, SaysThatVerticesOfMergedCellsAreOnActiveEdges) {
    SurfaceSource source{"tie", 0};
    source.merging = "within 1 cell";
    EXPECT_TRUE(valueOf(certify(lonePoint(1.0), source), "nudged vertices")
                    .starts_with("6, held off grid points and on active grid edges, by at most 0.0004"));
}

TEST(Certificate, StatesAreaVolumeAndNudgeInTheUnitOfLength) {
    for (const auto& [unit, name] : {std::pair("", "units"), std::pair("mm", "mm"), std::pair("Å", "angstrom")}) {
        const auto certificate = certify(lonePoint(1.0), {"tie", 0, unit});
        const std::string inUnit = name; // the lambda may not hold a binding
        const auto endsWith = [&](const char* line, const std::string& words) {
            return valueOf(certificate, line).ends_with(words + inUnit) ||
                   valueOf(certificate, line).ends_with(words + inUnit + ")");
        };
        EXPECT_TRUE(endsWith("area", " square ")) << valueOf(certificate, "area");
        EXPECT_TRUE(endsWith("enclosed volume", " cubic ")) << valueOf(certificate, "enclosed volume");
        EXPECT_TRUE(endsWith("nudged vertices", " ")) << valueOf(certificate, "nudged vertices");
    }
}

TEST(Certificate, NamesThePatientsDirectionsThatPlacesAreIn) {
    SurfaceSource source{"head", 0, "mm"};
    const auto commentOf = [&] {
        const auto comments = commentsOf(certify(lonePoint(0.5), source));
        const auto found = std::ranges::find_if(
            comments, [](const std::string& comment) { return comment.starts_with("coordinates: "); });
        return found != comments.end() ? *found : std::string();
    };
    EXPECT_EQ(commentOf(), "");
    source.isPatientSpace = true;
    EXPECT_EQ(commentOf(), "coordinates: LPS: x to the left, y to posterior, z to superior, as in DICOM");
}

TEST(Certificate, ReportsNoNudgeAwayFromTies) {
    const auto certificate = certify(lonePoint(0.5), {"point", 0});
    EXPECT_EQ(certificate.nudge.vertices, 0u);
    EXPECT_EQ(certificate.nudge.largestCells, 0.0);
    EXPECT_EQ(valueOf(certificate, "nudged vertices"), "0");
}

TEST(Certificate, FacesTheSameSideInALeftHandedGrid) {
    GridGeometry mirrored = boxGeometry();
    mirrored.direction[2] = {0, 0, -1};
    const auto right = certify(ballAround({5.3f, 6.1f, 6.4f}, 4.0f), {"ball", 0});
    const auto left = certify(ballAround({5.3f, 6.1f, 6.4f}, 4.0f, mirrored), {"ball", 0});
    EXPECT_TRUE(isValid(left));
    EXPECT_NEAR(left.report.enclosedVolume, right.report.enclosedVolume, 1e-9);
    EXPECT_NE(valueOf(left, "grid").find("left-handed"), std::string::npos);
    EXPECT_NE(valueOf(right, "grid").find("right-handed"), std::string::npos);
    EXPECT_EQ(valueOf(left, "orientation"), "counter-clockwise seen from the side below the isovalue");
}

/// The tie of lonePoint with its first triangle split at a vertex inside the cell, hard by a grid plane.
extract::SurfaceMesh withInnerVertex() {
    auto mesh = lonePoint(1.0);
    const std::array<std::uint32_t, 3> t{mesh.triangles[0], mesh.triangles[1], mesh.triangles[2]};
    const auto inner = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.emplace_back(3.0001f, 4.25f, 5.25f);
    mesh.normals.emplace_back(0, 0, 1);
    mesh.triangles[2] = inner;
    mesh.triangles.insert(mesh.triangles.end(), {t[1], t[2], inner, t[2], t[0], inner});
    return mesh;
}

TEST(Certificate, LeavesInnerVerticesWhereTheyAre) {
    const auto mesh = withInnerVertex();
    const auto certificate = certify(mesh, {"inner", 0});
    EXPECT_TRUE(isValid(certificate)) << valueOf(certificate, "valid");
    EXPECT_EQ(certificate.activeEdges, 6u);
    EXPECT_EQ(certificate.innerVertices, 1u);
    EXPECT_EQ(certificate.report.vertices, 7u);
    EXPECT_EQ(certificate.nudge.vertices, 6u);
    const auto soup = worldSoup(mesh);
    EXPECT_EQ(soup.positions.back(), glm::dvec3(mesh.positions.back()));
    EXPECT_NE(soup.positions.front(), glm::dvec3(mesh.positions.front()));
}

TEST(Certificate, CallsAHoleAtAnInnerVertexACrack) {
    auto mesh = withInnerVertex();
    mesh.triangles.resize(mesh.triangles.size() - 3);
    const auto certificate = certify(mesh, {"inner", {}});
    EXPECT_EQ(certificate.openAt(OpenAt::Elsewhere).edges, 2u);
    EXPECT_EQ(certificate.openAt(OpenAt::Missing).edges, 1u); // that one lies in a face of the cell
    EXPECT_FALSE(isValid(certificate));
}

TEST(Certificate, CountsNoNudgeOfAnUnusedVertex) {
    auto mesh = lonePoint(1.0);
    mesh.triangles.assign({mesh.triangles[0], mesh.triangles[1], mesh.triangles[2]});
    EXPECT_EQ(nudgeOf(mesh).vertices, 3u);
}

TEST(Certificate, TellsEveryFault) {
    const auto book = certify(test::bookOfThree(), {"book", {}});
    EXPECT_EQ(valueOf(book, "valid").rfind("no: not manifold", 0), 0u) << valueOf(book, "valid");
    EXPECT_EQ(valueOf(book, "genus"), "none: not an oriented manifold");
    auto mesh = ballAround({5.3f, 6.1f, 6.4f}, 4.0f);
    mesh.positions[0].x = kMissing;
    EXPECT_EQ(valueOf(certify(mesh, {"nan", 0}), "valid"), "no: area not finite");
    mesh = ballAround({5.3f, 6.1f, 6.4f}, 4.0f);
    std::swap(mesh.triangles[0], mesh.triangles[1]);
    EXPECT_EQ(valueOf(certify(mesh, {"turned", 0}), "valid"), "no: not consistently oriented");
}

TEST(Certificate, OfNoSurfaceIsValid) {
    const auto certificate = certify(ballAround({5, 5, 5}, -1.0f), {"nothing", 0});
    EXPECT_TRUE(isValid(certificate));
    EXPECT_EQ(openingText(certificate), "closed");
}

TEST(Certificate, CleansTheNameOfTheSource) {
    const auto mesh = lonePoint(0.5);
    EXPECT_EQ(valueOf(certify(mesh, {"a b\nend_header\r\x1b\\c\xc3\xa9\x7f.mha", 0}), "source"),
              "a b?end_header???c\xc3\xa9?.mha");
    // Beyond ASCII only what is no character, and what controls a terminal or ends a line, goes.
    EXPECT_EQ(valueOf(certify(mesh, {"Sch\xc3\xa4"
                                     "del \xe9\xa0\xad\xf0\x9f\xa7\xa0.mha",
                                     0}),
                      "source"),
              "Sch\xc3\xa4"
              "del \xe9\xa0\xad\xf0\x9f\xa7\xa0.mha");
    EXPECT_EQ(valueOf(certify(mesh, {"\xc2\x9b|\xe2\x80\xa8|\xc0\xaf|\xed\xa0\x80|\xf9|\xe9\xa0", 0}), "source"),
              "??|???|??|???|?|??");
    EXPECT_EQ(valueOf(certify(mesh, {std::string(5000, 'n'), 0}), "source").size(), 203u);
    for (const auto& line : commentsOf(certify(mesh, {std::string("\0\n\t\xff", 4), 0})))
        for (const char c : line)
            EXPECT_TRUE(c >= 0x20 && c < 0x7f) << line;
}

TEST(Certificate, HasAShortFormForEveryLength) {
    auto mesh = lonePoint(0.5);
    mesh.isovalue = -1.2345678901234568e-300;
    const auto certificate = certify(mesh, {"solid", 0});
    const auto whole = shortForm(certificate, 200);
    EXPECT_EQ(whole,
              "ISOSLIDER isovalue=-1.2345678901234568e-300 valid closed components=1 euler=2 loops=0 vertices=6");
    for (std::size_t length = 9; length < whole.size(); ++length)
        EXPECT_LE(shortForm(certificate, length).size(), length);
    EXPECT_EQ(shortForm(certificate, 80),
              "ISOSLIDER isovalue=-1.2345678901234568e-300 valid closed components=1 euler=2");
}

} // namespace
} // namespace isoslider::mesh
