#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace isoslider::topology {

/// Sets of elements, at first of one each. 4 bytes an element; paths are halved. Which of two roots remains is for the
/// caller to decide.
class DisjointSets {
public:
    using Element = std::uint32_t;

    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), Element{0}); }

    Element rootOf(Element e) {
        while (parent_[e] != e) {
            parent_[e] = parent_[parent_[e]];
            e = parent_[e];
        }
        return e;
    }
    /// `child` becomes a part of `root`'s set. REQUIRES: both are roots, and not one.
    void attach(Element child, Element root) { parent_[child] = root; }

private:
    std::vector<Element> parent_;
};

} // namespace isoslider::topology
