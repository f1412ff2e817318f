#pragma once

#include <span>
#include <string>

#include "core/base/file_system.h"
#include "core/base/job_control.h"
#include "core/mesh/triangle_soup.h"

namespace isoslider::mesh {

/// A file this long or longer is synced now and then while it is written: one sync at the end would take long.
inline constexpr std::uint64_t kSyncBytes = std::uint64_t{32} << 20;

/// How many digits positions get: text formats are written in the shortest form that reads back
/// as the same float or double; PLY in that type; STL is always float.
enum class Precision { Float, Double };

inline constexpr std::size_t kStlHeaderBytes = 80;

/// Lines for a file's head (OFF: its end), each without its line end. REQUIRES: no control characters, no backslash.
using Comments = std::span<const std::string>;

/// Writes the soup as it stands, triangles that no halfedge mesh would take included.
/// Errors: those of AtomicFile; Cancelled.
Status writePly(const TriangleSoup& soup, Precision precision, Comments comments, AtomicFile& file,
                const JobControl& job = {});
Status writeObj(const TriangleSoup& soup, Precision precision, Comments comments, AtomicFile& file,
                const JobControl& job = {});
Status writeOff(const TriangleSoup& soup, Precision precision, Comments comments, AtomicFile& file,
                const JobControl& job = {});
/// `header` fills the first kStlHeaderBytes, cut or padded with spaces. REQUIRES: it does not begin with
/// "solid", the mark of the text form.
Status writeStl(const TriangleSoup& soup, std::string header, AtomicFile& file, const JobControl& job = {});

} // namespace isoslider::mesh
