#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>

#include "core/base/file_system.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {

inline constexpr std::size_t kMaxScannedWord = 64; ///< a sample in text is shorter

/// Walks a file of text lines with runs of samples between them, holding a window of it.
class TextScanner {
public:
    explicit TextScanner(const RandomAccessFile& file) : file_(file) {}

    const std::filesystem::path& path() const { return file_.path(); }
    std::uint64_t position() const { return windowBegin_ + at_; }
    std::uint64_t remaining() const { return file_.sizeBytes() - std::min(position(), file_.sizeBytes()); }
    void moveTo(std::uint64_t position) {
        windowBegin_ = position;
        window_.clear();
        at_ = 0;
    }

    /// The next line, without its end; at most kMaxHeaderLine bytes of it. False at the end.
    bool line(std::string& out) {
        out.clear();
        while (true) {
            if (at_ == window_.size() && !fill())
                return !out.empty();
            const char c = window_[at_++];
            if (c == '\n')
                return true;
            if (out.size() < kMaxHeaderLine)
                out += c;
        }
    }

    /// The next line that is not blank.
    bool textLine(std::string& out) {
        while (line(out))
            if (!trimmed(out).empty())
                return true;
        return false;
    }

    /// The next word between blanks; at most kMaxScannedWord + 1 bytes of it. False at the end.
    bool word(std::string& out) {
        out.clear();
        while (at_ < window_.size() || fill()) {
            const char c = window_[at_];
            const bool isBlank = c == ' ' || c == '\n' || c == '\t' || c == '\r';
            if (isBlank && !out.empty())
                return true;
            ++at_;
            if (!isBlank && out.size() <= kMaxScannedWord)
                out += c;
        }
        return !out.empty();
    }

private:
    bool fill() {
        windowBegin_ += window_.size();
        at_ = 0;
        window_.resize(std::size_t{1} << 16);
        const auto got = file_.readAt(windowBegin_, std::as_writable_bytes(std::span(window_)));
        window_.resize(got.isOk() ? got.value() : 0);
        return !window_.empty();
    }

    const RandomAccessFile& file_;
    std::string window_;
    std::uint64_t windowBegin_ = 0;
    std::size_t at_ = 0;
};

} // namespace isoslider::io
