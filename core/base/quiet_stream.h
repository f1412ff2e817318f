#pragma once

#include <ostream>
#include <streambuf>

namespace isoslider {

/// Swallows what is written to a standard stream for as long as it lives: for libraries that print
/// instead of only reporting. What other threads write to that stream meanwhile is lost too.
class QuietStream {
public:
    explicit QuietStream(std::ostream& stream) : stream_(stream), before_(stream.rdbuf(&nothing_)) {}
    ~QuietStream() { stream_.rdbuf(before_); }
    QuietStream(const QuietStream&) = delete;
    QuietStream& operator=(const QuietStream&) = delete;

private:
    struct Nothing final : std::streambuf {
        int_type overflow(int_type c) override { return traits_type::not_eof(c); }
    } nothing_;
    std::ostream& stream_;
    std::streambuf* before_;
};

} // namespace isoslider
