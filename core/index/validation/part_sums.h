#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>

namespace isoslider::index {

/// Hashes one number after the other into one; not against forgers.
inline std::uint64_t mixHash(std::uint64_t hash, std::uint64_t value) {
    hash = (hash ^ value) + 0x9e3779b97f4a7c15ull; // splitmix64
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9ull;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebull;
    return hash ^ (hash >> 31);
}

/// To be mixed with small numbers: mixHash() takes a number and a small one that differ in the same bits for the same.
inline std::uint64_t idHash(std::uint64_t id) { return mixHash(0x51ed270b, id); }

/// Sums of hashes, by part of the box: two sets of things in the box are compared without keeping either, and where
/// they differ one knows about where. Bricks in order are cut into at most 65536 parts. Any thread.
class PartSums {
public:
    explicit PartSums(std::uint64_t bricks)
        : bricksPerPart_(std::max<std::uint64_t>(1, (bricks + kMostParts - 1) / kMostParts)),
          parts_((bricks + bricksPerPart_ - 1) / bricksPerPart_),
          bricks_(bricks),
          sums_(std::make_unique<std::atomic<std::uint64_t>[]>(parts_)) {}

    void add(std::uint64_t brick, std::uint64_t hash) {
        sums_[brick / bricksPerPart_].fetch_add(hash, std::memory_order_relaxed);
    }
    std::uint64_t parts() const { return parts_; }
    std::uint64_t at(std::uint64_t part) const { return sums_[part].load(std::memory_order_relaxed); }
    std::uint64_t firstBrick(std::uint64_t part) const { return part * bricksPerPart_; }
    std::uint64_t lastBrick(std::uint64_t part) const { return std::min(bricks_, (part + 1) * bricksPerPart_) - 1; }

private:
    static constexpr std::uint64_t kMostParts = 1u << 16;

    std::uint64_t bricksPerPart_, parts_, bricks_;
    std::unique_ptr<std::atomic<std::uint64_t>[]> sums_;
};

} // namespace isoslider::index
