#include "core/topology/region_walk.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace isoslider::topology {
namespace {

// Of equal ones that with the lower number is the elder, as in settleComponents().
bool isEarlier(double height, const GridPlace& at, double otherHeight, const GridPlace& other) {
    return height != otherHeight ? height > otherHeight
                                 : std::tie(at[2], at[1], at[0]) < std::tie(other[2], other[1], other[0]);
}

} // namespace

RegionWalk::RegionWalk(index::SampleBlocks& samples, Side side, const GridPlace& start, double isovalue)
    : samples_(samples), side_(side), level_(signed_(isovalue)), reached_(samples.dims()) {
    first_ = {heightOf(start), start};
    reach(start, first_.height);
}

void RegionWalk::endWhenKnown(double least, double span, KnownRegions& known) {
    least_ = least;
    span_ = span;
    known_ = &known;
    if (known.lasting.has(first_.at) || known.shortLived.has(first_.at)) {
        isDone_ = true;
        isLasting_ = known.lasting.has(first_.at);
        return;
    }
    endIfLongEnough();
}

std::uint64_t RegionWalk::advance(std::uint64_t points, const std::stop_token& stop) {
    const std::uint64_t before = walked_;
    while (!isDone_ && walked_ < points) {
        if ((walked_ & 0xfff) == 0 && stop.stop_requested())
            break;
        if (ready_.empty()) {
            joinNext();
            continue;
        }
        const auto [height, at] = ready_.top();
        ready_.pop();
        ++walked_;
        if (isEarlier(height, at, first_.height, first_.at)) {
            if (isJoining_) {
                isDone_ = true;
                if (known_ != nullptr)
                    end(std::min(persistence(), span_) >= least_);
                break;
            }
            first_ = {height, at};
            endIfLongEnough();
            if (isDone_)
                break;
        }
        expand(at);
    }
    return walked_ - before;
}

// What is below the isovalue is so beyond it only: a sample of that scalar is above.
bool RegionWalk::isThere(double height) const {
    return side_ == Side::Below && !isJoining_ ? height > level_ : height >= level_;
}

void RegionWalk::reach(const GridPlace& p, double height) {
    if (!reached_.add(p))
        return;
    ready_.push({height, p});
    if (known_ == nullptr || isJoining_ || isDone_)
        return;
    if (known_->lasting.has(p))
        end(true);
    else if (known_->shortLived.has(p))
        end(false);
}

void RegionWalk::link(const GridPlace& p, double height, double joinedAt) {
    if (isThere(joinedAt))
        reach(p, height);
    else if (!reached_.has(p))
        waiting_.push({joinedAt, p});
}

void RegionWalk::joinNext() {
    while (!waiting_.empty()) {
        const Waiting next = waiting_.top();
        waiting_.pop();
        if (reached_.has(next.at))
            continue;
        if (!isJoining_ && known_ != nullptr)
            region_.emplace(reached_);
        isJoining_ = true;
        level_ = next.height;
        reach(next.at, heightOf(next.at));
        endIfLongEnough();
        return;
    }
    lasts_ = isDone_ = true;
    if (known_ != nullptr)
        end(span_ >= least_);
}

// Scalars between here and the end only make it longer; differences are rounded in the same order.
void RegionWalk::endIfLongEnough() {
    if (known_ != nullptr && !isDone_ && persistence() >= least_)
        end(true);
}

void RegionWalk::end(bool isLasting) {
    isDone_ = true;
    isLasting_ = isLasting;
    (isLasting ? known_->lasting : known_->shortLived).add(region_ ? *region_ : reached_);
}

void RegionWalk::expand(const GridPlace& at) {
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
            link({at[0] + p[0], at[1] + p[1], at[2] + p[2]}, signed_(scalars[corner]), height);
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

} // namespace isoslider::topology
