#include "app/cli/outcome.h"

namespace isoslider::cli {

Outcome::Outcome(const Error& error)
    : Outcome(exitCodeOf(error.code), error.code == ErrorCode::Cancelled ? std::string("interrupted") : error.line()) {}

} // namespace isoslider::cli
