#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/base/file_system.h"
#include "core/base/job_control.h"
#include "core/mesh/triangle_soup.h"

// Readers of the simple formats, from the bytes of a whole file. Not OpenMesh's: those round
// positions to float, drop triangles that a check has to see, print, and loop on damaged files.
// Errors of all: InvalidArgument, Corruption (the file ends early), Cancelled.

namespace isoslider::mesh {

Result<TriangleSoup> readPly(std::string_view bytes, const std::filesystem::path& path, const JobControl& job);
Result<TriangleSoup> readObj(std::string_view bytes, const std::filesystem::path& path, const JobControl& job);
Result<TriangleSoup> readOff(std::string_view bytes, const std::filesystem::path& path, const JobControl& job);
/// Binary or text. Corners at exactly equal positions become one vertex.
Result<TriangleSoup> readStl(std::string_view bytes, const std::filesystem::path& path, const JobControl& job);

/// Cuts a polygon into a fan. `corners` are indices as a file gives them; whether the vertices
/// exist is asked at the end, by checkIndices.
Status addPolygon(TriangleSoup& soup, std::span<const std::int64_t> corners, const std::filesystem::path& path);
Status checkIndices(const TriangleSoup& soup, const std::filesystem::path& path);

} // namespace isoslider::mesh
