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
    static constexpr int kPointBits = 41; // at most kMaxPoints of them
    static constexpr std::uint64_t kInside = 6, kVertex = 7;
    Cause(Point point, std::uint64_t code) : bits_(point | code << kPointBits) {}
    std::uint64_t code() const { return bits_ >> kPointBits; }
    std::uint64_t bits_ = 0;
};

/// A change of the surface's Euler number where the isovalue rises beyond `isovalue`.
struct EulerChange {
    double isovalue;
    Cause cause;
    std::int32_t euler;
};

} // namespace isoslider::topology
