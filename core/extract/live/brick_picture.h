#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/extract/live/brick_points.h"
#include "core/extract/live/chunked_array.h"
#include "core/extract/live/edge_record.h"
#include "core/extract/live/run_arena.h"
#include "core/extract/live/vertex_code.h"
#include "core/extract/live/vertex_kernels.h"
#include "core/extract/surface_frame.h"

namespace isoslider::extract {

/// Where all that is drawn of the live bricks lies.
struct BrickArenas {
    explicit BrickArenas(ScalarType scalarType, bool withGroups = false) : type(scalarType), hasGroups(withGroups) {}
    /// Empty ones of the same kind.
    std::shared_ptr<BrickArenas> alike() const { return std::make_shared<BrickArenas>(type, hasGroups); }

    /// No brick's points lie on both sides of a multiple of 2^kPointChunkBits lines.
    static constexpr int kPointChunkBits = 20;

    const ScalarType type; ///< of the samples in `points`
    const bool hasGroups; ///< beside codes, for who wants all vertices as floats again and again
    ShortArena vertices; ///< VertexCode
    ShortArena indices;
    RunArena<InnerRecord, 4, 14> inner;
    RunArena<PointLine, 1, kPointChunkBits> points;
    const std::uint64_t series = nextSeries(); ///< no other arenas have the same number

    /// What the vertices of a run are made from, in a separate array, at the place that its codes have in theirs.
    template <class Live>
    VertexGroup<Live>* groupsFor(const ArenaRun& run) {
        auto& groups = groupsOf<Live>(*this);
        groups.grow((std::uint64_t{run.begin} + run.capacity) / kGroupSize);
        return groups.at(run.begin / kGroupSize);
    }
    template <class Live>
    const VertexGroup<Live>* groupsAt(std::uint32_t firstVertex) const {
        return groupsOf<Live>(*this).at(firstVertex / kGroupSize);
    }

    /// As those of RunArena: of all, of any, of those that are sparse.
    void clear() {
        vertices.clear();
        indices.clear();
        inner.clear();
        points.clear();
    }
    bool isSparse(std::uint64_t parts, std::uint64_t of) const {
        return vertices.isSparse(parts, of) || indices.isSparse(parts, of) || inner.isSparse(parts, of) ||
               points.isSparse(parts, of);
    }
    bool isEvacuating() const {
        return vertices.isEvacuating() || indices.isEvacuating() || inner.isEvacuating() || points.isEvacuating();
    }
    void evacuateSparse(std::uint64_t parts, std::uint64_t of) {
        const auto evacuate = [&](auto& arena) {
            if (arena.isSparse(parts, of))
                arena.evacuate();
        };
        evacuate(vertices);
        evacuate(indices);
        evacuate(inner);
        evacuate(points);
    }
    void finishEvacuation() {
        if (vertices.finishEvacuation()) {
            groups_.shrinkToPages(vertices.top() / kGroupSize);
            doubleGroups_.shrinkToPages(vertices.top() / kGroupSize);
        }
        indices.finishEvacuation();
        inner.finishEvacuation();
        points.finishEvacuation();
    }
    std::uint64_t usedBytes() const {
        return vertices.usedBytes() + indices.usedBytes() + inner.usedBytes() + points.usedBytes();
    }
    /// Below what belongs to a run or did so.
    std::uint64_t unusedBytes() const {
        return vertices.unusedBytes() + indices.unusedBytes() + inner.unusedBytes() + points.unusedBytes();
    }
    void trim() {
        vertices.trim();
        indices.trim();
        inner.trim();
        points.trim();
        groups_.shrink(vertices.top() / kGroupSize);
        doubleGroups_.shrink(vertices.top() / kGroupSize);
    }

private:
    template <class Live, class Arenas>
    static auto& groupsOf(Arenas& arenas) {
        if constexpr (std::is_same_v<Live, float>)
            return arenas.groups_;
        else
            return arenas.doubleGroups_;
    }
    // No run of codes lies on both sides of a chunk's end here either.
    template <class Live>
    using Groups = ChunkedArray<VertexGroup<Live>, ShortArena::kChunkBits - std::countr_zero(kGroupSize)>;
    Groups<float> groups_{ShortArena::kMost / kGroupSize};
    Groups<double> doubleGroups_{ShortArena::kMost / kGroupSize};
    static_assert(ShortArena::kGranule % kGroupSize == 0);
    static std::uint64_t nextSeries() {
        static std::atomic<std::uint64_t> last{0};
        return ++last;
    }
};

/// One brick of a picture. What it refers to never changes; a brick that changes gets others, and a new version.
struct PictureBrick {
    std::array<std::uint16_t, 3> place{}; ///< of the brick among bricks; its first grid point is 8 times that
    std::uint16_t vertexCount = 0;
    std::uint32_t firstVertex = 0; ///< a multiple of 32
    std::uint32_t firstIndex = 0;
    std::uint32_t indexCount = 0; ///< 0: nothing is drawn of it
    std::uint32_t version = 0; ///< the move that made it, or moved it or its points in memory
    std::uint32_t firstInner = 0; ///< of its vertices inside cells, which come last
    std::uint32_t firstPointLine = 0;
    std::uint32_t pointsVersion = 0;
    std::uint16_t innerCount = 0;

    std::array<std::int32_t, 3> origin() const {
        return {kCellSide * place[0], kCellSide * place[1], kCellSide * place[2]};
    }
    friend bool operator==(const PictureBrick&, const PictureBrick&) = default;
};

/// Triangles of one brick that the last move has changed: the next `indexCount` of BrickPicture::changedIndices().
struct ChangedTriangles {
    std::uint32_t slot;
    std::uint32_t indexCount;
};

/// The versions of the pictures that are still in use, and a table that one of them has left behind: the next picture
/// fills it again, where new memory would cost as much as filling it. Safe from any thread.
class PictureLeases {
public:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

    void take(std::uint32_t version) {
        const std::lock_guard lock(mutex_);
        versions_.insert(version);
    }
    void giveBack(std::uint32_t version, std::vector<PictureBrick>&& table) {
        const std::lock_guard lock(mutex_);
        versions_.erase(versions_.find(version));
        if (table.capacity() > table_.capacity())
            table_.swap(table);
    }
    std::vector<PictureBrick> takeTable() {
        const std::lock_guard lock(mutex_);
        return std::exchange(table_, {});
    }
    std::uint32_t oldest() const {
        const std::lock_guard lock(mutex_);
        return versions_.empty() ? kNone : *versions_.begin();
    }

private:
    mutable std::mutex mutex_;
    std::multiset<std::uint32_t> versions_;
    std::vector<PictureBrick> table_;
};

/// The live surface at one moment, to be drawn on any thread while the surface moves on: a table of bricks over arenas
/// that it shares with the surface. What a picture refers to is not used again until the picture is gone, so nothing
/// is copied but the table. Two pictures of one `series` differ in the bricks whose entries differ.
template <class Live>
class BrickPicture {
public:
    using Record = EdgeRecord<Live>;

    BrickPicture(std::shared_ptr<const BrickArenas> arenas, std::shared_ptr<PictureLeases> leases,
                 std::uint32_t version, std::vector<PictureBrick> bricks)
        : arenas_(std::move(arenas)), leases_(std::move(leases)), version_(version), bricks_(std::move(bricks)) {
        leases_->take(version_);
    }
    ~BrickPicture() { leases_->giveBack(version_, std::move(bricks_)); }
    BrickPicture(const BrickPicture&) = delete;
    BrickPicture& operator=(const BrickPicture&) = delete;

    /// By slot of the live surface.
    std::span<const PictureBrick> bricks() const { return bricks_; }
    const VertexCode* codes(const PictureBrick& brick) const { return arenas_->vertices.at(brick.firstVertex); }
    const std::uint16_t* indices(const PictureBrick& brick) const { return arenas_->indices.at(brick.firstIndex); }
    const InnerRecord* inner(const PictureBrick& brick) const { return arenas_->inner.at(brick.firstInner); }
    const PointLine* points(const PictureBrick& brick) const { return arenas_->points.at(brick.firstPointLine); }
    /// What the brick's vertices on edges are made from, where the surface keeps it (SlideOptions::keepsGroups); else
    /// null.
    const VertexGroup<Live>* groups(const PictureBrick& brick) const {
        return arenas_->hasGroups ? arenas_->template groupsAt<Live>(brick.firstVertex) : nullptr;
    }
    /// Of the samples of points.
    ScalarType type() const { return arenas_->type; }
    /// All that the brick's vertices are made from; `room` holds them.
    std::span<const Record> records(const PictureBrick& brick, std::vector<Record>& room) const;
    /// One past the last of each that any brick may have.
    std::uint64_t vertexEnd() const { return vertexEnd_; }
    std::uint64_t indexEnd() const { return indexEnd_; }
    std::uint64_t innerEnd() const { return innerEnd_; }
    std::uint64_t pointLineEnd() const { return pointLineEnd_; }
    /// Pictures of different series have no storage in common.
    std::uint64_t series() const { return arenas_->series; }

    /// Of the bricks that the last move has changed, or moved in memory: what a card that has the picture before needs.
    /// O(bricks).
    std::uint64_t newBytes() const {
        std::uint64_t bytes = 0;
        for (const PictureBrick& brick : bricks_)
            bytes += bytesOf(brick, brick.version == version_, brick.pointsVersion == version_);
        return bytes;
    }
    /// What a card needs of a brick whose triangles or points it does not have.
    std::uint64_t bytesOf(const PictureBrick& brick, bool triangles, bool points) const {
        std::uint64_t bytes = 0;
        if (triangles)
            bytes += brick.vertexCount * sizeof(VertexCode) + brick.indexCount * sizeof(std::uint16_t) +
                     brick.innerCount * sizeof(InnerRecord);
        if (points && brick.indexCount > 0)
            bytes += pointLineCount(scalarTypeSizeBytes(type())) * sizeof(PointLine);
        return bytes;
    }
    std::span<const ChangedTriangles> changedTriangles() const { return changedTriangles_; }
    std::span<const std::uint16_t> changedIndices() const { return changedIndices_; }

private:
    template <class>
    friend class LiveSurface;
    template <class L>
    friend std::shared_ptr<const BrickPicture<L>> separateCopy(const BrickPicture<L>& picture);

    std::shared_ptr<const BrickArenas> arenas_;
    std::shared_ptr<PictureLeases> leases_;
    std::uint32_t version_;
    std::vector<PictureBrick> bricks_;
    std::uint64_t vertexEnd_ = 0, indexEnd_ = 0, innerEnd_ = 0, pointLineEnd_ = 0;
    std::vector<ChangedTriangles> changedTriangles_;
    std::vector<std::uint16_t> changedIndices_;
};

/// The same bricks by slot in separate arenas, of another series, without what has changed: a picture kept while
/// the live surface moves on would keep all memory from use that the surface has given up since. O(bricks + vertices +
/// triangles), memory likewise. Throws std::bad_alloc.
template <class Live>
std::shared_ptr<const BrickPicture<Live>> separateCopy(const BrickPicture<Live>& picture);

/// Positions of a brick's vertices, grid index units.
void placesOf(const BrickPicture<float>& picture, const PictureBrick& brick, double isovalue,
              std::vector<glm::vec3>& places);
/// Positions and normals of some of a brick's vertices, as expandVertices() makes them: of those with the numbers
/// `which`, which ascend. REQUIRES: `positions` and `normals` have room for as many.
void expandSome(const BrickPicture<float>& picture, const PictureBrick& brick, std::span<const std::uint16_t> which,
                double isovalue, glm::vec3* positions, glm::vec3* normals);
/// Asks for what expandSome() will read.
void prefetchSome(const BrickPicture<float>& picture, const PictureBrick& brick, std::span<const std::uint16_t> which);
/// Positions and normals of all vertices as floats, brick by brick in the order of the table (those without triangles
/// left out): a brick's indices count from its first. O(vertices), several threads.
template <class Live>
void expandVertices(const BrickPicture<Live>& picture, double isovalue, std::vector<glm::vec3>& positions,
                    std::vector<glm::vec3>& normals);
/// Fills the arrays of `frame` from the picture at the frame's isovalue. O(vertices + triangles), several threads.
template <class Live>
void expandPicture(const BrickPicture<Live>& picture, SurfaceFrame& frame);
/// Turns a frame with a picture into one with arrays.
void expandPicture(SurfaceFrame& frame);

} // namespace isoslider::extract
