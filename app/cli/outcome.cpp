#include "app/cli/outcome.h"

namespace isoslider::cli {
namespace {

ExitCode exitCodeFor(ErrorCode code) {
    switch (code) {
        case ErrorCode::InvalidArgument:
        case ErrorCode::Corruption:
        case ErrorCode::UnsupportedVersion: return ExitCode::Refused;
        case ErrorCode::NotFound:
        case ErrorCode::IoError:
        case ErrorCode::OutOfSpace: return ExitCode::IoFailure;
        case ErrorCode::Cancelled: return ExitCode::Interrupted;
    }
    return ExitCode::IoFailure;
}

} // namespace

Outcome::Outcome(const Error& error)
    : Outcome(exitCodeFor(error.code),
              error.code == ErrorCode::Cancelled ? std::string("interrupted") : error.line()) {}

} // namespace isoslider::cli
