#pragma once

#include <string>

#include "core/base/result.h"

namespace isoslider::model {

/// A message to the user that does not interrupt them.
struct Notice {
    enum class Severity { Information, Error };
    Severity severity = Severity::Information;
    std::string title;
    std::string detail;
    ErrorCode code = ErrorCode::InvalidArgument; ///< of an Error
};

} // namespace isoslider::model
