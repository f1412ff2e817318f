#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/base/result.h"

namespace isoslider::io {

/// One end of the connection between the program and its reader process: messages with their length before
/// them, and bytes without. Owns the descriptor. A vanished other end is an IoError, never a signal.
class MessageChannel {
public:
    explicit MessageChannel(int descriptor) : descriptor_(descriptor) {}
    ~MessageChannel();
    MessageChannel(const MessageChannel&) = delete;
    MessageChannel& operator=(const MessageChannel&) = delete;

    Status send(std::span<const std::byte> message);
    Status sendBytes(std::span<const std::byte> bytes);
    /// Called before more is taken; returns when there is some. Its error ends the receiving. Empty: waits for ever.
    using Wait = std::function<Status()>;
    /// Errors: IoError (the other end is gone, or announces more than kMaxMessageBytes), those of `wait`.
    Result<std::vector<std::byte>> receive(const Wait& wait = {});
    /// Waits until `out` is full.
    Status receiveBytes(std::span<std::byte> out, const Wait& wait = {});
    /// True when something can be received, or the other end has gone, within `milliseconds`.
    bool waitForInput(int milliseconds) const;

private:
    int descriptor_;
};

} // namespace isoslider::io
