#pragma once

#include <string>

#include "app/cli/outcome.h"
#include "core/index/format/index_info.h"
#include "core/mesh/certificate.h"

namespace isoslider::cli {

/// The last name in a path, also of a folder given with a slash behind it.
std::string sourceName(const std::string& path);

/// The volume that an index was built from, named after the index should that name be lost.
mesh::SurfaceSource sourceOf(const index::IndexInfo& info, const std::string& indexPath);

/// Success, or the faults of a surface on one line that names `path`.
Outcome faultOutcome(const mesh::Certificate& certificate, const std::string& path);

} // namespace isoslider::cli
