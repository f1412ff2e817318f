#pragma once

#include <cstddef>

namespace isoslider::extract {

/// Lines of memory that will be read soon, to be asked for a part at a time between other work: the processor waits
/// with a request when too many are on their way.
class LinesAhead {
public:
    LinesAhead() = default;
    LinesAhead(const void* from, std::size_t bytes)
        : at_(static_cast<const char*>(from)), left_(bytes), part_(wholeLines(bytes / kParts)) {}

    void fetchPart() { fetch(part_); }
    void fetchRest() { fetch(left_); }

private:
    static constexpr std::size_t kLine = 64, kParts = 4;
    static std::size_t wholeLines(std::size_t bytes) { return (bytes + kLine - 1) / kLine * kLine; }

    // Into the second cache: the first is full of what is worked on.
    void fetch(std::size_t bytes) {
        bytes = bytes < left_ ? bytes : left_;
        for (std::size_t line = 0; line < bytes; line += kLine)
            __builtin_prefetch(at_ + line, 0, 2);
        at_ += bytes;
        left_ -= bytes;
    }

    const char* at_ = nullptr;
    std::size_t left_ = 0, part_ = 0;
};

} // namespace isoslider::extract
