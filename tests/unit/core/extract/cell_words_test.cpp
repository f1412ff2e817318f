#include "core/extract/cell_words.h"

#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "core/cell/cell_numbering.h"

namespace isoslider::extract {
namespace {

using cell::CellEdge;
using cell::kCellEdges;

// Edge bits of a brick and of the seven above it, addressed by coordinates 0..15.
class Around {
public:
    void set(int axis, int x, int y, int z) {
        (*bits_)[static_cast<std::size_t>(x / 8 + 2 * (y / 8) + 4 * (z / 8))][static_cast<std::size_t>(axis)][static_cast<std::size_t>(z % 8)] |=
            std::uint64_t{1} << (x % 8 + 8 * (y % 8));
    }
    bool has(int axis, int x, int y, int z) const {
        const int k = x / 8 + 2 * (y / 8) + 4 * (z / 8);
        return view_[static_cast<std::size_t>(k)] &&
               ((*bits_)[static_cast<std::size_t>(k)][static_cast<std::size_t>(axis)][static_cast<std::size_t>(z % 8)] >> (x % 8 + 8 * (y % 8)) & 1);
    }
    /// `present`: bit k says that brick k is there.
    const EdgeBitsAround& view(unsigned present = 255) {
        for (std::size_t k = 0; k < 8; ++k)
            view_[k] = present >> k & 1 ? &(*bits_)[k] : nullptr;
        return view_;
    }

private:
    using Bits = std::array<std::array<BrickBits, 3>, 8>;
    std::unique_ptr<Bits> bits_ = std::make_unique<Bits>();
    EdgeBitsAround view_{};
};

bool hasBit(const BrickBits& bits, int x, int y, int z) { return bits[static_cast<std::size_t>(z)] >> (x + 8 * y) & 1; }

TEST(CellWords, FindsTheCellsOfAnyEdges) {
    std::mt19937 random(1);
    for (int round = 0; round < 200; ++round) {
        Around around;
        const unsigned share = 1u << (round % 10);
        for (int axis = 0; axis < 3; ++axis)
            for (int z = 0; z < 16; ++z)
                for (int y = 0; y < 16; ++y)
                    for (int x = 0; x < 16; ++x)
                        if (random() % share == 0)
                            around.set(axis, x, y, z);
        const BrickBits cells = cellsWithEdges(around.view(round % 3 ? 255 : random() % 256));
        for (int z = 0; z < 8; ++z)
            for (int y = 0; y < 8; ++y)
                for (int x = 0; x < 8; ++x) {
                    bool expected = false;
                    for (const CellEdge& edge : kCellEdges)
                        expected = expected || around.has(edge.axis, x + (edge.lowerCorner & 1), y + (edge.lowerCorner >> 1 & 1), z + (edge.lowerCorner >> 2));
                    ASSERT_EQ(hasBit(cells, x, y, z), expected) << "round " << round << ", cell " << x << " " << y << " " << z;
                }
    }
}

TEST(CellWords, RecoversCornersAndCasesFromActiveEdges) {
    std::mt19937 random(2);
    for (int round = 0; round < 200; ++round) {
        bool above[9][9][9];
        const unsigned share = 1 + random() % 8;
        for (auto& plane : above)
            for (auto& row : plane)
                for (bool& point : row)
                    point = random() % 8 < share;
        Around around;
        for (int z = 0; z < 9; ++z)
            for (int y = 0; y < 9; ++y)
                for (int x = 0; x < 9; ++x) {
                    if (x < 8 && above[z][y][x] != above[z][y][x + 1])
                        around.set(0, x, y, z);
                    if (y < 8 && above[z][y][x] != above[z][y + 1][x])
                        around.set(1, x, y, z);
                    if (z < 8 && above[z][y][x] != above[z + 1][y][x])
                        around.set(2, x, y, z);
                }
        const CornerWords corners = cornersFromEdges(around.view());
        const BrickBits mixed = mixedCells(corners);
        for (int z = 0; z < 8; ++z)
            for (int y = 0; y < 8; ++y)
                for (int x = 0; x < 8; ++x) {
                    unsigned expected = 0;
                    for (unsigned c = 0; c < 8; ++c)
                        expected |= static_cast<unsigned>(above[z + (c >> 2)][y + (c >> 1 & 1)][x + (c & 1)]) << c;
                    const auto cell = static_cast<LocalPoint>(x + 8 * y + 64 * z);
                    ASSERT_EQ(signsOfCell(corners, cell, above[0][0][0]), expected) << "round " << round << ", cell " << x << " " << y << " " << z;
                    ASSERT_EQ(signsOfCell(corners, cell, !above[0][0][0]), 255 - expected);
                    ASSERT_EQ(hasBit(mixed, x, y, z), expected != 0 && expected != 255);
                }
    }
}

TEST(CellWords, AbsentBricksHaveNoEdges) {
    const EdgeBitsAround none{};
    EXPECT_EQ(cellsWithEdges(none), BrickBits{});
    EXPECT_EQ(mixedCells(cornersFromEdges(none)), BrickBits{});
}

} // namespace
} // namespace isoslider::extract
