#include "core/extract/live/kept_points.h"

namespace isoslider::extract {

void KeptPoints::unlink(Link link) {
    const Node& node = nodes_[link - 1];
    (node.newer != 0 ? nodes_[node.newer - 1].older : newest_) = node.older;
    (node.older != 0 ? nodes_[node.older - 1].newer : oldest_) = node.newer;
    linkOf_[node.brick.index()] = 0;
}

std::optional<ArenaRun> KeptPoints::put(BrickIndex brick, const Kept& kept) {
    std::optional<ArenaRun> givenUp;
    Link link = 0;
    if (count_ >= bound_) {
        link = oldest_;
        unlink(link);
        givenUp = nodes_[link - 1].kept.run;
    } else {
        if (free_.empty()) {
            nodes_.emplace_back();
            free_.reserve(nodes_.capacity()); // take() and clear() need no memory
            free_.push_back(static_cast<Link>(nodes_.size()));
        }
        link = free_.back();
        free_.pop_back();
        ++count_;
    }
    nodes_[link - 1] = {kept, brick, 0, newest_, true};
    (newest_ != 0 ? nodes_[newest_ - 1].newer : oldest_) = link;
    newest_ = link;
    linkOf_[brick.index()] = link;
    return givenUp;
}

std::optional<KeptPoints::Kept> KeptPoints::take(BrickIndex brick) {
    const Link link = linkOf_[brick.index()];
    if (link == 0)
        return std::nullopt;
    return remove(link);
}

ArenaRun KeptPoints::giveUp() { return remove(oldest_).run; }

KeptPoints::Kept KeptPoints::remove(Link link) {
    unlink(link);
    free_.push_back(link);
    --count_;
    nodes_[link - 1].isUsed = false;
    return nodes_[link - 1].kept;
}

void KeptPoints::clear() noexcept {
    for (const Node& node : nodes_)
        if (node.isUsed)
            linkOf_[node.brick.index()] = 0;
    nodes_.clear();
    free_.clear();
    count_ = 0;
    newest_ = oldest_ = 0;
}

} // namespace isoslider::extract
