#pragma once

#include <cstdint>

namespace isoslider::topology {

/// A grid point, in an order with x fastest.
using Point = std::uint64_t;

/// Why something changes: a grid point, the saddle of a face of a cell, or a saddle inside the cell. 8 bytes.
class Cause {
public:
    Cause() = default;
    static Cause vertex(Point point) { return Cause(point, kVertex); }
    /// `face` 0 to 5 (core/cell/cell_numbering.h); below 0 the inside. A cell is named by its first point.
    static Cause saddle(Point cell, int face) {
        return Cause(cell, face < 0 ? kInside : static_cast<std::uint64_t>(face));
    }

    bool isVertex() const { return code() == kVertex; }
    bool isInside() const { return code() == kInside; }
    int face() const { return static_cast<int>(code()); }
    Point point() const { return bits_ & ((Point{1} << kPointBits) - 1); }
    friend auto operator<=>(const Cause&, const Cause&) = default;

private:
    friend class EulerChange;
    static constexpr int kPointBits = 41; // at most kMaxPoints of them
    static constexpr std::uint64_t kInside = 6, kVertex = 7;
    explicit Cause(std::uint64_t bits) : bits_(bits) {}
    Cause(Point point, std::uint64_t code) : bits_(point | code << kPointBits) {}
    std::uint64_t code() const { return bits_ >> kPointBits; }
    std::uint64_t bits_ = 0;
};

/// A change of the surface's Euler number where the isovalue rises beyond `isovalue`. 16 bytes.
class EulerChange {
public:
    static constexpr std::int64_t kMost = (1 << 19) - 1; ///< either way; larger changes are several

    EulerChange() = default;
    EulerChange(double at, Cause cause, std::int64_t euler)
        : isovalue(at), bits_(cause.bits_ | static_cast<std::uint64_t>(euler) << kCauseBits) {}

    Cause cause() const { return Cause(bits_ & ((std::uint64_t{1} << kCauseBits) - 1)); }
    std::int64_t euler() const { return static_cast<std::int64_t>(bits_) >> kCauseBits; }

    double isovalue = 0.0;

private:
    static constexpr int kCauseBits = 44;
    std::uint64_t bits_ = 0;
};
static_assert(sizeof(EulerChange) == 16);

} // namespace isoslider::topology
