#include "core/index/lazy_levels.h"

#include <algorithm>
#include <bit>

namespace isoslider::index {
namespace {

// Appends the records of `from` without the edges whose far end lies in [begin, end).
template <class Key>
void appendWithoutRedundant(const DecodedPage<Key>& from, std::uint64_t begin, std::uint64_t end,
                            DecodedPage<Key>& to) {
    if (!from.forms.empty())
        to.forms.resize(to.keys.size(), record_form::kPoint);
    const bool hasForms = !from.forms.empty() || !to.forms.empty();
    std::size_t edge = 0;
    for (std::size_t i = 0; i < from.pointCount(); ++i) {
        const auto isRedundant = [&](std::size_t entry) {
            return from.farKeys[entry] >= begin && from.farKeys[entry] < end;
        };
        // An interval goes whole, by its first entry.
        const std::uint8_t form = from.form(i);
        const bool isDropped = form != record_form::kPoint && isRedundant(edge);
        std::uint8_t mask = 0;
        for (unsigned rest = from.masks[i]; rest != 0; rest &= rest - 1, ++edge) {
            if (form != record_form::kPoint ? isDropped : isRedundant(edge))
                continue;
            mask |= static_cast<std::uint8_t>(rest & (~rest + 1));
            to.farKeys.push_back(from.farKeys[edge]);
            to.farNormals.push_back(from.farNormals[edge]);
        }
        if (mask == 0)
            continue;
        to.keys.push_back(from.keys[i]);
        to.ids.push_back(from.ids[i]);
        to.masks.push_back(mask);
        to.normals.push_back(from.normals[i]);
        if (hasForms)
            to.forms.push_back(form);
    }
}

} // namespace

template <class Key>
std::vector<typename LazyLevels<Key>::Group> LazyLevels<Key>::groupsOf(std::uint64_t begin, std::uint64_t end) {
    std::vector<Group> groups;
    while (begin < end) {
        int level = begin == 0 ? kMaxLevel : std::min(kMaxLevel, std::countr_zero(begin));
        while ((std::uint64_t{1} << level) > end - begin)
            --level;
        groups.push_back({level, begin >> level});
        begin += std::uint64_t{1} << level;
    }
    return groups;
}

template <class Key>
typename LazyLevels<Key>::Page LazyLevels<Key>::find(const Group& group) const {
    const std::lock_guard lock(mutex_);
    const auto found = blocks_.find({group.level, group.index});
    return found == blocks_.end() ? nullptr : found->second;
}

template <class Key>
bool LazyLevels<Key>::isFull() const {
    const std::lock_guard lock(mutex_);
    return bytes_ >= maxBytes_;
}

template <class Key>
Result<typename LazyLevels<Key>::Page> LazyLevels<Key>::get(const Group& group, const Below& below) {
    if (Page page = find(group))
        return page;
    if (isFull())
        return Page{};
    {
        const std::lock_guard lock(mutex_);
        if (blocks_.emplace(std::pair{group.level, group.index}, nullptr).second)
            return Page{};
    }
    return build(group, below);
}

template <class Key>
Result<typename LazyLevels<Key>::Page> LazyLevels<Key>::build(const Group& group, const Below& below) {
    if (Page page = find(group))
        return page;
    const auto [begin, end] = below.interval(group.firstBlock(), group.blockEnd());
    auto merged = std::make_shared<DecodedPage<Key>>();
    for (std::uint64_t half = 0; half < 2; ++half) {
        if (group.level == 1) {
            auto pages = below.pages(2 * group.index + half);
            if (!pages.isOk())
                return std::move(pages).error();
            for (const Page& page : pages.value())
                appendWithoutRedundant(*page, begin, end, *merged);
        } else {
            auto child = build({group.level - 1, 2 * group.index + half}, below);
            if (!child.isOk() || !child.value())
                return child;
            appendWithoutRedundant(*child.value(), begin, end, *merged);
        }
    }
    const std::lock_guard lock(mutex_);
    const std::uint64_t size = merged->memoryBytes();
    if (bytes_ + size > maxBytes_) {
        bytes_ = std::max(bytes_, maxBytes_); // full from now on
        return Page{};
    }
    Page& place = blocks_[{group.level, group.index}];
    if (!place) {
        place = std::move(merged);
        bytes_ += size;
    }
    return place;
}

template <class Key>
std::uint64_t LazyLevels<Key>::memoryBytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
}

template <class Key>
void LazyLevels<Key>::clear() {
    const std::lock_guard lock(mutex_);
    blocks_.clear();
    bytes_ = 0;
}

template class LazyLevels<std::uint16_t>;
template class LazyLevels<std::uint32_t>;
template class LazyLevels<std::uint64_t>;

} // namespace isoslider::index
