#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace isoslider {

/// Sets of elements, at first of one each. One number an element; paths are halved.
template <class ElementType = std::uint32_t>
class DisjointSets {
public:
    using Element = ElementType;

    explicit DisjointSets(std::size_t count = 0) { reset(count); }
    /// Back to sets of one, of so many elements.
    void reset(std::size_t count) {
        parent_.resize(count);
        std::iota(parent_.begin(), parent_.end(), Element{0});
    }
    std::size_t count() const { return parent_.size(); }

    Element rootOf(Element e) {
        while (parent_[e] != e) {
            parent_[e] = parent_[parent_[e]];
            e = parent_[e];
        }
        return e;
    }
    /// `child` becomes a part of `root`'s set. REQUIRES: both are roots, and not one.
    void attach(Element child, Element root) { parent_[child] = root; }
    /// The smaller root stays one: the same answer whatever the order of calls.
    void unite(Element a, Element b) {
        a = rootOf(a);
        b = rootOf(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<Element> parent_;
};

} // namespace isoslider
