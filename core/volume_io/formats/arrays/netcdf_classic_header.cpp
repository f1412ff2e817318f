#include "core/volume_io/formats/arrays/netcdf_classic_header.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <vector>

namespace isoslider::io {
namespace {

constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kMaxName = 4000; ///< bytes; the library allows 256 characters

struct ClassicVariable {
    std::uint64_t begin = 0;
    std::uint64_t bytes = 0; ///< of all samples, or of one record
    bool isRecord = false;
};

std::uint64_t product(std::uint64_t a, std::uint64_t b) { return b != 0 && a > kNone / b ? kNone : a * b; }
std::uint64_t sum(std::uint64_t a, std::uint64_t b) { return a > kNone - b ? kNone : a + b; }
std::uint64_t padded(std::uint64_t bytes) { return sum(bytes, 3) / 4 * 4; }

std::uint64_t typeBytes(std::uint64_t type) {
    constexpr std::uint64_t kSizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    return type < std::size(kSizes) ? kSizes[type] : 0;
}

class HeaderWalk {
public:
    explicit HeaderWalk(const RandomAccessFile& file) : file_(file) {}

    Status run() {
        std::array<std::byte, 4> magic{};
        ISO_TRY(file_.readExactlyAt(0, magic));
        const auto version = std::to_integer<unsigned>(magic[3]);
        if (std::memcmp(magic.data(), "CDF", 3) != 0 || (version != 1 && version != 2 && version != 5))
            return {};
        countWidth_ = version == 5 ? 8 : 4;
        offsetWidth_ = version == 1 ? 4 : 8;
        at_ = 4;
        records_ = number(countWidth_);
        dimensions();
        attributes();
        variables();
        if (problem_ != nullptr)
            return makeError(ErrorCode::Corruption, std::string("header: ") + problem_, file_.path(), at_);
        return checkVariables();
    }

private:
    std::uint64_t number(std::uint64_t width) {
        if (at_ < windowBegin_ || at_ + width > windowBegin_ + window_.size()) {
            windowBegin_ = at_;
            window_.resize(std::size_t{1} << 14);
            const auto got = file_.readAt(at_, window_);
            window_.resize(got.isOk() ? got.value() : 0);
        }
        if (window_.size() < width || problem_ != nullptr)
            return fail("the file ends within it");
        std::uint64_t value = 0;
        for (std::uint64_t i = 0; i < width; ++i)
            value = value << 8 | std::to_integer<std::uint64_t>(window_[at_ - windowBegin_ + i]);
        at_ += width;
        return value;
    }
    std::uint64_t fail(const char* problem) {
        if (problem_ == nullptr)
            problem_ = problem;
        return 0;
    }
    void skip(std::uint64_t bytes) {
        if (bytes > file_.sizeBytes() - std::min(at_, file_.sizeBytes()))
            fail("a name or value reaches beyond the end of the file");
        else
            at_ += bytes;
    }
    void name() {
        const std::uint64_t size = number(countWidth_);
        if (size > kMaxName)
            fail("a name is too long");
        skip(padded(size));
    }
    /// How many elements a list has, each of `leastBytes` or more.
    std::uint64_t list(std::uint64_t tag, std::uint64_t leastBytes) {
        const std::uint64_t found = number(4), count = number(countWidth_);
        if (found != tag && (found != 0 || count != 0))
            return fail("a list is not of the kind that belongs there");
        if (count > file_.sizeBytes() / leastBytes)
            return fail("a list is longer than the file");
        return count;
    }
    void dimensions() {
        const std::uint64_t count = list(10, 8);
        for (std::uint64_t i = 0; i < count && problem_ == nullptr; ++i) {
            name();
            extents_.push_back(number(countWidth_));
        }
    }
    void attributes() {
        const std::uint64_t count = list(12, 12);
        for (std::uint64_t i = 0; i < count && problem_ == nullptr; ++i) {
            name();
            const std::uint64_t size = typeBytes(number(4));
            if (size == 0)
                fail("an attribute is of no known type");
            skip(padded(product(number(countWidth_), size)));
        }
    }
    void variables() {
        const std::uint64_t count = list(11, 24);
        for (std::uint64_t i = 0; i < count && problem_ == nullptr; ++i) {
            ClassicVariable variable;
            name();
            const std::uint64_t rank = number(countWidth_);
            if (rank > 1024)
                fail("a variable has too many dimensions");
            std::uint64_t samples = 1;
            for (std::uint64_t axis = 0; axis < rank && problem_ == nullptr; ++axis) {
                const std::uint64_t id = number(countWidth_);
                if (id >= extents_.size())
                    fail("a variable has a dimension that is not there");
                else if (axis == 0 && extents_[id] == 0)
                    variable.isRecord = true;
                else
                    samples = product(samples, extents_[id]);
            }
            attributes();
            const std::uint64_t size = typeBytes(number(4));
            if (size == 0)
                fail("a variable is of no known type");
            number(countWidth_); // its size, which is too large for the field where that is small
            variable.begin = number(offsetWidth_);
            variable.bytes = product(samples, size);
            variables_.push_back(variable);
        }
    }

    Status checkVariables() const {
        std::uint64_t recordBytes = 0, records = 0;
        for (const ClassicVariable& variable : variables_)
            if (variable.isRecord) {
                recordBytes = sum(recordBytes, padded(variable.bytes));
                ++records;
            }
        for (const ClassicVariable& variable : variables_) {
            if (variable.isRecord && records == 1)
                recordBytes = variable.bytes; // records of one variable alone are not padded
            std::uint64_t bytes = variable.bytes;
            if (variable.isRecord)
                bytes = records_ == 0 ? 0 : sum(product(records_ - 1, recordBytes), bytes);
            if (sum(variable.begin, bytes) > std::max(file_.sizeBytes(), bytes == 0 ? kNone : 0))
                return makeError(ErrorCode::Corruption,
                                 "file ends early: a variable takes " + std::to_string(bytes) + " bytes from " +
                                     std::to_string(variable.begin) + " on, the file has only " +
                                     std::to_string(file_.sizeBytes()),
                                 file_.path(), variable.begin);
        }
        return {};
    }

    const RandomAccessFile& file_;
    std::vector<std::byte> window_;
    std::uint64_t windowBegin_ = 0, at_ = 0;
    std::uint64_t countWidth_ = 4, offsetWidth_ = 4, records_ = 0;
    std::vector<std::uint64_t> extents_;
    std::vector<ClassicVariable> variables_;
    const char* problem_ = nullptr;
};

} // namespace

Status checkClassicNetcdf(const RandomAccessFile& file) { return HeaderWalk(file).run(); }

} // namespace isoslider::io
