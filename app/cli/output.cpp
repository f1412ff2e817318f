#include "app/cli/output.h"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include <nlohmann/json.hpp>

namespace isoslider::cli {

std::string jsonText(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

void Output::write(std::string_view text) {
    if (isSilent_)
        return;
    if (isForData_)
        std::fwrite(text.data(), 1, text.size(), stderr);
    else
        put(text);
}

void Output::put(std::string_view text) {
    if (isClosed_ || errorNumber_ != 0)
        return;
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
        noteFailure();
}

void Output::writeJson(const Json& object) { put(jsonText(object) + '\n'); }

Status Output::flush() {
    if (!isClosed_ && errorNumber_ == 0 && std::fflush(stdout) != 0)
        noteFailure();
    if (errorNumber_ == 0)
        return {};
    const auto code = errorNumber_ == ENOSPC ? ErrorCode::OutOfSpace : ErrorCode::IoError;
    return makeError(code, "cannot write: " + std::generic_category().message(errorNumber_), "standard output");
}

void Output::noteFailure() {
    if (errno == EPIPE)
        isClosed_ = true;
    else
        errorNumber_ = errno;
}

} // namespace isoslider::cli
