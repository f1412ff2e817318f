#pragma once

#include <string>

#include "core/base/result.h"

namespace isoslider::cli {

/// A name of a file or volume for a report, in one line: control characters as errors show them.
inline std::string escapedName(const std::string& name) { return makeError(ErrorCode::InvalidArgument, name).line(); }

} // namespace isoslider::cli
