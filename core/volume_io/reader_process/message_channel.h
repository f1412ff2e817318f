#pragma once

#include <cstddef>
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
    /// Errors: IoError (the other end is gone, or announces more than kMaxMessageBytes).
    Result<std::vector<std::byte>> receive();
    /// Waits until `out` is full.
    Status receiveBytes(std::span<std::byte> out);
    /// True when something can be received, or the other end has gone, within `milliseconds`.
    bool waitForInput(int milliseconds) const;

private:
    int descriptor_;
};

} // namespace isoslider::io
