#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/byte_codec.h"
#include "core/base/result.h"

namespace isoslider::index {

// Columns of a page, cut into byte planes: all low bytes, then all second bytes, and so on. Each plane is
// one constant, as it is, or one zstd frame. A table of lengths and modes stands before the planes.

/// Appends plane table and planes to a page that holds its header.
class PlaneWriter {
public:
    /// Makes room for a table of `planes` entries at the end of `page`, which must outlive this.
    PlaneWriter(std::vector<std::byte>& page, int planes);

    /// REQUIRES: an unsigned type. All columns together have the number of planes stated above.
    template <class Value>
    void addColumn(const std::vector<Value>& values, int planes) {
        for (int p = 0; p < planes; ++p) {
            std::vector<std::uint8_t>& plane = beginPlane(values.size());
            for (std::size_t i = 0; i < values.size(); ++i)
                plane[i] = static_cast<std::uint8_t>(values[i] >> (8 * p));
            addPlane(plane);
        }
    }

    /// Whether each entry of the table has its plane.
    bool isComplete() const { return slot_ == planes_; }

private:
    static std::vector<std::uint8_t>& beginPlane(std::size_t size);
    void addPlane(const std::vector<std::uint8_t>& plane);
    void put(std::uint32_t mode, std::span<const std::byte> data);

    std::vector<std::byte>& page_;
    std::size_t tableAt_;
    int planes_;
    int slot_ = 0;
};

/// Reads them again; Treats input as untrusted.
class PlaneReader {
public:
    /// `path` (which must outlive this) and `offset` are only for messages.
    PlaneReader(std::span<const std::byte> page, const std::string& path,
                std::optional<std::uint64_t> offset = std::nullopt)
        : page_(page), path_(path), offset_(offset) {}

    Error corrupt(const char* field) const {
        return makeError(ErrorCode::Corruption, std::string("index page is damaged: ") + field, path_, offset_);
    }

    /// The table begins at byte `at` and has `count` entries. Errors here and below: Corruption.
    Status beginPlanes(std::size_t at, std::uint32_t count);

    /// One column of `planes` byte planes into `values`. REQUIRES: no more planes in all than the table has.
    template <class Value>
    Status readColumn(std::vector<Value>& values, std::size_t count, int planes) {
        values.assign(count, Value{0});
        for (int p = 0; p < planes; ++p) {
            Plane plane;
            ISO_TRY(readPlane(count, plane));
            Value* out = values.data();
            if (plane.bytes != nullptr) {
                for (std::size_t i = 0; i < count; ++i)
                    out[i] |= static_cast<Value>(static_cast<Value>(plane.bytes[i]) << (8 * p));
            } else if (plane.constant != 0) {
                for (std::size_t i = 0; i < count; ++i)
                    out[i] |= static_cast<Value>(static_cast<Value>(plane.constant) << (8 * p));
            }
        }
        return {};
    }

    bool isAtEnd() const { return dataAt_ == page_.size(); }

private:
    struct Plane {
        const std::uint8_t* bytes = nullptr; // until the thread reads the next one; null: all the same
        std::uint8_t constant = 0;
    };
    Status readPlane(std::size_t count, Plane& plane);

    std::span<const std::byte> page_;
    const std::string& path_;
    std::optional<std::uint64_t> offset_;
    std::size_t tableAt_ = 0;
    std::size_t dataAt_ = 0;
    std::size_t slot_ = 0;
};

} // namespace isoslider::index
