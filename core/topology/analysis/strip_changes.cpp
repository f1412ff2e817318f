#include "core/topology/analysis/strip_changes.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/grid/scalar_type.h"
#include "core/topology/analysis/body_saddles.h"
#include "core/topology/analysis/cell_codes.h"
#include "core/topology/analysis/euler_sums.h"
#include "core/topology/cell_saddles.h"

namespace isoslider::topology {
namespace {

// Near a grid point each cell is linear: its surface there is a disc around the point where all three neighbours are on
// the other side, and passes by as one disc or not at all where they differ or are on the same.
int cellChange(int higherNeighbours) { return higherNeighbours == 3 ? 1 : higherNeighbours == 0 ? -1 : 0; }

// By the cells around an edge: where two of them have no more than the edge in common the surface would only touch
// itself, and extraction makes a vertex for each.
int verticesOnEdge(CellStar around) {
    if (std::popcount(around) != 2)
        return around != 0 ? 1 : 0;
    const int first = std::countr_zero(around), last = std::bit_width(around) - 1;
    return std::popcount(static_cast<unsigned>(first ^ last)) == 2 ? 2 : 1;
}

// What the surface's Euler number changes by where the isovalue rises beyond a grid point: vertices less segments plus
// discs. `higher`: bit of each neighbour that is; neighbours in the order of kStarSides.
int pointChange(CellStar star, unsigned higher) {
    int change = 0;
    const auto side = [&](std::size_t d) { return (higher >> d & 1u) != 0 ? 1 : -1; };
    for (std::size_t d = 0; d < 6; ++d)
        change += side(d) * verticesOnEdge(star & kStarSides[d]);
    for (std::size_t d = 0; d < 4; ++d)
        for (std::size_t e = d / 2 * 2 + 2; e < 6; ++e)
            if ((star & kStarSides[d] & kStarSides[e]) != 0)
                change -= (side(d) + side(e)) / 2;
    for (unsigned cell = 0; cell < 8; ++cell)
        if ((star >> cell & 1u) != 0)
            change +=
                cellChange(static_cast<int>((higher >> (cell & 1u) & 1u) + (higher >> (2 + (cell >> 1 & 1u)) & 1u) +
                                            (higher >> (4 + (cell >> 2)) & 1u)));
    return change;
}

// Of points with eight cells.
const std::array<std::int8_t, 64>& wholeStarChanges() {
    static const std::array<std::int8_t, 64> table = [] {
        std::array<std::int8_t, 64> changes{};
        for (unsigned higher = 0; higher < 64; ++higher)
            changes[higher] = static_cast<std::int8_t>(pointChange(kWholeStar, higher));
        return changes;
    }();
    return table;
}

template <class Sample>
class StripScan {
public:
    StripScan(const LayerWindow<Sample>& window, const Strip& strip, StripSide& above, StripSide& below)
        : window_(window),
          strip_(strip),
          above_(above),
          below_(below),
          nx_(window.dims[0]),
          row_(window.rowStep()),
          plane_(window.planeStep()),
          codes_(static_cast<std::size_t>(nx_)),
          passedX_(0),
          passedY_(codes_.size()),
          passedZ_(static_cast<std::size_t>(window.points(strip))),
          sums_(window.points(strip) * (window.zEnd - window.zBegin + 1)) {}

    StripChanges run() {
        if (window_.zBegin > window_.firstPlane)
            passCellsBelow();
        for (std::int64_t z = window_.zBegin; z <= window_.zEnd && !window_.stop.stop_requested(); ++z) {
            if (z < window_.ownedEnd())
                for (std::int64_t y = strip_.yBegin; y < window_.ownedEnd(strip_); ++y)
                    scanPoints(y, z);
            if (z < window_.zEnd) {
                shift_ = window_.shift(strip_, z);
                passCellsBefore(z);
                for (std::int64_t y = strip_.yBegin; y < strip_.yEnd; ++y)
                    if (!window_.isFlat(y, z))
                        scanCells(y, z);
            }
        }
        found_.euler = sums_.take();
        return std::move(found_);
    }

private:
    std::int64_t placeOf(std::int64_t y, std::int64_t z) const { return row_ * y + plane_ * (z - window_.zBegin); }
    // Places count from the layer's first grid point; one plane before it is there, too.
    const std::uint8_t* edgesAt(std::int64_t place) const { return window_.higher.edges() + window_.inPlanes(place); }
    std::int64_t offsetOf(unsigned corner) const {
        return static_cast<std::int64_t>(corner & 1) + row_ * static_cast<std::int64_t>(corner >> 1 & 1) +
               plane_ * static_cast<std::int64_t>(corner >> 2);
    }
    std::size_t along(std::int64_t x) const { return static_cast<std::size_t>(x); }
    Point pointAt(std::int64_t place) const { return window_.firstPoint() + static_cast<Point>(place); }
    double scalarAt(std::int64_t place) const { return static_cast<double>(window_.layer()[place]); }
    bool isHigher(std::int64_t other, std::int64_t than) const {
        const Sample *const layer = window_.layer(), a = layer[other], b = layer[than];
        return a > b || (a == b && other > than);
    }

    // ---- grid points

    void scanPoints(std::int64_t y, std::int64_t z) {
        const std::int64_t start = placeOf(y, z);
        const CellStar* const stars = window_.stars.data() + start;
        const Sample* const samples = window_.layer() + start;
        const std::uint8_t* const edges = edgesAt(start);
        const auto& table = wholeStarChanges();
        for (std::int64_t x = 0; x < nx_; ++x) {
            if (stars[x] == 0)
                continue;
            sums_.addSample(samples[x], pointAt(start + x),
                            stars[x] == kWholeStar ? table[edges[x]] : pointChange(stars[x], edges[x]));
        }
    }

    // ---- cells that are ambiguous at some isovalue

    // Of a row of cells.
    void findCodes(std::int64_t start) {
        findCellCodes(window_.layer() + start, edgesAt(start), row_, plane_, nx_ - 1, codes_.data());
    }

    void loadCell(std::int64_t first) {
        for (unsigned c = 0; c < 8; ++c) {
            corners_[c] = first + offsetOf(c);
            scalars_[c] = scalarAt(corners_[c]);
        }
    }

    // What cells of the layer below add at its top faces, which are this layer's.
    void passCellsBelow() {
        for (std::int64_t y = strip_.yBegin; y < strip_.yEnd; ++y)
            if (!window_.isFlat(y, window_.zBegin))
                passRow(placeOf(y, window_.zBegin - 1), 5, plane_, 0x08, &passedZ_[along(row_ * (y - strip_.yBegin))]);
    }
    // The same of the strip before.
    void passCellsBefore(std::int64_t z) {
        std::fill(passedY_.begin(), passedY_.end(), std::int8_t{0});
        if (strip_.yBegin > 0 && !window_.isFlat(strip_.yBegin, z))
            passRow(placeOf(strip_.yBegin - 1, z), 3, row_, 0x20, passedY_.data());
    }
    // Of cells in a row that begins at `start`; `step`: to the points beyond the face; `before`: the cell on this side
    // of it in the star of such a point.
    void passRow(std::int64_t start, unsigned face, std::int64_t step, CellStar before, std::int8_t* passed) {
        findCodes(start);
        for (std::int64_t x = 0; x + 1 < nx_; ++x) {
            const unsigned code = codes_[along(x)];
            const CellStar star = window_.stars[along(start + x + step)];
            const bool areBothThere = (star & before) != 0 && (star & 0x80) != 0;
            if ((code >> face & 1u) == 0 || !areBothThere)
                continue;
            loadCell(start + x);
            if (saddles_.find(scalars_, code & kSaddleFaces, (code & kMayHaveInner) != 0))
                passed[x] = static_cast<std::int8_t>(saddles_.eulerAtFace(static_cast<int>(face)));
        }
    }

    void scanCells(std::int64_t y, std::int64_t z) {
        const std::int64_t start = placeOf(y, z);
        findCodes(start);
        const CellStar* const stars = window_.stars.data() + start;
        passedX_ = 0;
        for (std::int64_t x = 0; x + 1 < nx_; ++x)
            if (codes_[along(x)] != 0 && (stars[x] & 0x80) != 0)
                addCell(start + x, x, x + row_ * (y - strip_.yBegin), codes_[along(x)]);
    }

    // Of a corner of the present cell, in its strip.
    std::int64_t inStrip(unsigned corner) const {
        return corners_[corner] - shift_ - static_cast<std::int64_t>(corner >> 2) * (plane_ - window_.points(strip_));
    }

    // `x`, `inPlane`: where what is passed to the next cells along y and z is kept.
    void addCell(std::int64_t first, std::int64_t x, std::int64_t inPlane, unsigned code) {
        loadCell(first);
        const bool isCertain = saddles_.find(scalars_, code & kSaddleFaces, (code & kMayHaveInner) != 0);
        if (isCertain) {
            for (const BodySaddle& saddle : saddles_.inner())
                addInner(saddle);
        } else {
            addHistory();
        }
        const std::array<std::int8_t*, 3> passed{&passedX_, &passedY_[along(x)], &passedZ_[along(inPlane)]};
        for (unsigned faces = code & kSaddleFaces; faces != 0; faces &= faces - 1) {
            const auto face = static_cast<unsigned>(std::countr_zero(faces));
            const int own = isCertain ? saddles_.eulerAtFace(static_cast<int>(face)) : 0;
            std::int8_t& other = *passed[face / 2];
            if (face % 2 == 0)
                addFace(face, own + std::exchange(other, std::int8_t{0}), isBoundaryFace(face));
            else if (isBoundaryFace(face))
                addFace(face, own, true);
            else
                other = static_cast<std::int8_t>(own);
        }
    }

    // A saddle at the scalar of a corner is that corner's.
    const std::int64_t* cornerWith(double isovalue) const {
        for (unsigned c = 0; c < 8; ++c)
            if (scalars_[c] == isovalue)
                return &corners_[c];
        return nullptr;
    }
    Cause causeAt(double isovalue, int face) const {
        const std::int64_t* const corner = cornerWith(isovalue);
        return corner != nullptr ? Cause::vertex(pointAt(*corner)) : Cause::saddle(pointAt(corners_[0]), face);
    }
    void addEuler(double isovalue, int face, int euler) {
        if (const std::int64_t* const corner = cornerWith(isovalue))
            sums_.addSample(window_.layer()[*corner], pointAt(*corner), euler);
        else
            sums_.addSaddle(isovalue, Cause::saddle(pointAt(corners_[0]), face), euler);
    }

    void addInner(const BodySaddle& saddle) {
        addEuler(saddle.isovalue, saddle.face, saddle.euler());
        StripSide& side = saddle.isOfAbove ? above_ : below_;
        const std::int64_t a = inStrip(saddle.corners[0]), b = inStrip(saddle.corners[1]);
        if (saddle.face < 0 && side.areApart(a, b))
            side.join(saddle.isovalue, causeAt(saddle.isovalue, -1), a, b);
    }

    // Once for both cells: where one has a disc more and the other one less nothing changes.
    void addFace(unsigned face, int euler, bool isBoundary) {
        const auto& f = cell::kFaceCorners[face];
        const bool isFirstUp = isHigher(corners_[f[0]], corners_[f[1]]);
        const std::size_t up = isFirstUp ? 0 : 1;
        const std::array<unsigned, 4> at{f[up], f[up + 1], f[up + 2], f[(up + 3) % 4]};
        const double a = scalars_[at[0]], b = scalars_[at[1]], c = scalars_[at[2]], d = scalars_[at[3]];
        if (!(std::min(a, c) > std::max(b, d))) { // equal corners: joined along edges as soon as they are there
            addEuler(std::max(b, d), static_cast<int>(face), euler);
            return;
        }
        const std::array<std::int64_t, 4> places{inStrip(at[0]), inStrip(at[1]), inStrip(at[2]), inStrip(at[3])};
        const bool joinsAbove = above_.areApart(places[0], places[2]),
                   joinsBelow = below_.areApart(places[1], places[3]);
        if (euler == 0 && !joinsAbove && !joinsBelow && !isBoundary)
            return;
        const double isovalue = cell::lastJoined(a, b, c, d);
        addEuler(isovalue, static_cast<int>(face), euler);
        const Cause cause = causeAt(isovalue, static_cast<int>(face));
        if (joinsAbove)
            above_.join(isovalue, cause, places[0], places[2]);
        if (joinsBelow)
            below_.join(isovalue, cause, places[1], places[3]);
        if (isBoundary) {
            const auto pointOf = [this](unsigned corner) { return pointAt(corners_[corner]); };
            found_.boundaryAbove.push_back({isovalue, cause, {pointOf(at[0]), pointOf(at[2])}});
            found_.boundaryBelow.push_back({isovalue, cause, {pointOf(at[1]), pointOf(at[3])}});
        }
    }

    // State by state, where plain arithmetic leaves something open. Joins across faces are not asked for here.
    void addHistory() {
        history_.find(scalars_);
        for (unsigned own = 0; own < 8; ++own) {
            int higher = 0;
            for (unsigned axis = 0; axis < 3; ++axis)
                higher += isHigher(corners_[own ^ 1u << axis], corners_[own]) ? 1 : 0;
            sums_.addSample(window_.layer()[corners_[own]], pointAt(corners_[own]),
                            history_.eulerAtCorners()[own] - cellChange(higher));
        }
        for (const CellSaddle& saddle : history_.saddles())
            addEuler(saddle.isovalue, saddle.face, saddle.euler);
        for (const CellJoin& join : history_.joins())
            if (join.face < 0)
                (join.isOfAbove ? above_ : below_)
                    .join(join.isovalue, causeAt(join.isovalue, -1), inStrip(join.corners[0]),
                          inStrip(join.corners[1]));
    }

    // Whether no cell lies beyond a face: by the star of one of its corners.
    bool isBoundaryFace(unsigned face) const {
        const unsigned axis = face / 2, corner = (face & 1u) << axis; // a corner of the face; the cell's others lie up
        const CellStar star = window_.stars[along(corners_[corner])];
        // The cell is upwards of that corner along the other axes; beyond the face it is the opposite along this one.
        const unsigned beyond = (7u & ~(1u << axis)) | ((face & 1u) << axis);
        return (star >> beyond & 1u) == 0;
    }

    const LayerWindow<Sample>& window_;
    const Strip strip_;
    StripSide &above_, &below_;
    std::int64_t nx_, row_, plane_;
    std::int64_t shift_ = 0; ///< of the present cells' lower corners: LayerWindow::shift
    std::vector<CellCode> codes_; ///< of a row of cells
    // What cells add to the changes at their far faces, until the next cell takes it.
    std::int8_t passedX_;
    std::vector<std::int8_t> passedY_, passedZ_;
    std::array<std::int64_t, 8> corners_{}; ///< of the present cell
    cell::CornerScalars scalars_{};
    CellSaddles saddles_;
    CellHistory history_;
    EulerSums<Sample> sums_;
    StripChanges found_;
};

} // namespace

template <class Sample>
StripChanges findStripChanges(const LayerWindow<Sample>& window, const Strip& strip, StripSide& above,
                              StripSide& below) {
    return StripScan<Sample>(window, strip, above, below).run();
}

#define ISO_INSTANTIATE(Sample, Name) \
    template StripChanges findStripChanges(const LayerWindow<Sample>&, const Strip&, StripSide&, StripSide&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
