#include "core/mesh/soup_topology.h"

#include <algorithm>
#include <unordered_map>
#include <vector>

#include <tbb/parallel_sort.h>

#include "core/base/disjoint_sets.h"
#include "core/mesh/loop_control.h"

namespace isoslider::mesh {
namespace {

using Sets = DisjointSets<std::uint64_t>;

// Corner 3 * t + c is vertex c of triangle t, and also names the edge from it to the next vertex.
using Corner = std::uint64_t;

struct EdgeUse {
    std::uint64_t key; // smaller vertex in the high half, larger in the low half
    Corner corner;
    bool operator<(const EdgeUse& other) const { return key != other.key ? key < other.key : corner < other.corner; }
};

class Analysis {
public:
    Analysis(std::span<const Triangle> triangles, std::size_t vertexCount, const JobControl& job)
        : triangles_(triangles), vertexCount_(vertexCount), job_(job), fans_(3 * triangles.size()) {}

    Result<SoupTopology> run() {
        // Calls one after the other: GCC 12 with -fsanitize=bounds fails on an array of pointers to members.
        int done = 0;
        const auto begin = [&] {
            job_.report(done++ / 7.0, "checking");
            return !job_.isStopRequested();
        };
        if (begin())
            countDuplicates();
        if (begin())
            collectEdgeUses();
        if (begin())
            sortEdgeUses();
        if (begin())
            visitEdges();
        if (begin())
            countFans();
        if (begin())
            countComponents();
        if (begin())
            countBoundaryLoops();
        if (job_.isStopRequested())
            return cancelledError();
        return std::move(topology_);
    }

private:
    // A loop that stops leaves its step unfinished; run() notices.
    bool goesOn(std::size_t i) const {
        constexpr std::size_t kSteps = std::size_t{1} << 16;
        return i % kSteps != 0 || !job_.isStopRequested();
    }

    std::uint32_t vertexOf(Corner corner) const { return triangles_[corner / 3][corner % 3]; }
    static Corner next(Corner corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
    bool runsForward(Corner corner) const { return vertexOf(corner) < vertexOf(next(corner)); }
    // The corners of an edge use that lie at the edge's smaller and larger vertex.
    Corner smallerEnd(Corner corner) const { return runsForward(corner) ? corner : next(corner); }
    Corner largerEnd(Corner corner) const { return runsForward(corner) ? next(corner) : corner; }

    void countDuplicates() {
        std::vector<Triangle> sorted;
        sorted.reserve(triangles_.size());
        for (std::size_t t = 0; t < triangles_.size() && goesOn(t); ++t) {
            Triangle triangle = triangles_[t];
            if (!hasThreeVertices(triangle)) {
                ++topology_.trianglesWithRepeats;
                continue;
            }
            std::sort(triangle.begin(), triangle.end());
            sorted.push_back(triangle);
        }
        runStoppable(job_, [&] { tbb::parallel_sort(sorted.begin(), sorted.end()); });
        for (std::size_t i = 1; i < sorted.size(); ++i)
            topology_.duplicateTriangles += sorted[i] == sorted[i - 1];
    }

    void collectEdgeUses() {
        uses_.reserve(3 * triangles_.size());
        for (std::size_t t = 0; t < triangles_.size() && goesOn(t); ++t) {
            if (!hasThreeVertices(triangles_[t]))
                continue;
            for (Corner corner = 3 * t; corner < 3 * t + 3; ++corner) {
                const std::uint64_t a = vertexOf(corner), b = vertexOf(next(corner));
                uses_.push_back({std::min(a, b) << 32 | std::max(a, b), corner});
            }
        }
    }

    void sortEdgeUses() {
        runStoppable(job_, [this] { tbb::parallel_sort(uses_.begin(), uses_.end()); });
    }

    void visitEdges() {
        std::size_t edges = 0;
        for (std::size_t begin = 0, end = 0; begin < uses_.size() && goesOn(edges); begin = end, ++edges) {
            while (end < uses_.size() && uses_[end].key == uses_[begin].key)
                ++end;
            visitEdge(std::span(uses_).subspan(begin, end - begin));
        }
    }

    void visitEdge(std::span<const EdgeUse> uses) {
        ++topology_.edges;
        if (uses.size() == 1) {
            ++topology_.boundaryEdges;
            boundary_.push_back(uses[0].corner);
        }
        topology_.crowdedEdges += uses.size() > 2;
        std::size_t forward = 0;
        for (const EdgeUse& use : uses) {
            forward += runsForward(use.corner);
            fans_.unite(smallerEnd(uses[0].corner), smallerEnd(use.corner));
            fans_.unite(largerEnd(uses[0].corner), largerEnd(use.corner));
        }
        topology_.disagreeingEdges += forward > 1 || uses.size() - forward > 1;
    }

    void countFans() {
        std::vector<std::uint8_t> fansOfVertex(vertexCount_, 0);
        for (std::size_t i = 0; i < uses_.size() && goesOn(i); ++i) // every corner of a sound triangle starts one
            if (const Corner corner = uses_[i].corner; fans_.rootOf(corner) == corner) {
                std::uint8_t& fans = fansOfVertex[vertexOf(corner)];
                fans = static_cast<std::uint8_t>(std::min(fans + 1, 2));
            }
        for (const std::uint8_t fans : fansOfVertex) {
            topology_.usedVertices += fans > 0;
            topology_.verticesOfSeveralFans += fans > 1;
        }
    }

    void countComponents() {
        Sets vertices(vertexCount_);
        topology_.components = topology_.usedVertices;
        for (std::size_t i = 0; i < uses_.size() && goesOn(i); ++i) {
            const EdgeUse& use = uses_[i];
            const std::uint64_t a = vertices.rootOf(use.key >> 32), b = vertices.rootOf(use.key & 0xffffffffu);
            topology_.components -= a != b;
            vertices.unite(a, b);
        }
    }

    // Followed from fan to fan, not from vertex to vertex: two disks that touch in a point have two loops.
    void countBoundaryLoops() {
        uses_ = {}; // its memory is needed no more
        std::vector<std::uint64_t> fans;
        fans.reserve(2 * boundary_.size());
        for (const Corner corner : boundary_) {
            fans.push_back(fans_.rootOf(corner));
            fans.push_back(fans_.rootOf(next(corner)));
        }
        std::vector<std::uint64_t> known = fans;
        runStoppable(job_, [&] { tbb::parallel_sort(known.begin(), known.end()); });
        if (job_.isStopRequested())
            return;
        known.erase(std::unique(known.begin(), known.end()), known.end());
        const auto rank = [&](std::uint64_t fan) {
            return static_cast<std::uint64_t>(std::lower_bound(known.begin(), known.end(), fan) - known.begin());
        };
        Sets loops(known.size());
        topology_.boundaryLoops = known.size();
        for (std::size_t i = 0; i < fans.size() && goesOn(i); i += 2) {
            const std::uint64_t a = loops.rootOf(rank(fans[i])), b = loops.rootOf(rank(fans[i + 1]));
            topology_.boundaryLoops -= a != b;
            loops.unite(a, b);
        }
        nameLoops(loops, [&](std::size_t edge) { return rank(fans[2 * edge]); });
    }

    template <class FanRank>
    void nameLoops(Sets& loops, const FanRank& fanRankOf) {
        std::unordered_map<std::uint64_t, std::uint32_t> nameOfRoot;
        topology_.boundary.reserve(boundary_.size());
        for (std::size_t i = 0; i < boundary_.size() && goesOn(i); ++i) {
            const auto next = static_cast<std::uint32_t>(nameOfRoot.size());
            const std::uint32_t loop = nameOfRoot.try_emplace(loops.rootOf(fanRankOf(i)), next).first->second;
            topology_.boundary.push_back({vertexOf(boundary_[i]), vertexOf(Analysis::next(boundary_[i])), loop});
        }
    }

    std::span<const Triangle> triangles_;
    std::size_t vertexCount_;
    const JobControl& job_;
    Sets fans_;
    std::vector<EdgeUse> uses_;
    std::vector<Corner> boundary_;
    SoupTopology topology_;
};

} // namespace

Result<SoupTopology> analyseTopology(std::span<const Triangle> triangles, std::size_t vertexCount,
                                     const JobControl& job) {
    return Analysis(triangles, vertexCount, job).run();
}

} // namespace isoslider::mesh
