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
    /// From now on write() goes to standard error: standard output is for data.
    void leaveStandardOutput() { isForData_ = true; }
    /// From now on write() does nothing, writeJson() does.
    void setSilent(bool isSilent) { isSilent_ = isSilent; }
    /// One object on a separate line.
    void writeJson(const Json& object);
    /// True when nobody reads any more.
    bool isClosed() const { return isClosed_; }
    /// Errors: IoError, OutOfSpace, for this or an earlier write that failed for another reason.
    Status flush();

private:
    void put(std::string_view text);
    void noteFailure();

    bool isClosed_ = false;
    bool isSilent_ = false;
    bool isForData_ = false;
    int errorNumber_ = 0;
};

} // namespace isoslider::cli
