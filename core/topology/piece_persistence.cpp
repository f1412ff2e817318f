#include "core/topology/piece_persistence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/topology/cell_saddles.h"

namespace isoslider::topology {
namespace {

using GridPlace = std::array<std::int64_t, 3>;

/// The grid points that have been reached, by blocks.
class ReachedPoints {
public:
    explicit ReachedPoints(const GridDims& dims) {
        for (std::size_t axis = 0; axis < 2; ++axis)
            blocks_[axis] = (dims[axis] + kSide - 1) / kSide;
    }
    /// False if it was there already.
    bool add(const GridPlace& p) {
        const std::int64_t block = p[0] / kSide + blocks_[0] * (p[1] / kSide + blocks_[1] * (p[2] / kSide));
        if (bits_ == nullptr || block != block_) {
            block_ = block;
            bits_ = &reached_[block];
        }
        std::uint64_t& word = (*bits_)[static_cast<std::size_t>(p[2] % kSide)];
        const std::uint64_t bit = std::uint64_t{1} << (p[0] % kSide + kSide * (p[1] % kSide));
        const bool isNew = (word & bit) == 0;
        word |= bit;
        return isNew;
    }
    bool has(const GridPlace& p) {
        if (add(p)) {
            (*bits_)[static_cast<std::size_t>(p[2] % kSide)] &=
                ~(std::uint64_t{1} << (p[0] % kSide + kSide * (p[1] % kSide)));
            return false;
        }
        return true;
    }

private:
    static constexpr std::int64_t kSide = 8;
    using Bits = std::array<std::uint64_t, kSide>;
    std::array<std::int64_t, 2> blocks_{};
    std::unordered_map<std::int64_t, Bits> reached_; // its elements stay where they are
    std::int64_t block_ = 0;
    Bits* bits_ = nullptr;
};

/// A walk from one grid point through what its side's region is, then through what that joins, in the order of
/// isovalues met: Prim's algorithm on the graph of grid points, edges and joins in cells (TOPOLOGY.md). What is below
/// is walked with all scalars negated, so that a higher number comes earlier on either side.
class RegionWalk {
public:
    RegionWalk(index::SampleBlocks& samples, Side side, const GridPlace& start, double isovalue)
        : samples_(samples), side_(side), level_(signed_(isovalue)), reached_(samples.dims()) {
        reach(start);
        first_ = {heightOf(start), start};
    }

    /// Until `points` have been walked to in all, or the end is known.
    void advance(std::uint64_t points, const std::stop_token& stop) {
        while (!isDone_ && walked_ < points) {
            if ((walked_ & 0xfff) == 0 && stop.stop_requested())
                return;
            if (ready_.empty()) {
                joinNext();
                continue;
            }
            const GridPlace at = ready_.back();
            ready_.pop_back();
            ++walked_;
            if (const Extreme point{heightOf(at), at}; isEarlier(point, first_)) {
                if (isJoining_) {
                    isDone_ = true;
                    return;
                }
                first_ = point;
            }
            expand(at);
        }
    }

    bool isDone() const { return isDone_; }
    PiecePersistence result(const PersistenceOptions& options) const {
        PiecePersistence found;
        found.side = side_;
        found.isAtLeast = !isDone_;
        found.comes = signed_(first_.height);
        found.ends = signed_(level_);
        found.lasts = lasts_;
        const double span = std::min(options.greatest - options.least, std::numeric_limits<double>::max());
        found.persistence = lasts_ ? span : std::min(first_.height - level_, span);
        return found;
    }

private:
    struct Extreme {
        double height;
        GridPlace at;
    };
    struct Waiting {
        double height; ///< the greatest isovalue at which it is joined
        GridPlace at;
    };
    struct IsLater {
        bool operator()(const Waiting& a, const Waiting& b) const { return a.height < b.height; }
    };

    double signed_(double scalar) const { return side_ == Side::Above ? scalar : -scalar; }
    double heightOf(const GridPlace& p) const { return signed_(samples_.at(p[0], p[1], p[2])); }
    // Of equal ones that with the lower number is the elder, as in followComponents().
    static bool isEarlier(const Extreme& a, const Extreme& b) {
        return a.height != b.height ? a.height > b.height
                                    : std::tie(a.at[2], a.at[1], a.at[0]) < std::tie(b.at[2], b.at[1], b.at[0]);
    }
    // What is below the isovalue is so beyond it only: a sample of that scalar is above.
    bool isThere(double height) const {
        return side_ == Side::Below && !isJoining_ ? height > level_ : height >= level_;
    }

    void reach(const GridPlace& p) {
        if (reached_.add(p))
            ready_.push_back(p);
    }
    void link(const GridPlace& p, double height) {
        if (isThere(height))
            reach(p);
        else if (!reached_.has(p))
            waiting_.push({height, p});
    }
    void joinNext() {
        while (!waiting_.empty()) {
            const Waiting next = waiting_.top();
            waiting_.pop();
            if (!reached_.add(next.at))
                continue;
            isJoining_ = true;
            level_ = next.height;
            ready_.push_back(next.at);
            return;
        }
        lasts_ = isDone_ = true;
    }

    void expand(const GridPlace& at) {
        std::array<double, 27> around{};
        for (std::int64_t z = -1, i = 0; z <= 1; ++z)
            for (std::int64_t y = -1; y <= 1; ++y)
                for (std::int64_t x = -1; x <= 1; ++x, ++i)
                    around[static_cast<std::size_t>(i)] = samples_.at(at[0] + x, at[1] + y, at[2] + z);
        unsigned linked = 0; // neighbours along edges
        for (unsigned cell = 0; cell < 8; ++cell) { // that in whose corner `own` the point is
            const unsigned own = 7 - cell;
            const GridPlace low{static_cast<int>(cell & 1) - 1, static_cast<int>(cell >> 1 & 1) - 1,
                                static_cast<int>(cell >> 2) - 1};
            const auto placeOf = [&](unsigned corner) {
                return GridPlace{low[0] + (corner & 1), low[1] + (corner >> 1 & 1), low[2] + (corner >> 2)};
            };
            cell::CornerScalars scalars{};
            bool isWhole = true;
            for (unsigned corner = 0; corner < 8; ++corner) {
                const GridPlace p = placeOf(corner);
                scalars[corner] = around[static_cast<std::size_t>(p[0] + 1 + 3 * (p[1] + 1) + 9 * (p[2] + 1))];
                isWhole = isWhole && !std::isnan(scalars[corner]);
            }
            if (!isWhole)
                continue;
            const auto linkTo = [&](unsigned corner, double height) {
                const GridPlace p = placeOf(corner);
                link({at[0] + p[0], at[1] + p[1], at[2] + p[2]}, height);
            };
            for (unsigned axis = 0; axis < 3; ++axis) {
                const unsigned corner = own ^ 1u << axis, neighbour = 1u << (2 * axis + (cell >> axis & 1));
                if ((linked & neighbour) == 0)
                    linkTo(corner, std::min(signed_(scalars[own]), signed_(scalars[corner])));
                linked |= neighbour;
            }
            history_.find(scalars);
            for (const CellJoin& join : history_.joins())
                if (join.isOfAbove == (side_ == Side::Above))
                    for (std::size_t end = 0; end < 2; ++end)
                        if (join.corners[end] == own)
                            linkTo(join.corners[1 - end], signed_(join.isovalue));
        }
    }

    index::SampleBlocks& samples_;
    Side side_;
    double level_; ///< the isovalue, then that at which what was last joined was
    bool isJoining_ = false, isDone_ = false, lasts_ = false;
    std::uint64_t walked_ = 0;
    Extreme first_{};
    ReachedPoints reached_;
    std::vector<GridPlace> ready_; ///< reached, there at the level
    std::priority_queue<Waiting, std::vector<Waiting>, IsLater> waiting_;
    CellHistory history_;
};

/// The ends of the edge that the surface crosses, that above first. On an edge of a merged cell it is one of several.
std::optional<std::pair<GridPlace, GridPlace>> endsOf(index::SampleBlocks& samples, const PieceVertex& vertex,
                                                      double isovalue) {
    constexpr int kLongestEdge = 32;
    GridPlace p{vertex.edgeStart[0], vertex.edgeStart[1], vertex.edgeStart[2]};
    double before = samples.at(p[0], p[1], p[2]);
    for (int i = 0; i < kLongestEdge && !std::isnan(before); ++i) {
        GridPlace q = p;
        ++q[static_cast<std::size_t>(vertex.edgeAxis)];
        const double behind = samples.at(q[0], q[1], q[2]);
        if (std::isnan(behind))
            return std::nullopt;
        if ((before >= isovalue) != (behind >= isovalue))
            return before >= isovalue ? std::pair(p, q) : std::pair(q, p);
        p = q;
        before = behind;
    }
    return std::nullopt;
}

} // namespace

Result<PiecePersistence> persistenceOfPiece(index::SampleBlocks& samples, const PieceVertex& vertex, double isovalue,
                                            const PersistenceOptions& options, const JobControl& job) {
    const auto ends = endsOf(samples, vertex, isovalue);
    ISO_TRY(samples.status());
    if (!ends)
        return makeError(ErrorCode::InvalidArgument, "no surface crosses the edge that a piece was to have there");
    RegionWalk above(samples, Side::Above, ends->first, isovalue), below(samples, Side::Below, ends->second, isovalue);
    // Both in turn: mostly one of them is small, and the other one need only be known to last longer.
    for (std::uint64_t points = std::uint64_t{1} << 12;; points *= 8) {
        points = std::min(points, options.mostPoints);
        for (RegionWalk* walk : {&above, &below})
            walk->advance(points, job.stop);
        if (job.isStopRequested())
            return cancelledError();
        ISO_TRY(samples.status());
        const PiecePersistence a = above.result(options), b = below.result(options);
        const PiecePersistence& shorter = a.persistence <= b.persistence ? a : b;
        if (!shorter.isAtLeast || points >= options.mostPoints)
            return shorter;
    }
}

} // namespace isoslider::topology
