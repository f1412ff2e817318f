#include "core/extract/edge_block_source.h"

#include <algorithm>
#include <bit>

namespace isoslider::extract {

template <class Sample>
EdgeBlockSource<Sample>::EdgeBlockSource(const index::IndexReader& reader, std::uint64_t cacheBytes)
    : WalkedSource<Sample>(reader, cacheBytes), hiddenCorners_(reader) {}

template <class Sample>
Status EdgeBlockSource<Sample>::collect(KeyThreshold from, KeyThreshold to, ChangeSet<Live>& changes, SlideStats& stats,
                                        std::stop_token stop) {
    const KeyThreshold lower = std::min(from, to), upper = std::max(from, to);
    return walk_.visit(lower, upper, stats, stop, [&](const Part& part) {
        return emit(part, lower, upper, from < to, changes);
    });
}

template <class Sample>
std::size_t EdgeBlockSource<Sample>::emit(const Part& part, KeyThreshold lower, KeyThreshold upper, bool goesUp,
                                          ChangeSet<Live>& changes) const {
    typename ChangeSet<Live>::Lists& lists = changes.local();
    const BrickGrid& grid = reader_.grid();
    const index::DecodedPage<Key>& page = part.page;
    std::size_t edge = part.firstEntry;
    static constexpr int kLocalStride[3] = {1, 8, 64};
    for (std::size_t i = part.begin; i < part.end; ++i) {
        const PointId id = page.ids[i];
        const Key key = page.keys[i];
        const Live near = static_cast<Live>(sampleOfKey<Sample>(key));
        for (unsigned mask = page.masks[i]; mask != 0; mask &= mask - 1, ++edge) {
            const std::uint64_t farKey = page.farKeys[edge];
            if (farKey >= lower && farKey < upper)
                continue; // redundant: crossed at both ends
            const int e = std::countr_zero(mask);
            const int axis = e >> 1;
            const bool isUpward = e & 1;
            BrickIndex brick = static_cast<BrickIndex>(id / kBrickPoints);
            int local = static_cast<int>(id % kBrickPoints);
            if (!isUpward) { // the edge starts at the far end
                const bool leaves = (local / kLocalStride[axis] & 7) == 0;
                brick = static_cast<BrickIndex>(leaves ? brick - grid.brickStride(axis) : brick);
                local += (leaves ? 7 : -1) * kLocalStride[axis];
            }
            const LocalEdge localEdge = static_cast<LocalEdge>(axis * kBrickPoints + local);
            const unsigned partition = changes.partitionOf(brick);
            if ((farKey > key) != goesUp) {
                lists.deactivated[partition].push_back({brick, localEdge});
                continue;
            }
            const Live far = static_cast<Live>(sampleOfKey<Sample>(page.farKeys[edge]));
            if (isUpward)
                lists.activated[partition].push_back({near, far, brick, localEdge, page.normals[i], page.farNormals[edge]});
            else
                lists.activated[partition].push_back({far, near, brick, localEdge, page.farNormals[edge], page.normals[i]});
        }
    }
    return edge;
}

template class EdgeBlockSource<std::uint8_t>;
template class EdgeBlockSource<std::int8_t>;
template class EdgeBlockSource<std::uint16_t>;
template class EdgeBlockSource<std::int16_t>;
template class EdgeBlockSource<std::int32_t>;
template class EdgeBlockSource<float>;
template class EdgeBlockSource<double>;

} // namespace isoslider::extract
