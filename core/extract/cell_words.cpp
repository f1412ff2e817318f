#include "core/extract/cell_words.h"

namespace isoslider::extract {
namespace {

constexpr std::uint64_t kColumn0 = 0x0101010101010101ull; // x = 0 of every row
constexpr std::uint64_t kNotColumn7 = 0x7f7f7f7f7f7f7f7full;

// Bits of a plane seen one step up along x (y): bit (x, y) is bit (x + 1, y) of `plane`, the last
// column (row) from the first of the brick beyond.
std::uint64_t stepX(std::uint64_t plane, std::uint64_t beyond) { return (plane >> 1 & kNotColumn7) | (beyond & kColumn0) << 7; }
std::uint64_t stepY(std::uint64_t plane, std::uint64_t beyond) { return plane >> 8 | beyond << 56; }

class Planes {
public:
    explicit Planes(const EdgeBitsAround& edges) : edges_(edges) {}

    // Plane z (0..8) of an axis' bits in the brick with offset k along x and y.
    std::uint64_t at(int axis, int z, int k = 0) const {
        const auto* bits = edges_[z < 8 ? k : k | 4];
        return bits ? (*bits)[axis][z & 7] : 0;
    }

private:
    const EdgeBitsAround& edges_;
};

} // namespace

BrickBits cellsWithEdges(const EdgeBitsAround& edges) {
    const Planes planes(edges);
    // Per plane: x edges at y and y + 1; y edges at x and x + 1. A cell has those of its own plane and
    // the next, and four z edges of its own.
    const auto flat = [&](int z) {
        const std::uint64_t x = planes.at(0, z), y = planes.at(1, z);
        return x | stepY(x, planes.at(0, z, 2)) | y | stepX(y, planes.at(1, z, 1));
    };
    BrickBits cells;
    std::uint64_t below = flat(0);
    for (int z = 0; z < 8; ++z) {
        const std::uint64_t above = flat(z + 1);
        const std::uint64_t rows = planes.at(2, z) | stepX(planes.at(2, z), planes.at(2, z, 1));
        const std::uint64_t rowsBeyond = planes.at(2, z, 2) | stepX(planes.at(2, z, 2), planes.at(2, z, 3));
        cells[z] = below | above | rows | stepY(rows, rowsBeyond);
        below = above;
    }
    return cells;
}

CornerWords cornersFromEdges(const EdgeBitsAround& active) {
    const Planes planes(active);
    // Signs of the points with x, y in 0..7 of a plane (near), and the same shifted to x + 1, y + 1 and
    // both, for planes 0..8.
    struct Plane {
        std::uint64_t near, right, up, upRight;
    };
    std::array<Plane, 9> signs;
    std::uint64_t first = 0; // sign of (0, 0, z)
    for (int z = 0; z < 8; ++z) {
        const std::uint64_t x = planes.at(0, z), y = planes.at(1, z);
        // Column x = 0: parity along y, one bit per row. Multiplying by the column adds up all rows
        // below; sums stay below 16, their lowest bit is the parity.
        std::uint64_t column = (y & kColumn0) * kColumn0;       // row r: y edges of rows 0..r
        column = ((column << 8) & kColumn0) ^ (first * kColumn0); // row r: sign of (0, r, z)
        // Rows: parity along x within each byte.
        std::uint64_t rows = x;
        rows ^= rows << 1 & 0xfefefefefefefefeull;
        rows ^= rows << 2 & 0xfcfcfcfcfcfcfcfcull;
        rows ^= rows << 4 & 0xf0f0f0f0f0f0f0f0ull;
        const std::uint64_t start = column * 0xff; // a whole byte of the row's first sign
        Plane& plane = signs[z];
        plane.right = rows ^ start;
        plane.near = (rows << 1 & 0xfefefefefefefefeull) ^ start;
        // Row y = 8, over the y edges that start in row 7; its point x = 8 over a y edge of the brick at +x.
        const std::uint64_t top = (plane.near ^ y) >> 56;
        const std::uint64_t corner = (plane.right >> 63) ^ (planes.at(1, z, 1) >> 56 & 1);
        plane.up = stepY(plane.near, top);
        plane.upRight = stepY(plane.right, top >> 1 | corner << 7);
        first ^= planes.at(2, z) & 1;
    }
    // Plane z = 8, over the z edges that start in plane 7, here and in the bricks at +x, +y and both.
    const std::uint64_t z7 = planes.at(2, 7), z7x = planes.at(2, 7, 1), z7y = planes.at(2, 7, 2), z7xy = planes.at(2, 7, 3);
    const Plane& last = signs[7];
    signs[8] = {last.near ^ z7, last.right ^ stepX(z7, z7x), last.up ^ stepY(z7, z7y), last.upRight ^ stepY(stepX(z7, z7x), stepX(z7y, z7xy))};

    CornerWords corners;
    for (int z = 0; z < 8; ++z)
        corners[z] = {signs[z].near,     signs[z].right,     signs[z].up,     signs[z].upRight,
                      signs[z + 1].near, signs[z + 1].right, signs[z + 1].up, signs[z + 1].upRight};
    return corners;
}

BrickBits impossibleCells(const EdgeBitsAround& active) {
    const Planes planes(active);
    // Parity round the faces that start at each point: across z, x and y.
    const auto acrossZ = [&](int z) {
        const std::uint64_t x = planes.at(0, z), y = planes.at(1, z);
        return x ^ stepY(x, planes.at(0, z, 2)) ^ y ^ stepX(y, planes.at(1, z, 1));
    };
    BrickBits cells;
    std::uint64_t below = acrossZ(0);
    for (int z = 0; z < 8; ++z) {
        const std::uint64_t above = acrossZ(z + 1);
        // k: the brick itself, or the next along x (1) or y (2).
        const auto acrossY = [&](int k) {
            const std::uint64_t zEdges = planes.at(2, z, k);
            return planes.at(0, z, k) ^ planes.at(0, z + 1, k) ^ zEdges ^ stepX(zEdges, planes.at(2, z, k | 1));
        };
        const auto acrossX = [&](int k) {
            const std::uint64_t zEdges = planes.at(2, z, k);
            return planes.at(1, z, k) ^ planes.at(1, z + 1, k) ^ zEdges ^ stepY(zEdges, planes.at(2, z, k | 2));
        };
        cells[z] = below | above | acrossY(0) | stepY(acrossY(0), acrossY(2)) | acrossX(0) | stepX(acrossX(0), acrossX(1));
        below = above;
    }
    return cells;
}

BrickBits mixedCells(const CornerWords& corners) {
    BrickBits cells;
    for (int z = 0; z < 8; ++z) {
        const auto& c = corners[z];
        const std::uint64_t any = c[0] | c[1] | c[2] | c[3] | c[4] | c[5] | c[6] | c[7];
        const std::uint64_t all = c[0] & c[1] & c[2] & c[3] & c[4] & c[5] & c[6] & c[7];
        cells[z] = any & ~all;
    }
    return cells;
}

} // namespace isoslider::extract
