#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "core/base/check.h"

namespace isoslider {

/// Why an operation did not deliver. Programmer errors are not here: those are ISO_CHECK.
enum class ErrorCode {
    NotFound, ///< the file, or a file it refers to, does not exist
    Corruption, ///< bytes on disk contradict themselves or their checksum
    UnsupportedVersion, ///< a well-formed file of a version or kind this program does not read
    InvalidArgument, ///< a request or an input that is refused
    IoError, ///< the operating system failed a read or write
    OutOfSpace, ///< no room on disk or in the stated memory budget
    Cancelled, ///< stopped on request: a separate outcome, never shown as a fault
};

std::string_view errorCodeName(ErrorCode code);

/// What happened, to which file, and where in it. `message` is one line for users.
struct Error {
    ErrorCode code = ErrorCode::InvalidArgument;
    std::string message;
    std::string path;
    std::optional<std::uint64_t> offset;

    /// One line: "path: message (at byte N)". Control characters in the path are escaped.
    std::string line() const;
};

Error makeError(ErrorCode code, std::string message, std::string path = {},
                std::optional<std::uint64_t> offset = std::nullopt);

/// A value or an Error. Has no conversion to bool on purpose: state `isOk()`.
template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

    bool isOk() const { return state_.index() == 0; }
    bool isCancelled() const { return !isOk() && error().code == ErrorCode::Cancelled; }

    /// REQUIRES: isOk().
    T& value() & {
        ISO_CHECK(isOk());
        return std::get<0>(state_);
    }
    const T& value() const& {
        ISO_CHECK(isOk());
        return std::get<0>(state_);
    }
    T&& value() && {
        ISO_CHECK(isOk());
        return std::get<0>(std::move(state_));
    }

    /// REQUIRES: !isOk().
    const Error& error() const& {
        ISO_CHECK(!isOk());
        return std::get<1>(state_);
    }
    Error&& error() && {
        ISO_CHECK(!isOk());
        return std::get<1>(std::move(state_));
    }

private:
    std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
public:
    Result() = default;
    Result(Error error) : error_(std::move(error)) {}

    bool isOk() const { return !error_; }
    bool isCancelled() const { return error_ && error_->code == ErrorCode::Cancelled; }
    const Error& error() const& {
        ISO_CHECK(error_.has_value());
        return *error_;
    }
    Error&& error() && {
        ISO_CHECK(error_.has_value());
        return std::move(*error_);
    }

private:
    std::optional<Error> error_;
};

using Status = Result<void>;

/// Returns the error of `expr` from the calling function, if there is one.
#define ISO_TRY(expr) \
    do { \
        auto isoTryStatus_ = (expr); \
        if (!isoTryStatus_.isOk()) \
            return std::move(isoTryStatus_).error(); \
    } while (false)

} // namespace isoslider
