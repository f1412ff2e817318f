#include "core/volume_io/reader_process/message_channel.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "core/base/byte_codec.h"
#include "core/volume_io/reader_process/messages.h"

namespace isoslider::io {
namespace {

Error brokenChannel() { return makeError(ErrorCode::IoError, "the connection between program and reader broke"); }

} // namespace

MessageChannel::~MessageChannel() { ::close(descriptor_); }

Status MessageChannel::send(std::span<const std::byte> message) {
    if (message.size() > kMaxMessageBytes)
        return brokenChannel();
    std::array<std::byte, 4> length;
    storeLittle<std::uint32_t>(length.data(), static_cast<std::uint32_t>(message.size()));
    ISO_TRY(sendBytes(length));
    return sendBytes(message);
}

Status MessageChannel::sendBytes(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return brokenChannel();
        bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
    return {};
}

Result<std::vector<std::byte>> MessageChannel::receive(const Wait& wait) {
    std::array<std::byte, 4> length;
    ISO_TRY(receiveBytes(length, wait));
    const std::size_t size = loadLittle<std::uint32_t>(length.data());
    if (size > kMaxMessageBytes)
        return brokenChannel();
    std::vector<std::byte> message(size);
    ISO_TRY(receiveBytes(message, wait));
    return message;
}

Status MessageChannel::receiveBytes(std::span<std::byte> out, const Wait& wait) {
    while (!out.empty()) {
        if (wait)
            ISO_TRY(wait());
        const ssize_t got = ::recv(descriptor_, out.data(), out.size(), 0);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return brokenChannel();
        out = out.subspan(static_cast<std::size_t>(got));
    }
    return {};
}

bool MessageChannel::waitForInput(int milliseconds) const {
    pollfd waited{descriptor_, POLLIN, 0};
    return ::poll(&waited, 1, milliseconds) != 0;
}

} // namespace isoslider::io
