#include "core/extract/vertex_fans.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace isoslider::extract {
namespace {

/// The corners of triangles (3 * triangle + place) at each edge vertex, in ascending order.
struct CornersByVertex {
    std::vector<std::uint64_t> begin;
    std::vector<std::uint64_t> corners;

    explicit CornersByVertex(const SurfaceMesh& mesh) : begin(mesh.edgeIds.size() + 1, 0) {
        const std::size_t edgeVertices = mesh.edgeIds.size();
        for (const std::uint32_t vertex : mesh.triangles)
            if (vertex < edgeVertices)
                ++begin[vertex + 1];
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        corners.resize(begin.back());
        std::vector<std::uint64_t> next(begin.begin(), begin.end() - 1);
        for (std::size_t corner = 0; corner < mesh.triangles.size(); ++corner)
            if (mesh.triangles[corner] < edgeVertices)
                corners[next[mesh.triangles[corner]]++] = corner;
    }
    std::span<const std::uint64_t> at(std::size_t vertex) const {
        return std::span(corners).subspan(begin[vertex], begin[vertex + 1] - begin[vertex]);
    }
};

/// Numbers the fans at one vertex: fan[i] for its i-th corner. Returns how many there are. Triangles belong
/// together when they share a further vertex; a vertex has some twenty of them at most.
std::uint32_t findFans(const SurfaceMesh& mesh, std::span<const std::uint64_t> corners,
                       std::vector<std::uint32_t>& fan) {
    constexpr std::uint32_t kNone = ~std::uint32_t{0};
    fan.assign(corners.size(), kNone);
    const auto others = [&](std::size_t i) {
        const std::uint64_t first = corners[i] / 3 * 3, place = corners[i] % 3;
        return std::array{mesh.triangles[first + (place + 1) % 3], mesh.triangles[first + (place + 2) % 3]};
    };
    std::uint32_t count = 0;
    std::vector<std::size_t> open;
    for (std::size_t start = 0; start < corners.size(); ++start) {
        if (fan[start] != kNone)
            continue;
        fan[start] = count;
        open.assign(1, start);
        while (!open.empty()) {
            const auto here = others(open.back());
            open.pop_back();
            for (std::size_t i = 0; i < corners.size(); ++i) {
                const auto there = others(i);
                if (fan[i] == kNone &&
                    std::find_first_of(here.begin(), here.end(), there.begin(), there.end()) != here.end()) {
                    fan[i] = count;
                    open.push_back(i);
                }
            }
        }
        ++count;
    }
    return count;
}

struct SplitVertex {
    std::uint32_t vertex;
    std::vector<std::uint32_t> fan; ///< of each corner at it
    std::uint32_t fans;
};

// Unfinished once `job` is to stop.
std::vector<SplitVertex> findSplitVertices(const SurfaceMesh& mesh, const CornersByVertex& corners,
                                           const JobControl& job) {
    tbb::enumerable_thread_specific<std::vector<SplitVertex>> found;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.edgeIds.size(), 4096), [&](const auto& range) {
        std::vector<std::uint32_t> fan;
        if (job.isStopRequested())
            return;
        for (std::size_t v = range.begin(); v != range.end(); ++v)
            if (const std::uint32_t fans = findFans(mesh, corners.at(v), fan); fans > 1)
                found.local().push_back({static_cast<std::uint32_t>(v), fan, fans});
    });
    std::vector<SplitVertex> splits;
    for (std::vector<SplitVertex>& some : found)
        std::move(some.begin(), some.end(), std::back_inserter(splits));
    std::sort(splits.begin(), splits.end(), [](const auto& a, const auto& b) { return a.vertex < b.vertex; });
    return splits;
}

/// Repeats each vertex as often as it has fans.
template <class T>
void repeat(std::vector<T>& column, const std::vector<SplitVertex>& splits) {
    std::vector<T> repeated;
    std::size_t from = 0;
    for (const SplitVertex& split : splits) {
        repeated.insert(repeated.end(), column.begin() + static_cast<std::ptrdiff_t>(from),
                        column.begin() + static_cast<std::ptrdiff_t>(split.vertex));
        repeated.insert(repeated.end(), split.fans, column[split.vertex]);
        from = split.vertex + std::size_t{1};
    }
    repeated.insert(repeated.end(), column.begin() + static_cast<std::ptrdiff_t>(from), column.end());
    column = std::move(repeated);
}

} // namespace

std::size_t SurfaceMesh::activeEdgeCount() const {
    std::size_t count = edgeIds.empty() ? 0 : 1;
    for (std::size_t i = 1; i < edgeIds.size(); ++i)
        count += edgeIds[i] != edgeIds[i - 1];
    return count;
}

Status splitVerticesOfSeveralFans(SurfaceMesh& mesh, const JobControl& job) {
    const CornersByVertex corners(mesh);
    const std::vector<SplitVertex> splits = findSplitVertices(mesh, corners, job);
    if (job.isStopRequested())
        return cancelledError();
    if (splits.empty())
        return {};
    std::vector<std::uint32_t> newIndex(mesh.positions.size());
    std::uint32_t added = 0;
    auto next = splits.begin();
    for (std::size_t v = 0; v < newIndex.size(); ++v) {
        newIndex[v] = static_cast<std::uint32_t>(v) + added;
        if (next != splits.end() && next->vertex == v)
            added += next++->fans - 1;
    }
    for (std::uint32_t& vertex : mesh.triangles)
        vertex = newIndex[vertex];
    for (const SplitVertex& split : splits) {
        const auto at = corners.at(split.vertex);
        for (std::size_t i = 0; i < at.size(); ++i)
            mesh.triangles[at[i]] += split.fan[i];
    }
    repeat(mesh.positions, splits);
    repeat(mesh.normals, splits);
    repeat(mesh.edgeIds, splits);
    return {};
}

} // namespace isoslider::extract
