#include "core/topology/analysis/layer_euler.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "core/grid/scalar_type.h"
#include "core/topology/analysis/cell_discs.h"

namespace isoslider::topology {
namespace {

template <class Sample>
class LayerScan {
public:
    explicit LayerScan(const LayerWindow<Sample>& window)
        : window_(window),
          nx_(window.dims[0]),
          row_(window.rowStep()),
          plane_(window.planeStep()),
          low_(static_cast<std::size_t>(nx_)),
          high_(low_.size()),
          level_(low_.size()),
          isAmbiguous_(low_.size()),
          atPoints_(static_cast<std::size_t>(window.points())) {}

    LayerChanges run() {
        for (std::int64_t z = window_.zBegin; z < window_.ownedEnd(); ++z)
            for (std::int64_t y = 0; y < window_.dims[1]; ++y)
                scanPoints(y, z);
        for (std::int64_t z = window_.zBegin; z < window_.zEnd; ++z)
            for (std::int64_t y = 0; y + 1 < window_.dims[1]; ++y)
                scanCells(y, z);
        gather();
        return std::move(found_);
    }

private:
    std::int64_t placeOf(std::int64_t y, std::int64_t z) const { return row_ * y + plane_ * (z - window_.zBegin); }

    void note(std::int64_t at, int euler) {
        auto& sum = atPoints_[static_cast<std::size_t>(at)];
        sum = static_cast<std::int16_t>(sum + euler);
    }

    // Saddles of a face are found by both its cells, and mostly cancel out; so does much among equal samples.
    void gather() {
        for (std::size_t at = 0; at < atPoints_.size(); ++at)
            if (atPoints_[at] != 0)
                found_.euler.push_back({static_cast<double>(window_.layer()[at]),
                                        Cause::vertex(window_.firstPoint() + at), atPoints_[at]});
        std::sort(found_.euler.begin(), found_.euler.end(), [](const EulerChange& a, const EulerChange& b) {
            return std::tuple(a.isovalue, a.cause.isVertex(), -std::abs(a.euler), a.cause) <
                   std::tuple(b.isovalue, b.cause.isVertex(), -std::abs(b.euler), b.cause);
        });
        std::size_t kept = 0;
        for (std::size_t first = 0, next = 0; first < found_.euler.size(); first = next) {
            EulerChange sum = found_.euler[first]; // at the place that most is due to
            for (next = first + 1; next < found_.euler.size() && found_.euler[next].isovalue == sum.isovalue &&
                                   found_.euler[next].cause.isVertex() == sum.cause.isVertex();
                 ++next)
                sum.euler += found_.euler[next].euler;
            if (sum.euler != 0)
                found_.euler[kept++] = sum;
        }
        found_.euler.resize(kept);
        found_.euler.shrink_to_fit();
    }

    // ---- grid points

    void scanPoints(std::int64_t y, std::int64_t z) {
        if (window_.stop.stop_requested())
            return;
        const std::int64_t start = placeOf(y, z);
        const CellStar* const stars = window_.stars.data() + start;
        const bool isInner = y > 0 && y + 1 < window_.dims[1] && z > 0 && z + 1 < window_.dims[2];
        if (isInner)
            compareNeighbours(window_.layer() + start);
        const NeighbourTable& table = NeighbourTable::get();
        for (std::int64_t x = 0; x < nx_; ++x) {
            const auto i = static_cast<std::size_t>(x);
            if (isInner && stars[x] == kWholeStar)
                note(start + x, table.change(low_[i], level_[i], high_[i]));
            else if (stars[x] != 0)
                note(start + x, changeAt(start + x, stars[x]));
        }
    }

    // Which neighbours of a row's points are higher; of equal ones the later one is. Ends of the row are left out.
    void compareNeighbours(const Sample* row) {
        for (std::uint16_t* bits : {low_.data(), level_.data(), high_.data()})
            std::fill_n(bits, nx_, std::uint16_t{0});
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const int place = dx + 1 + 3 * (dy + 1);
                const Sample* const next = row + dx + row_ * dy;
                const auto bit = static_cast<std::uint16_t>(1u << place);
                compareRow<false>(row, next - plane_, bit, low_.data());
                compareRow<true>(row, next + plane_, bit, high_.data());
                if (place < 4)
                    compareRow<false>(row, next, bit, level_.data());
                else if (place > 4)
                    compareRow<true>(row, next, static_cast<std::uint16_t>(bit >> 1), level_.data());
            }
    }
    template <bool IsLater>
    void compareRow(const Sample* row, const Sample* other, std::uint16_t bit, std::uint16_t* bits) const {
        for (std::int64_t x = 1; x < nx_ - 1; ++x) {
            const bool isHigher = IsLater ? other[x] >= row[x] : other[x] > row[x];
            bits[x] = static_cast<std::uint16_t>(bits[x] | (isHigher ? bit : 0));
        }
    }

    bool isHigher(std::int64_t other, std::int64_t than) const {
        const Sample *const layer = window_.layer(), a = layer[other], b = layer[than];
        return a > b || (a == b && other > than);
    }

    // The same without a table, where cells are missing: vertices less segments plus discs.
    int changeAt(std::int64_t at, CellStar star) const {
        const std::array<std::int64_t, 6> steps{-1, 1, -row_, row_, -plane_, plane_};
        std::array<int, 6> side{};
        int change = 0;
        for (std::size_t d = 0; d < 6; ++d)
            if ((star & kStarSides[d]) != 0) {
                side[d] = isHigher(at + steps[d], at) ? 1 : -1;
                change += side[d];
            }
        for (std::size_t d = 0; d < 4; ++d)
            for (std::size_t e = d / 2 * 2 + 2; e < 6; ++e)
                if ((star & kStarSides[d] & kStarSides[e]) != 0)
                    change -= (side[d] + side[e]) / 2;
        const auto& discs = discsBySigns();
        for (unsigned cell = 0; cell < 8; ++cell)
            if ((star >> cell & 1u) != 0) {
                const unsigned own = 7 - cell;
                const std::int64_t first = at - offsetOf(own);
                unsigned signs = 0;
                for (unsigned c = 0; c < 8; ++c)
                    signs |= (c != own && isHigher(first + offsetOf(c), at) ? 1u : 0u) << c;
                change += discs[signs] - discs[signs | 1u << own];
            }
        return change;
    }

    std::int64_t offsetOf(unsigned corner) const {
        return static_cast<std::int64_t>(corner & 1) + row_ * static_cast<std::int64_t>(corner >> 1 & 1) +
               plane_ * static_cast<std::int64_t>(corner >> 2);
    }

    // ---- cells that are ambiguous at some isovalue

    void scanCells(std::int64_t y, std::int64_t z) {
        const std::int64_t start = placeOf(y, z);
        findAmbiguous(window_.layer() + start);
        for (std::int64_t x = 0; x + 1 < nx_; ++x)
            if (isAmbiguous_[static_cast<std::size_t>(x)] != 0 && !window_.stop.stop_requested() &&
                (window_.stars[static_cast<std::size_t>(start + x)] & 0x80) != 0)
                addCell(start + x);
    }

    // Two corners opposite each other on a face, or in the cell, above all others there.
    void findAmbiguous(const Sample* row) {
        const std::array<std::int64_t, 8> to{offsetOf(0), offsetOf(1), offsetOf(2), offsetOf(3),
                                             offsetOf(4), offsetOf(5), offsetOf(6), offsetOf(7)};
        for (std::int64_t x = 0; x + 1 < nx_; ++x) {
            const Sample* const p = row + x;
            std::array<Sample, 8> s;
            for (std::size_t c = 0; c < 8; ++c)
                s[c] = p[to[c]];
            const auto isSaddle = [&](Sample a, Sample c, Sample b, Sample d) {
                return static_cast<int>(std::min(a, c) > std::max(b, d)) |
                       static_cast<int>(std::min(b, d) > std::max(a, c));
            };
            int found = isSaddle(s[0], s[3], s[1], s[2]) | isSaddle(s[4], s[7], s[5], s[6]) |
                        isSaddle(s[0], s[5], s[1], s[4]) | isSaddle(s[2], s[7], s[3], s[6]) |
                        isSaddle(s[0], s[6], s[2], s[4]) | isSaddle(s[1], s[7], s[3], s[5]);
            std::array<Sample, 4> least, most;
            for (std::size_t d = 0; d < 4; ++d) {
                least[d] = std::min(s[d], s[7 - d]);
                most[d] = std::max(s[d], s[7 - d]);
            }
            for (std::size_t d = 0; d < 4; ++d) {
                const std::size_t i = (d + 1) % 4, j = (d + 2) % 4, k = (d + 3) % 4;
                found |= static_cast<int>(least[d] > std::max(std::max(most[i], most[j]), most[k])) |
                         static_cast<int>(most[d] < std::min(std::min(least[i], least[j]), least[k]));
            }
            isAmbiguous_[static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(found);
        }
    }

    void addCell(std::int64_t first) {
        const Sample* const layer = window_.layer();
        cell::CornerScalars scalars{};
        std::array<std::int64_t, 8> corners{};
        for (unsigned c = 0; c < 8; ++c) {
            corners[c] = first + offsetOf(c);
            scalars[c] = static_cast<double>(layer[corners[c]]);
        }
        history_.find(scalars);
        // What the table took for granted is taken back.
        const auto& discs = discsBySigns();
        for (unsigned own = 0; own < 8; ++own) {
            unsigned signs = 0;
            for (unsigned c = 0; c < 8; ++c)
                signs |= (c != own && isHigher(corners[c], corners[own]) ? 1u : 0u) << c;
            note(corners[own], history_.eulerAtCorners()[own] - (discs[signs] - discs[signs | 1u << own]));
        }
        const Point cell = window_.firstPoint() + static_cast<Point>(first);
        for (const CellSaddle& saddle : history_.saddles())
            if (saddle.euler != 0)
                found_.euler.push_back({saddle.isovalue, Cause::saddle(cell, saddle.face), saddle.euler});
        for (const CellJoin& join : history_.joins()) {
            Cause cause = Cause::saddle(cell, join.face);
            for (unsigned c = 0; c < 8; ++c)
                if (scalars[c] == join.isovalue)
                    cause = Cause::vertex(window_.firstPoint() + static_cast<Point>(corners[c]));
            (join.isOfAbove ? found_.above : found_.below)
                .push_back({join.isovalue, corners[join.corners[0]], corners[join.corners[1]], cause,
                            join.face >= 0 && isBoundaryFace(corners, join.face)});
        }
    }

    // Whether no cell lies beyond a face: by the star of one of its corners.
    bool isBoundaryFace(const std::array<std::int64_t, 8>& corners, int face) const {
        const auto side = static_cast<unsigned>(face);
        const unsigned axis = side / 2, corner = (side & 1u) << axis; // a corner of the face; the cell's others lie up
        const CellStar star = window_.stars[static_cast<std::size_t>(corners[corner])];
        // The cell is upwards of that corner along the other axes; beyond the face it is the opposite along this one.
        const unsigned beyond = (7u & ~(1u << axis)) | ((side & 1u) << axis);
        return (star >> beyond & 1u) == 0;
    }

    const LayerWindow<Sample>& window_;
    std::int64_t nx_, row_, plane_;
    std::vector<std::uint16_t> low_, high_, level_;
    std::vector<std::uint8_t> isAmbiguous_;
    std::vector<std::int16_t> atPoints_; ///< what the Euler number changes by where the isovalue rises beyond each
    CellHistory history_;
    LayerChanges found_;
};

} // namespace

template <class Sample>
LayerChanges findLayerChanges(const LayerWindow<Sample>& window) {
    return LayerScan<Sample>(window).run();
}

#define ISO_INSTANTIATE(Sample, Name) template LayerChanges findLayerChanges(const LayerWindow<Sample>&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
