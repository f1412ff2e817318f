#pragma once

#include <compare>
#include <concepts>
#include <cstddef>
#include <functional>

namespace isoslider {

/// A number that stands for one kind of thing. Two kinds do not mix, and no number becomes one by itself: conversions
/// are written out, in both directions. Of the size of its number, and as fast.
///
///     struct BrickTag;
///     using BrickIndex = StrongId<BrickTag, std::uint32_t>;
template <class Tag, std::integral Number>
class StrongId {
public:
    using NumberType = Number;

    constexpr StrongId() = default;
    template <std::integral From>
    constexpr explicit StrongId(From number) : number_(static_cast<Number>(number)) {}

    constexpr Number number() const { return number_; }
    template <std::integral To>
    constexpr explicit operator To() const {
        return static_cast<To>(number_);
    }
    /// As the place in an array.
    constexpr std::size_t index() const { return static_cast<std::size_t>(number_); }

    constexpr StrongId& operator++() {
        ++number_;
        return *this;
    }
    constexpr StrongId& operator--() {
        --number_;
        return *this;
    }
    /// As with pointers: the distance between two of one kind, and what lies at a distance.
    friend constexpr Number operator-(const StrongId& last, const StrongId& first) {
        return static_cast<Number>(last.number_ - first.number_);
    }
    template <std::integral Distance>
    friend constexpr StrongId operator+(const StrongId& id, Distance distance) {
        return StrongId(id.number_ + static_cast<Number>(distance));
    }
    template <std::integral Distance>
    friend constexpr StrongId operator-(const StrongId& id, Distance distance) {
        return StrongId(id.number_ - static_cast<Number>(distance));
    }
    friend constexpr auto operator<=>(const StrongId&, const StrongId&) = default;

private:
    Number number_ = 0;
};

/// The ids from 0 to `end`, for loops.
template <class Id>
class IdRange {
public:
    class Iterator {
    public:
        constexpr explicit Iterator(Id id) : id_(id) {}
        constexpr Id operator*() const { return id_; }
        constexpr Iterator& operator++() {
            ++id_;
            return *this;
        }
        friend constexpr bool operator==(const Iterator&, const Iterator&) = default;

    private:
        Id id_;
    };

    constexpr explicit IdRange(Id end) : end_(end) {}
    constexpr Iterator begin() const { return Iterator(Id()); }
    constexpr Iterator end() const { return Iterator(end_); }

private:
    Id end_;
};

template <class Id, std::integral Count>
constexpr IdRange<Id> firstIds(Count count) {
    return IdRange<Id>(Id(count));
}

} // namespace isoslider

template <class Tag, std::integral Number>
struct std::hash<isoslider::StrongId<Tag, Number>> {
    std::size_t operator()(const isoslider::StrongId<Tag, Number>& id) const noexcept {
        return std::hash<Number>()(id.number());
    }
};
