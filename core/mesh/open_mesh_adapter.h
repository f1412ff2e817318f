#pragma once

// MeshIO.hh comes before the mesh types: OpenMesh's readers and writers register themselves through
// it, and the mesh headers specialise templates that it must have seen first.
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "core/base/job_control.h"
#include "core/mesh/triangle_soup.h"

namespace isoslider::mesh {

struct FloatTraits : OpenMesh::DefaultTraits {};
struct DoubleTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
};
using FloatMesh = OpenMesh::TriMesh_ArrayKernelT<FloatTraits>;
using DoubleMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

/// What add_face refuses is left out, or (Separate) gets three vertices of its own so that it is
/// not lost. A triangle that repeats an index is left out either way.
enum class RefusedFaces { LeaveOut, Separate };

/// Adds the soup to an empty mesh and returns how many triangles OpenMesh refused. Errors: Cancelled.
template <class Mesh>
Result<std::uint64_t> fillOpenMesh(const TriangleSoup& soup, RefusedFaces refused, Mesh& mesh,
                                   const JobControl& job = {});

/// Stops OpenMesh from printing; it reports by return values as well.
void silenceOpenMesh();

} // namespace isoslider::mesh
