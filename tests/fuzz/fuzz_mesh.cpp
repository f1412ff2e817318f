#include <algorithm>
#include <cmath>

#include "core/mesh/mesh_checks.h"
#include "core/mesh/mesh_import.h"
#include "tests/fuzz/fuzz_support.h"
#include "tests/fuzz/fuzz_targets.h"

namespace isoslider::fuzz {
namespace {

constexpr std::size_t kMaxChecked = 2000; ///< triangles

void requireGoodSoup(const Result<mesh::TriangleSoup>& read, std::size_t fileBytes) {
    if (!read.isOk())
        return requireGoodError(read.error());
    const mesh::TriangleSoup& soup = read.value();
    for (const mesh::Triangle& triangle : soup.triangles)
        for (const auto vertex : triangle)
            ISO_REQUIRE(vertex < soup.positions.size(), std::to_string(vertex));
    for (const glm::dvec3& p : soup.positions)
        ISO_REQUIRE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "");
    ISO_REQUIRE(soup.positions.size() <= fileBytes && soup.triangles.size() <= fileBytes, "each takes a byte at least");
    if (soup.triangles.size() > kMaxChecked)
        return;
    const mesh::MeshReport report = mesh::checkSoup(soup);
    ISO_REQUIRE(report.triangles == soup.triangles.size(), "");
    ISO_REQUIRE(report.vertices <= soup.positions.size(), "");
}

} // namespace

/// A mesh file. That it is OpenMesh's own its first bytes state; of other kinds nothing does, so it is given to each
/// reader.
void fuzzMesh(std::span<const std::byte> bytes) {
    const bool isOpenMesh = bytes.size() >= 2 && bytes[0] == std::byte{'O'} && bytes[1] == std::byte{'M'};
    for (const char* name : {"input.ply", "input.obj", "input.off", "input.stl"})
        requireGoodSoup(mesh::readMeshFile(writeInput(name, bytes)), bytes.size());
    if (isOpenMesh)
        requireGoodSoup(mesh::readMeshFile(writeInput("input.om", bytes)), bytes.size());
}

} // namespace isoslider::fuzz
