#pragma once

#include <span>
#include <string>

#include "core/base/file_system.h"
#include "core/mesh/triangle_soup.h"

namespace isoslider::mesh {

/// How many digits positions get: text formats are written in the shortest form that reads back
/// as the same float or double; PLY in that type; STL is always float.
enum class Precision { Float, Double };

inline constexpr std::size_t kStlHeaderBytes = 80;

/// Lines for a file's head (OFF: its end), each without its line end. REQUIRES: printable ASCII, no backslash.
using Comments = std::span<const std::string>;

/// Writes the soup as it stands, triangles that no halfedge mesh would take included.
/// Errors: those of AtomicFile.
Status writePly(const TriangleSoup& soup, Precision precision, Comments comments, AtomicFile& file);
Status writeObj(const TriangleSoup& soup, Precision precision, Comments comments, AtomicFile& file);
Status writeOff(const TriangleSoup& soup, Precision precision, Comments comments, AtomicFile& file);
/// `header` fills the first kStlHeaderBytes, cut or padded with spaces. REQUIRES: it does not begin with
/// "solid", the mark of the text form.
Status writeStl(const TriangleSoup& soup, std::string header, AtomicFile& file);

} // namespace isoslider::mesh
