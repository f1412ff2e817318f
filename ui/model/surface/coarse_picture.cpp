#include "ui/model/surface/coarse_picture.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

#include "core/extract/live/brick_picture.h"

namespace isoslider::model {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Numbers blocks in the order in which they are first asked for: a hash table with open addressing, since the
/// vertices of a large surface are tens of millions.
class BlockNumbers {
public:
    std::uint32_t numberOf(std::uint64_t block) {
        Slot& slot = slotOf(block);
        if (slot.number != kNone)
            return slot.number;
        const auto number = count_++;
        slot = {block, number};
        if (2 * std::size_t{count_} > slots_.size())
            grow();
        return number;
    }

private:
    struct Slot {
        std::uint64_t block = 0;
        std::uint32_t number = kNone;
    };

    /// Of the block, or the free one for it.
    Slot& slotOf(std::uint64_t block) {
        // Fibonacci hashing: neighbouring blocks differ in low bits only.
        std::size_t at = (block * 0x9e3779b97f4a7c15u) >> 20;
        while (slots_[at & (slots_.size() - 1)].number != kNone && slots_[at & (slots_.size() - 1)].block != block)
            ++at;
        return slots_[at & (slots_.size() - 1)];
    }
    void grow() {
        const auto old = std::exchange(slots_, std::vector<Slot>(2 * slots_.size()));
        for (const auto& slot : old)
            if (slot.number != kNone)
                slotOf(slot.block) = slot;
    }

    std::vector<Slot> slots_ = std::vector<Slot>(1024); // always a power of two
    std::uint32_t count_ = 0;
};

bool hasArea(const std::uint32_t* corners) {
    return corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
}

/// The means of the vertices that share a block.
class MergedVertices {
public:
    MergedVertices(const extract::SurfaceFrame& frame, std::int64_t blockCells)
        : frame_(frame), size_(static_cast<float>(blockCells)), blockOf_(frame.positions.size(), kNone) {
        // By way of the triangles: a frame may have room for vertices that are none.
        for (std::size_t i = 0; i + 2 < frame.indices.size(); i += 3)
            if (hasArea(&frame.indices[i]))
                for (std::size_t corner = i; corner < i + 3; ++corner)
                    add(frame.indices[corner]);
        for (std::size_t block = 0; block < counts_.size(); ++block)
            finish(block);
    }

    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;

    /// kNone for what no triangle uses.
    std::uint32_t blockOf(std::uint32_t vertex) const { return blockOf_[vertex]; }

private:
    glm::vec3 cornerOf(std::uint32_t vertex) const { return glm::floor(frame_.positions[vertex] / size_) * size_; }

    void add(std::uint32_t vertex) {
        if (blockOf_[vertex] != kNone)
            return;
        const glm::vec3 corner = cornerOf(vertex);
        const auto place = [&](int axis) { return static_cast<std::uint64_t>(std::max(0.0f, corner[axis] / size_)); };
        const auto number = numbers_.numberOf(place(0) | place(1) << 21 | place(2) << 42);
        if (number == positions.size()) {
            positions.emplace_back(0.0f);
            normals.emplace_back(0.0f);
            counts_.push_back(0);
            firsts_.push_back(vertex);
        }
        positions[number] += frame_.positions[vertex] - corner; // small numbers, so that sums lose nothing
        normals[number] += frame_.normals[vertex];
        ++counts_[number];
        blockOf_[vertex] = number;
    }

    void finish(std::size_t block) {
        positions[block] = positions[block] / static_cast<float>(counts_[block]) + cornerOf(firsts_[block]);
        const float length = glm::length(normals[block]);
        normals[block] = length > 1e-6f ? normals[block] / length : frame_.normals[firsts_[block]];
    }

    const extract::SurfaceFrame& frame_;
    float size_;
    BlockNumbers numbers_;
    std::vector<std::uint32_t> blockOf_;
    std::vector<std::uint32_t> counts_;
    std::vector<std::uint32_t> firsts_; ///< a vertex of each block
};

void keepTriangles(std::vector<std::uint32_t>& indices, const MergedVertices& merged) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const std::array<std::uint32_t, 3> corners{merged.blockOf(indices[i]), merged.blockOf(indices[i + 1]),
                                                   merged.blockOf(indices[i + 2])};
        if (!hasArea(corners.data()))
            continue;
        for (const auto corner : corners)
            indices[kept++] = corner;
    }
    indices.resize(kept);
}

} // namespace

void mergeVertices(extract::SurfaceFrame& frame, std::int64_t blockCells) {
    MergedVertices merged(frame, blockCells);
    keepTriangles(frame.indices, merged);
    keepTriangles(frame.changedIndices, merged);
    frame.positions = std::move(merged.positions);
    frame.normals = std::move(merged.normals);
    frame.mergedCells = blockCells;
}

void fitPicture(extract::SurfaceFrame& frame, std::uint64_t limitBytes) {
    if (extract::pictureBytes(frame) > limitBytes)
        extract::expandPicture(frame);
    const auto& dims = frame.geometry.dims;
    const std::int64_t longest = std::max({dims[0], dims[1], dims[2]});
    // Blocks of twice the size are made of whole smaller ones, so each step starts from the last.
    while (extract::pictureBytes(frame) > limitBytes && frame.mergedCells < longest)
        mergeVertices(frame, 2 * frame.mergedCells);
    if (frame.mergedCells > 1)
        frame.pieces.reset(); // they are of the vertices that were merged
}

} // namespace isoslider::model
