#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace isoslider {

/// The state of an object, to be continued later by the same program on the same kind of machine: bytes as they lie in
/// memory, no format for others. One function `state(archive)` per class serves saving and loading, so that the two
/// cannot differ. Treats what it loads as untrusted in length, not in content: a checksum must stand around it.
class StateArchive {
public:
    /// Saves what it is given.
    StateArchive() = default;
    /// Loads into what it is given. `bytes` must outlive it.
    explicit StateArchive(std::span<const std::byte> bytes) : in_(bytes), isLoading_(true) {}

    bool isLoading() const { return isLoading_; }
    template <class Value>
    void operator()(Value& value) {
        static_assert(std::is_trivially_copyable_v<Value>);
        transfer(std::as_writable_bytes(std::span(&value, 1)));
    }
    template <class Value>
    void operator()(std::vector<Value>& values) {
        static_assert(std::is_trivially_copyable_v<Value>);
        std::size_t count = values.size();
        (*this)(count);
        if (isLoading_ && count > remaining() / sizeof(Value)) {
            hasFailed_ = true;
            count = 0;
        }
        if (isLoading_)
            values.resize(count);
        transfer(std::as_writable_bytes(std::span(values)));
    }
    /// Of a known number of values.
    template <class Value>
    void fixed(std::span<Value> values) {
        transfer(std::as_writable_bytes(values));
    }

    /// When loading: whether there was less than asked for.
    bool hasFailed() const { return hasFailed_; }
    std::size_t remaining() const { return in_.size() - at_; }
    const std::vector<std::byte>& bytes() const { return out_; }

private:
    void transfer(std::span<std::byte> bytes) {
        if (bytes.empty())
            return;
        if (!isLoading_) {
            out_.insert(out_.end(), bytes.begin(), bytes.end());
        } else if (remaining() < bytes.size()) {
            hasFailed_ = true;
            std::memset(bytes.data(), 0, bytes.size());
        } else {
            std::memcpy(bytes.data(), in_.data() + at_, bytes.size());
            at_ += bytes.size();
        }
    }

    std::vector<std::byte> out_;
    std::span<const std::byte> in_;
    std::size_t at_ = 0;
    bool isLoading_ = false;
    bool hasFailed_ = false;
};

} // namespace isoslider
