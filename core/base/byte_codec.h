#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace isoslider {

/// Little-endian whatever the machine: a structure is never written whole.
template <class Value>
inline void storeLittle(std::byte* out, Value value) {
    for (std::size_t i = 0; i < sizeof(Value); ++i)
        out[i] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i));
}

template <class Value>
inline Value loadLittle(const std::byte* in) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(Value); ++i)
        bits |= static_cast<std::uint64_t>(in[i]) << (8 * i);
    return static_cast<Value>(bits);
}

/// Appends fields to a buffer.
class ByteWriter {
public:
    explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}

    template <class Value>
    void put(std::type_identity_t<Value> value) {
        if constexpr (std::is_floating_point_v<Value>) {
            put<std::uint64_t>(std::bit_cast<std::uint64_t>(static_cast<double>(value)));
        } else {
            out_.resize(out_.size() + sizeof(Value));
            storeLittle<Value>(out_.data() + out_.size() - sizeof(Value), value);
        }
    }
    void putBytes(std::span<const std::byte> bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
    void putString(const std::string& text) {
        put<std::uint32_t>(static_cast<std::uint32_t>(text.size()));
        putBytes(std::as_bytes(std::span(text)));
    }

private:
    std::vector<std::byte>& out_;
};

/// Takes fields from a buffer; reading past its end gives zeros and `hasFailed()`.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::byte> in) : in_(in) {}

    template <class Value>
    Value get() {
        if constexpr (std::is_floating_point_v<Value>) {
            return static_cast<Value>(std::bit_cast<double>(get<std::uint64_t>()));
        } else {
            if (remaining() < sizeof(Value)) {
                hasFailed_ = true;
                return Value{};
            }
            const Value value = loadLittle<Value>(in_.data() + at_);
            at_ += sizeof(Value);
            return value;
        }
    }
    std::span<const std::byte> getBytes(std::size_t count) {
        if (remaining() < count) {
            hasFailed_ = true;
            return {};
        }
        at_ += count;
        return in_.subspan(at_ - count, count);
    }
    std::string getString(std::size_t maxBytes) {
        const std::size_t size = get<std::uint32_t>();
        if (size > maxBytes) {
            hasFailed_ = true;
            return {};
        }
        const auto bytes = getBytes(size);
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    std::size_t remaining() const { return in_.size() - at_; }
    bool hasFailed() const { return hasFailed_; }

private:
    std::span<const std::byte> in_;
    std::size_t at_ = 0;
    bool hasFailed_ = false;
};

} // namespace isoslider
