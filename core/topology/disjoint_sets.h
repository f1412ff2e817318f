#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace isoslider::topology {

/// Sets that elements join one after the other, and how many there are. 8 bytes an element. The root of a set is its
/// first element: the elder rule needs it; paths are halved. A set is marked if one of its elements is.
class DisjointSets {
public:
    using Element = std::uint32_t;

    explicit DisjointSets(std::size_t count) : parent_(count, kAbsent), age_(count), isMarked_(count, false) {}

    bool has(Element e) const { return parent_[e] != kAbsent; }
    /// A new set. REQUIRES: the element is in none.
    void add(Element e, bool isMarked) {
        parent_[e] = e;
        age_[e] = added_++;
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
    /// The first element of the younger of two sets, which is part of the elder from now on; none if it is one set.
    /// REQUIRES: both are there.
    std::optional<Element> join(Element a, Element b) {
        Element elder = rootOf(a), younger = rootOf(b);
        if (elder == younger)
            return std::nullopt;
        if (age_[younger] < age_[elder])
            std::swap(elder, younger);
        parent_[younger] = elder;
        --sets_;
        if (!isMarked_[elder] || !isMarked_[younger])
            --unmarked_;
        isMarked_[elder] = isMarked_[elder] || isMarked_[younger];
        return younger;
    }

    std::int64_t sets() const { return sets_; }
    std::int64_t unmarkedSets() const { return unmarked_; }

private:
    static constexpr Element kAbsent = std::numeric_limits<Element>::max();
    std::vector<Element> parent_;
    std::vector<std::uint32_t> age_; ///< when it was added
    std::uint32_t added_ = 0;
    std::vector<bool> isMarked_; ///< of roots
    std::int64_t sets_ = 0, unmarked_ = 0;
};

} // namespace isoslider::topology
