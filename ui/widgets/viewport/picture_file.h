#pragma once

#include <filesystem>

#include <QImage>

#include "core/base/job_control.h"
#include "core/base/result.h"
#include "ui/widgets/viewport/viewport_host.h"

namespace isoslider::widgets {

/// Encodes a picture in the format that the suffix of `path` names; it appears there whole or not at all. A large one
/// takes longer than the window may wait, and so may the disk: call it from a job.
/// Errors: InvalidArgument for a suffix that names no format, those of AtomicFile.
Status writePicture(const QImage& picture, const std::filesystem::path& path);

/// The same of one that is still to be drawn: waits for it on a worker thread. Errors: besides those above, Cancelled;
/// IoError where it cannot be drawn.
Status writeOrdered(const ViewportHost::OrderedPicture& ordered, const std::filesystem::path& path,
                    const JobControl& job);

} // namespace isoslider::widgets
