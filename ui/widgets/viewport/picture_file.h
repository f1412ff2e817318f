#pragma once

#include <filesystem>

#include <QImage>

#include "core/base/result.h"

namespace isoslider::widgets {

/// Encodes a picture in the format that the suffix of `path` names; it appears there whole or not at all. A large one
/// takes longer than the window may wait, and so may the disk: call it from a job.
/// Errors: InvalidArgument for a suffix that names no format, those of AtomicFile.
Status writePicture(const QImage& picture, const std::filesystem::path& path);

} // namespace isoslider::widgets
