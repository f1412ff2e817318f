#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace isoslider::topology {

/// Sets that elements join one after the other, and how many there are. 4 bytes an element; paths are halved.
/// A set is marked if one of its elements is.
class DisjointSets {
public:
    using Element = std::uint32_t;

    explicit DisjointSets(std::size_t count) : parent_(count, kAbsent), isMarked_(count, false) {}

    bool has(Element e) const { return parent_[e] != kAbsent; }
    /// A set of its own. REQUIRES: it is in none.
    void add(Element e, bool isMarked) {
        parent_[e] = e;
        isMarked_[e] = isMarked;
        ++sets_;
        unmarked_ += isMarked ? 0 : 1;
    }
    Element rootOf(Element e) {
        while (parent_[e] != e) {
            parent_[e] = parent_[parent_[e]];
            e = parent_[e];
        }
        return e;
    }
    /// REQUIRES: both are there.
    void join(Element a, Element b) {
        const Element rootA = rootOf(a), rootB = rootOf(b);
        if (rootA == rootB)
            return;
        parent_[rootA] = rootB;
        --sets_;
        if (!isMarked_[rootA] || !isMarked_[rootB])
            --unmarked_;
        isMarked_[rootB] = isMarked_[rootA] || isMarked_[rootB];
    }

    std::int64_t sets() const { return sets_; }
    std::int64_t unmarkedSets() const { return unmarked_; }

private:
    static constexpr Element kAbsent = std::numeric_limits<Element>::max();
    std::vector<Element> parent_;
    std::vector<bool> isMarked_; ///< of roots
    std::int64_t sets_ = 0, unmarked_ = 0;
};

} // namespace isoslider::topology
