#pragma once

#include "core/base/result.h"

namespace isoslider {

/// What the shell gets back. The numbers are part of the programs' interface.
enum class ExitCode : int {
    Success = 0,
    FoundFault = 1, ///< a check ran and found a fault
    WrongUsage = 2, ///< the command line asks for something that does not exist or cannot be
    Refused = 3, ///< an input that is damaged, unsupported or not what it should be
    IoFailure = 4, ///< the operating system could not read or write, or there is no room
    Interrupted = 130,
};

inline ExitCode exitCodeOf(ErrorCode code) {
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

} // namespace isoslider
