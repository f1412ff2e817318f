#pragma once

#include <ostream>

#include <gmock/gmock.h>

#include "core/base/result.h"

namespace isoslider {

/// How GoogleTest shows an error in a failure message.
inline void PrintTo(const Error& error, std::ostream* out) { // NOLINT: the name is GoogleTest's
    *out << errorCodeName(error.code) << ": " << error.line();
}

template <class T>
void PrintTo(const Result<T>& result, std::ostream* out) { // NOLINT: the name is GoogleTest's
    if (result.isOk())
        *out << "a value";
    else
        PrintTo(result.error(), out);
}

namespace test {

/// EXPECT_THAT(openVolume(path), IsOk());
MATCHER(IsOk, negation ? "is an error" : "is a value") {
    if (!arg.isOk())
        *result_listener << errorCodeName(arg.error().code) << ": " << arg.error().line();
    return arg.isOk();
}

/// EXPECT_THAT(openVolume(path), HasError(ErrorCode::NotFound));
MATCHER_P(HasError, code, std::string(negation ? "is not " : "is ") + std::string(errorCodeName(code))) {
    if (arg.isOk()) {
        *result_listener << "it is a value";
        return false;
    }
    *result_listener << errorCodeName(arg.error().code) << ": " << arg.error().line();
    return arg.error().code == code;
}

} // namespace test
} // namespace isoslider
