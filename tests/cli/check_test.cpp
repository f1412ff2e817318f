#include "tests/cli/cli_fixture.h"

namespace isoslider::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CliCheck : public CliTest {
protected:
    std::string mesh(const std::string& name, const std::string& vertices, const std::string& faces) const {
        return folder_.write(name, vertices + faces).string();
    }
    const std::string corners_ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
};

TEST_F(CliCheck, AcceptsATetrahedron) {
    const auto file = mesh("good.obj", corners_, "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    const auto json = runJson({"check", file});
    EXPECT_THAT(keysOf(json),
                ElementsAre("manifold", "closed", "oriented", "vertices", "edges", "triangles", "components", "euler",
                            "boundary_loops", "genus", "degenerate_triangles", "duplicate_triangles"));
    EXPECT_EQ(json["closed"], true);
    EXPECT_EQ(json["euler"], 2);
    EXPECT_EQ(json["genus"], 0);
}

TEST_F(CliCheck, AcceptsAnOpenMesh) {
    const auto json = runJson({"check", mesh("open.obj", corners_, "f 1 3 2\nf 1 2 4\nf 2 3 4\n")});
    EXPECT_EQ(json["closed"], false);
    EXPECT_EQ(json["boundary_loops"], 1);
}

TEST_F(CliCheck, SaysWhichFaultItFound) {
    const auto check = [this](const std::string& file) {
        const auto result = run({"check", file, "--json"});
        EXPECT_EQ(result.exitCode, 1) << result.standardError;
        EXPECT_TRUE(OrderedJson::parse(result.standardOutput, nullptr, false).is_object());
        return result.standardError;
    };
    EXPECT_THAT(check(mesh("fin.obj", corners_ + "v 1 1 1\n", "f 1 2 3\nf 2 1 4\nf 1 2 5\n")),
                HasSubstr("not manifold"));
    EXPECT_THAT(check(mesh("flip.obj", corners_, "f 1 2 3\nf 1 2 4\n")), HasSubstr("oriented"));
    EXPECT_THAT(check(mesh("flat.obj", corners_, "f 1 2 3\nf 1 1 4\n")), HasSubstr("degenerate"));
    EXPECT_THAT(check(mesh("twice.obj", corners_, "f 1 2 3\nf 1 2 3\n")), HasSubstr("duplicate"));
}

TEST_F(CliCheck, RefusesWhatIsNoMesh) {
    expectRefusal({"check"}, 2, "MESH");
    expectRefusal({"check", path("missing.ply")}, 4, "missing.ply");
    expectRefusal({"check", folder_.path().string()}, 3);
    folder_.write("text.ply", "The quick brown fox\n");
    expectRefusal({"check", path("text.ply")}, 3, "text.ply");
    folder_.write("mesh.docx", "v 0 0 0\n");
    expectRefusal({"check", path("mesh.docx")}, 3, "mesh.docx");
}

} // namespace isoslider::test
