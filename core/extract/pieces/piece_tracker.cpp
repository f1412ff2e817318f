#include "core/extract/pieces/piece_tracker.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <mutex>
#include <numeric>
#include <utility>

#include <tbb/parallel_sort.h>

#include "core/base/disjoint_sets.h"
#include "core/base/worker_team.h"

namespace isoslider::extract {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

using Place = std::array<std::uint16_t, 3>;

PieceId newId() {
    static std::atomic<std::uint32_t> last{0};
    std::uint32_t id = last++;
    while (id == kNone)
        id = last++;
    return PieceId(id);
}

std::uint64_t packed(const Place& place) {
    return std::uint64_t{place[0]} | std::uint64_t{place[1]} << 16 | std::uint64_t{place[2]} << 32;
}

/// Finds the slot of the brick at a place. O(bricks) to make.
class SlotsByPlace {
public:
    /// `isThere(slot)`: whether the brick has triangles.
    template <class IsThere>
    SlotsByPlace(std::span<const Place> places, const IsThere& isThere)
        : places_(places), slots_(std::bit_ceil(2 * places.size() + 2), kNone) {
        for (std::size_t slot = 0; slot < places.size(); ++slot)
            if (isThere(slot))
                slots_[freeOrSame(places[slot])] = static_cast<std::uint32_t>(slot);
    }
    /// kNone without one that has triangles.
    std::uint32_t at(const Place& place) const { return slots_[freeOrSame(place)]; }

private:
    std::size_t freeOrSame(const Place& place) const {
        const std::size_t mask = slots_.size() - 1;
        // Fibonacci hashing: neighbouring places differ in low bits only.
        std::size_t at = packed(place) * 0x9e3779b97f4a7c15u >> 24 & mask;
        while (slots_[at] != kNone && places_[slots_[at]] != place)
            at = (at + 1) & mask;
        return at;
    }

    std::span<const Place> places_;
    std::vector<std::uint32_t> slots_;
};

/// What a piece of the last picture (its place there) and one of this have in common.
struct Vote {
    std::uint64_t pair; ///< last << 32 | this
    std::uint64_t weight;

    std::uint32_t last() const { return static_cast<std::uint32_t>(pair >> 32); }
    std::uint32_t present() const { return static_cast<std::uint32_t>(pair); }
};

// Against 1 for a box of parts that overlap in a brick: more than all bricks together can give.
constexpr std::uint64_t kSameVertex = std::uint64_t{1} << 32;
constexpr double kLeastOverlap = 0.5; // of the smaller box, when nothing else is in common
constexpr std::size_t kMostBoxes = 128; // that are compared with each other

bool overlap(const BrickPart& a, const BrickPart& b) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (a.high[axis] < b.low[axis] || b.high[axis] < a.low[axis])
            return false;
    return true;
}

double volumeOf(const std::array<std::int32_t, 3>& low, const std::array<std::int32_t, 3>& high) {
    double volume = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        volume *= std::max(0, high[axis] - low[axis]);
    return volume;
}

struct BoxOverlap {
    double ofSmaller = 0.0; ///< the part of the smaller box that both have
    double ofUnion = 0.0;
};

BoxOverlap boxOverlap(const Piece& a, const Piece& b) {
    std::array<std::int32_t, 3> low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::max(a.low[axis], b.low[axis]);
        high[axis] = std::min(a.high[axis], b.high[axis]);
    }
    const double both = volumeOf(low, high), ofA = volumeOf(a.low, a.high), ofB = volumeOf(b.low, b.high);
    return both > 0.0 ? BoxOverlap{both / std::min(ofA, ofB), both / (ofA + ofB - both)} : BoxOverlap{};
}

} // namespace

std::optional<std::size_t> SurfacePieces::pieceAt(const std::array<std::int32_t, 3>& edgeStart, int edgeAxis) const {
    for (std::size_t slot = 0; slot < slotCount(); ++slot) {
        if (parts_[slot] == nullptr)
            continue;
        const auto origin = originOf(slot);
        std::array<std::int32_t, 3> local{};
        bool isHere = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            local[axis] = edgeStart[axis] - origin[axis];
            const int last = static_cast<int>(axis) == edgeAxis ? kCellSide - 1 : kCellSide;
            isHere = isHere && local[axis] >= 0 && local[axis] <= last;
        }
        const auto& edges = parts_[slot]->edges;
        for (std::size_t record = 0; isHere && record < edges.size(); ++record)
            if (const std::uint16_t part = parts_[slot]->partOf[record];
                part != BrickParts::kNone && edges[record] < EdgeRecord<float>::kInside &&
                axisOf(edges[record]) == edgeAxis && coordsOf(startOf(edges[record])) == local)
                return piecesOf(slot)[part];
    }
    return std::nullopt;
}

/// One picture's way from bricks to pieces with numbers.
template <class Live>
class PieceTracker<Live>::Step {
public:
    Step(const BrickPicture<Live>& picture, const PieceTracker& tracker)
        : picture_(picture),
          now_(picture.bricks()),
          old_(tracker.bricks_),
          last_(tracker.last_.get()),
          isSameSeries_(picture.series() == tracker.series_) {}

    std::shared_ptr<SurfacePieces> run(bool hasMissing) {
        findParts();
        joinParts(hasMissing);
        numberPieces();
        if (last_ != nullptr && !last_->pieces().empty())
            follow();
        for (Piece& piece : result_->pieces_)
            if (piece.id == PieceId(kNone))
                piece.id = newId();
        return std::move(result_);
    }

private:
    bool isUnchanged(std::size_t slot) const {
        return last_ != nullptr && isSameSeries_ && slot < old_.size() && old_[slot] == now_[slot];
    }

    void findParts() {
        auto& parts = result_->parts_;
        parts.resize(now_.size());
        result_->places_.reserve(now_.size());
        for (const PictureBrick& brick : now_)
            result_->places_.push_back(brick.place);
        forEachIndex(now_.size(), kBricksTogether, [&](std::size_t slot) {
            const PictureBrick& brick = now_[slot];
            if (brick.indexCount == 0)
                return;
            if (isUnchanged(slot)) {
                parts[slot] = last_->parts_[slot];
                return;
            }
            static thread_local std::vector<EdgeRecord<Live>> records;
            parts[slot] = std::make_shared<const BrickParts>(
                partsOf<Live>(picture_.records(brick, records), {picture_.indices(brick), brick.indexCount}));
        });
        auto& first = result_->firstPart_;
        first.assign(now_.size() + 1, 0);
        for (std::size_t slot = 0; slot < now_.size(); ++slot)
            first[slot + 1] = first[slot] + static_cast<std::uint32_t>(parts[slot] ? parts[slot]->parts.size() : 0);
    }

    static SlotsByPlace slotsOf(const SurfacePieces& pieces) {
        return {pieces.places_, [&](std::size_t slot) { return pieces.parts_[slot] != nullptr; }};
    }

    // Across faces. Both bricks at a face list the vertices on it in the same order. Where no cells are missing, bricks
    // that only share an edge are joined by those between them.
    void joinParts(bool hasMissing) {
        const SlotsByPlace slots = slotsOf(*result_);
        connected_.reset(result_->firstPart_.back());
        std::mutex mutex;
        forRanges(now_.size(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
            std::vector<std::pair<std::uint32_t, std::uint32_t>> joins;
            for (std::size_t slot = begin; slot < end; ++slot)
                if (result_->parts_[slot])
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        listJoins(slots, slot, axis, joins);
                        for (std::size_t other = axis + 1; hasMissing && other < 3; ++other)
                            for (const bool isUp : {false, true})
                                listJoinsAtEdge(slots, slot, axis, other, isUp, joins);
                    }
            const std::lock_guard lock(mutex);
            for (const auto& [a, b] : joins)
                connected_.unite(a, b);
        });
    }

    using Joins = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

    void listJoins(const SlotsByPlace& slots, std::size_t slot, std::size_t axis, Joins& joins) const {
        const auto& mine = result_->parts_[slot]->faces[2 * axis + 1];
        if (mine.empty())
            return;
        Place place = now_[slot].place;
        ++place[axis];
        const std::uint32_t beside = slots.at(place);
        if (beside == kNone)
            return;
        const auto& others = result_->parts_[beside]->faces[2 * axis];
        std::pair<std::uint32_t, std::uint32_t> last{kNone, kNone};
        for (auto a = mine.begin(), b = others.begin(); a != mine.end() && b != others.end();) {
            if (a->place != b->place) {
                a->place < b->place ? ++a : ++b;
                continue;
            }
            const std::pair join{result_->firstPart_[slot] + a->part, result_->firstPart_[beside] + b->part};
            if (join != last)
                joins.push_back(last = join);
            ++a;
            ++b;
        }
    }

    // With the brick that is next along `axis` and, up or down, along `other`.
    void listJoinsAtEdge(const SlotsByPlace& slots, std::size_t slot, std::size_t axis, std::size_t other, bool isUp,
                         Joins& joins) const {
        Place place = now_[slot].place;
        ++place[axis];
        if (!isUp && place[other] == 0)
            return;
        place[other] = static_cast<std::uint16_t>(place[other] + (isUp ? 1 : -1));
        const std::uint32_t beside = slots.at(place);
        if (beside == kNone)
            return;
        const int mine = isUp ? kCellSide : 0, theirs = kCellSide - mine;
        const auto& others = result_->parts_[beside]->faces[2 * axis];
        for (const BrickParts::FaceVertex& a : result_->parts_[slot]->faces[2 * axis + 1]) {
            if (axisOf(a.place) == static_cast<int>(other) || coordsOf(startOf(a.place))[other] != mine)
                continue;
            const ClosedEdge same(a.place.number() + (theirs - mine) * kPointStride[other]);
            const auto b = std::lower_bound(
                others.begin(), others.end(), same,
                [](const BrickParts::FaceVertex& vertex, ClosedEdge edge) { return vertex.place < edge; });
            if (b != others.end() && b->place == same)
                joins.push_back({result_->firstPart_[slot] + a.part, result_->firstPart_[beside] + b->part});
        }
    }

    void numberPieces() {
        auto& pieces = result_->pieces_;
        auto& pieceOf = result_->pieceOfPart_;
        pieceOf.assign(connected_.count(), kNone);
        for (std::size_t slot = 0; slot < now_.size(); ++slot) {
            const auto origin = now_[slot].origin();
            const std::uint32_t first = result_->firstPart_[slot];
            for (std::uint32_t k = first; k < result_->firstPart_[slot + 1]; ++k) {
                // Roots are the first of their parts, so they are numbered before the others.
                const std::uint32_t root = connected_.rootOf(k);
                if (root == k) {
                    pieceOf[k] = static_cast<std::uint32_t>(pieces.size());
                    constexpr auto kFar = std::numeric_limits<std::int32_t>::max();
                    const ClosedEdge edge = result_->parts_[slot]->parts[k - first].edge;
                    const auto start = coordsOf(startOf(edge));
                    pieces.push_back({PieceId(kNone),
                                      0,
                                      {kFar, kFar, kFar},
                                      {-1, -1, -1},
                                      {origin[0] + start[0], origin[1] + start[1], origin[2] + start[2]},
                                      axisOf(edge)});
                }
                pieceOf[k] = pieceOf[root];
                Piece& piece = pieces[pieceOf[k]];
                const BrickPart& part = result_->parts_[slot]->parts[k - first];
                piece.triangles += part.triangles;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    piece.low[axis] = std::min(piece.low[axis], origin[axis] + part.low[axis]);
                    piece.high[axis] = std::max(piece.high[axis], origin[axis] + part.high[axis]);
                }
            }
        }
        std::vector<std::uint32_t> order(pieces.size()), rank(pieces.size());
        std::iota(order.begin(), order.end(), 0u);
        tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            return pieces[a].triangles != pieces[b].triangles ? pieces[a].triangles > pieces[b].triangles : a < b;
        });
        std::vector<Piece> sorted(pieces.size());
        for (std::uint32_t k = 0; k < order.size(); ++k) {
            sorted[k] = pieces[order[k]];
            rank[order[k]] = k;
        }
        pieces = std::move(sorted);
        for (std::uint32_t& piece : pieceOf)
            piece = rank[piece];
    }

    void follow() {
        auto votes = castVotes();
        tbb::parallel_sort(votes.begin(), votes.end(), [](const Vote& a, const Vote& b) { return a.pair < b.pair; });
        std::size_t count = 0;
        for (const Vote& vote : votes) {
            if (count > 0 && votes[count - 1].pair == vote.pair)
                votes[count - 1].weight += vote.weight;
            else
                votes[count++] = vote;
        }
        votes.resize(count);
        tbb::parallel_sort(votes.begin(), votes.end(), [](const Vote& a, const Vote& b) {
            return a.weight != b.weight ? a.weight > b.weight : a.pair < b.pair;
        });
        isTaken_.assign(last_->pieces_.size(), false);
        hasShared_.assign(last_->pieces_.size(), false);
        isShared_.assign(result_->pieces_.size(), false);
        for (const Vote& vote : votes)
            if (vote.weight >= kSameVertex) {
                take(vote.last(), vote.present());
                hasShared_[vote.last()] = isShared_[vote.present()] = true;
            }
        // A piece that shares vertices with another, which has its number now, has become part of it.
        for (const Vote& vote : votes)
            if (!hasShared_[vote.last()] && !isShared_[vote.present()])
                take(vote.last(), vote.present());
        followBoxes();
    }

    void take(std::uint32_t last, std::uint32_t present) {
        Piece& piece = result_->pieces_[present];
        if (isTaken_[last] || piece.id != PieceId(kNone))
            return;
        isTaken_[last] = true;
        piece.id = last_->pieces_[last].id;
    }

    std::vector<Vote> castVotes() const {
        const SlotsByPlace oldSlots = slotsOf(*last_);
        std::vector<Vote> votes;
        std::mutex mutex;
        forRanges(now_.size(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
            std::vector<Vote> mine;
            for (std::size_t slot = begin; slot < end; ++slot) {
                if (!result_->parts_[slot])
                    continue;
                if (const std::uint32_t old = oldSlots.at(now_[slot].place); old != kNone)
                    castVotes(slot, old, mine);
            }
            const std::lock_guard lock(mutex);
            votes.insert(votes.end(), mine.begin(), mine.end());
        });
        return votes;
    }

    void castVotes(std::size_t slot, std::size_t oldSlot, std::vector<Vote>& votes) const {
        const BrickParts& now = *result_->parts_[slot];
        const BrickParts& old = *last_->parts_[oldSlot];
        const auto pieces = result_->piecesOf(slot);
        const auto oldPieces = last_->piecesOf(oldSlot);
        const std::size_t first = votes.size();
        const auto vote = [&](std::size_t oldPart, std::size_t part, std::uint64_t weight) {
            const std::uint64_t pair = std::uint64_t{oldPieces[oldPart]} << 32 | pieces[part];
            if (votes.size() > first && votes.back().pair == pair)
                votes.back().weight += weight;
            else
                votes.push_back({pair, weight});
        };
        if (&now == &old) {
            for (std::size_t part = 0; part < now.parts.size(); ++part)
                vote(part, part, kSameVertex * now.parts[part].triangles);
            return;
        }
        for (std::size_t part = 0; part < now.parts.size(); ++part)
            for (std::size_t oldPart = 0; oldPart < old.parts.size(); ++oldPart)
                if (overlap(now.parts[part], old.parts[oldPart]))
                    vote(oldPart, part, 1);
        std::size_t a = 0, b = 0;
        while (a < old.edges.size() && b < now.edges.size() && now.edges[b] < EdgeRecord<Live>::kInside) {
            if (old.edges[a] != now.edges[b]) {
                old.edges[a] < now.edges[b] ? ++a : ++b;
                continue;
            }
            if (old.partOf[a] != BrickParts::kNone && now.partOf[b] != BrickParts::kNone)
                vote(old.partOf[a], now.partOf[b], kSameVertex);
            ++a;
            ++b;
        }
    }

    // Of pieces without anything in common with the last picture the largest are looked for where they lie.
    void followBoxes() {
        std::vector<std::uint32_t> lost, found;
        for (std::uint32_t k = 0; k < isTaken_.size() && lost.size() < kMostBoxes; ++k)
            if (!isTaken_[k] && !hasShared_[k])
                lost.push_back(k);
        for (std::uint32_t k = 0; k < result_->pieces_.size() && found.size() < kMostBoxes; ++k)
            if (result_->pieces_[k].id == PieceId(kNone) && !isShared_[k])
                found.push_back(k);
        std::vector<std::pair<double, std::pair<std::uint32_t, std::uint32_t>>> pairs;
        for (const std::uint32_t last : lost)
            for (const std::uint32_t present : found)
                if (const auto overlap = boxOverlap(last_->pieces_[last], result_->pieces_[present]);
                    overlap.ofSmaller >= kLeastOverlap)
                    pairs.push_back({-overlap.ofUnion, {last, present}});
        std::sort(pairs.begin(), pairs.end());
        for (const auto& [overlap, pair] : pairs)
            take(pair.first, pair.second);
    }

    const BrickPicture<Live>& picture_;
    std::span<const PictureBrick> now_, old_;
    const SurfacePieces* last_;
    bool isSameSeries_;
    std::shared_ptr<SurfacePieces> result_ = std::make_shared<SurfacePieces>();
    DisjointSets<> connected_; ///< parts
    std::vector<bool> isTaken_, hasShared_; ///< by place among the pieces of the last picture
    std::vector<bool> isShared_; ///< by place among those of this one: has vertices in common with the last picture
};

template <class Live>
std::shared_ptr<const SurfacePieces> PieceTracker<Live>::update(const BrickPicture<Live>& picture, bool hasMissing) {
    try {
        auto pieces = Step(picture, *this).run(hasMissing);
        bricks_.assign(picture.bricks().begin(), picture.bricks().end());
        series_ = picture.series();
        last_ = pieces;
        return pieces;
    } catch (...) {
        forget();
        throw;
    }
}

template class PieceTracker<float>;
template class PieceTracker<double>;

} // namespace isoslider::extract
