#pragma once

#include <filesystem>

namespace isoslider::io {

/// How far below a folder its DICOM files may lie.
inline constexpr int kMaxDicomDepth = 8;

/// True of a file that can be read and begins as DICOM does.
bool beginsAsDicom(const std::filesystem::path& path);

} // namespace isoslider::io
