#pragma once

#include <string>

#include "app/exit_code.h"
#include "core/base/result.h"

namespace isoslider::cli {

/// How a command ended: a code and, unless it is Success, one line for people.
class Outcome {
public:
    Outcome() = default; ///< success
    Outcome(ExitCode code, std::string line) : code_(code), line_(std::move(line)) {}
    Outcome(const Error& error);
    static Outcome wrongUsage(std::string line) { return {ExitCode::WrongUsage, std::move(line)}; }
    static Outcome foundFault(std::string line) { return {ExitCode::FoundFault, std::move(line)}; }

    bool isSuccess() const { return code_ == ExitCode::Success; }
    ExitCode code() const { return code_; }
    const std::string& line() const { return line_; }

private:
    ExitCode code_ = ExitCode::Success;
    std::string line_;
};

/// Returns the outcome of `expr` from the calling function, unless it is success.
#define ISO_CLI_TRY(expr) \
    do { \
        ::isoslider::cli::Outcome isoOutcome_ = (expr); \
        if (!isoOutcome_.isSuccess()) \
            return isoOutcome_; \
    } while (false)

} // namespace isoslider::cli
