#pragma once

#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace isoslider {

/// What exceptions become, with the path that messages name, if any.
struct ThrownErrors {
    std::string_view noMemory; ///< the message of std::bad_alloc, which is OutOfSpace
    ErrorCode code = ErrorCode::IoError; ///< of all others, whose words follow `other` and a colon
    std::string_view other = "unexpected failure";
    std::filesystem::path path = {};
};

/// Calls `function`, which returns a Result or a Status. Whatever it throws is returned as an error: libraries throw,
/// and memory may be missing anywhere, but no exception leaves a thread or reaches a caller that expects a Result.
template <class Function>
auto guarded(const ThrownErrors& errors, Function&& function) -> decltype(function()) {
    try {
        return function();
    } catch (const std::bad_alloc&) {
        return makeError(ErrorCode::OutOfSpace, std::string(errors.noMemory), errors.path);
    } catch (const std::exception& thrown) {
        return makeError(errors.code, std::string(errors.other) + ": " + thrown.what(), errors.path);
    }
}

} // namespace isoslider
