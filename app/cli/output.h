#pragma once

#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.h"

namespace isoslider::cli {

/// JSON with its keys in the order they were set: the order of the documentation.
using Json = nlohmann::ordered_json;

/// One line of JSON. Bytes that are not UTF-8 become U+FFFD; a number that is not finite becomes null.
std::string jsonText(const Json& value);

/// Standard output. A reader that has gone away (EPIPE) is no failure: writing on does nothing.
class Output {
public:
    void write(std::string_view text);
    /// One object on a separate line.
    void writeJson(const Json& object);
    /// True when nobody reads any more.
    bool isClosed() const { return isClosed_; }
    /// Errors: IoError, OutOfSpace, for this or an earlier write that failed for another reason.
    Status flush();

private:
    void noteFailure();

    bool isClosed_ = false;
    int errorNumber_ = 0;
};

} // namespace isoslider::cli
