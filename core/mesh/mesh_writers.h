#pragma once

#include "core/base/file_system.h"
#include "core/mesh/triangle_soup.h"

namespace isoslider::mesh {

/// How many digits positions get: text formats are written in the shortest form that reads back
/// as the same float or double; PLY in that type; STL is always float.
enum class Precision { Float, Double };

/// Writes the soup as it stands, triangles that no halfedge mesh would take included.
/// Errors: those of AtomicFile.
Status writePly(const TriangleSoup& soup, Precision precision, AtomicFile& file);
Status writeObj(const TriangleSoup& soup, Precision precision, AtomicFile& file);
Status writeOff(const TriangleSoup& soup, Precision precision, AtomicFile& file);
Status writeStl(const TriangleSoup& soup, AtomicFile& file);

} // namespace isoslider::mesh
