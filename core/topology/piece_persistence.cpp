#include "core/topology/piece_persistence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/topology/region_walk.h"

namespace isoslider::topology {
namespace {

constexpr std::uint64_t kFirstPoints = std::uint64_t{1} << 12;

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

double spanOf(const PersistenceOptions& options) {
    return std::min(options.greatest - options.least, std::numeric_limits<double>::max());
}

PiecePersistence resultOf(const RegionWalk& walk, Side side, const PersistenceOptions& options) {
    PiecePersistence found;
    found.side = side;
    found.isAtLeast = !walk.isDone();
    found.comes = walk.comes();
    found.ends = walk.ends();
    found.lasts = walk.lasts();
    found.persistence = walk.lasts() ? spanOf(options) : std::min(walk.persistence(), spanOf(options));
    return found;
}

/// Whether regions on both sides of pieces last long enough, one piece after the other.
class ShortLivedPieceSearch {
public:
    ShortLivedPieceSearch(index::SampleBlocks& samples, double isovalue, double least,
                          const PersistenceOptions& options, const JobControl& job)
        : samples_(samples),
          isovalue_(isovalue),
          least_(least),
          options_(options),
          job_(job),
          known_{KnownRegions{PointSet(samples.dims()), PointSet(samples.dims())},
                 KnownRegions{PointSet(samples.dims()), PointSet(samples.dims())}},
          pointsLeft_(options.mostPointsInAll) {}

    bool isShortLived(const PieceVertex& vertex) {
        const auto ends = endsOf(samples_, vertex, isovalue_);
        if (!ends)
            return false;
        RegionWalk above(samples_, Side::Above, ends->first, isovalue_),
            below(samples_, Side::Below, ends->second, isovalue_);
        above.endWhenKnown(least_, spanOf(options_), known_[0]);
        below.endWhenKnown(least_, spanOf(options_), known_[1]);
        for (std::uint64_t points = kFirstPoints;; points *= 8) {
            points = std::min(points, options_.mostPoints);
            for (RegionWalk* walk : {&above, &below}) {
                pointsLeft_ -= std::min(pointsLeft_, walk->advance(points, job_.stop));
                if (walk->isDone() && !walk->isLasting())
                    return true;
            }
            if (above.isDone() && below.isDone())
                return false;
            if (points >= options_.mostPoints || pointsLeft_ == 0 || job_.isStopRequested()) {
                isComplete_ = false;
                for (RegionWalk* walk : {&above, &below})
                    walk->takeForLasting(); // so that others do not walk as far in vain
                return false;
            }
        }
    }
    bool isComplete() const { return isComplete_; }

private:
    index::SampleBlocks& samples_;
    double isovalue_, least_;
    const PersistenceOptions& options_;
    const JobControl& job_;
    std::array<KnownRegions, 2> known_;
    std::uint64_t pointsLeft_;
    bool isComplete_ = true;
};

} // namespace

Result<PieceLifetimes> findShortLivedPieces(index::SampleBlocks& samples, std::span<const PieceVertex> pieces,
                                            double isovalue, double least, const PersistenceOptions& options,
                                            const JobControl& job) {
    ShortLivedPieceSearch search(samples, isovalue, least, options, job);
    PieceLifetimes found;
    found.isShortLived.reserve(pieces.size());
    for (const PieceVertex& vertex : pieces) {
        if (job.isStopRequested())
            return cancelledError();
        found.isShortLived.push_back(search.isShortLived(vertex));
        ISO_TRY(samples.status());
        job.report(static_cast<double>(found.isShortLived.size()) / static_cast<double>(pieces.size()), "pieces");
    }
    if (job.isStopRequested())
        return cancelledError();
    found.isComplete = search.isComplete();
    return found;
}

Result<PiecePersistence> persistenceOfPiece(index::SampleBlocks& samples, const PieceVertex& vertex, double isovalue,
                                            const PersistenceOptions& options, const JobControl& job) {
    const auto ends = endsOf(samples, vertex, isovalue);
    ISO_TRY(samples.status());
    if (!ends)
        return makeError(ErrorCode::InvalidArgument, "no surface crosses the edge that a piece was to have there");
    RegionWalk above(samples, Side::Above, ends->first, isovalue), below(samples, Side::Below, ends->second, isovalue);
    // Both in turn: mostly one of them is small, and the other one need only be known to last longer.
    for (std::uint64_t points = kFirstPoints;; points *= 8) {
        points = std::min(points, options.mostPoints);
        for (RegionWalk* walk : {&above, &below})
            walk->advance(points, job.stop);
        if (job.isStopRequested())
            return cancelledError();
        ISO_TRY(samples.status());
        const PiecePersistence a = resultOf(above, Side::Above, options), b = resultOf(below, Side::Below, options);
        const PiecePersistence& shorter = a.persistence <= b.persistence ? a : b;
        if (!shorter.isAtLeast || points >= options.mostPoints)
            return shorter;
    }
}

} // namespace isoslider::topology
