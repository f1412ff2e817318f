#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "core/extract/live/chunked_array.h"
#include "core/extract/live/one_leaf.h"
#include "core/extract/sources/block_walk.h"
#include "core/extract/sources/brick_activity.h"
#include "core/extract/sources/change_source.h"
#include "core/extract/sources/leaf_finding.h"
#include "core/extract/sources/lines_ahead.h"
#include "core/extract/sources/point_kernels.h"
#include "core/extract/sources/sample_kernels.h"
#include "core/extract/sources/sample_reader.h"
#include "core/index/index_reader.h"

namespace isoslider::extract {

/// Changes of the live surface from bricks of samples.
///
/// Which bricks are active comes from a skip list. That of metacells (the paper's section 3) is one of bricks: a brick
/// is active at the thresholds between the least and the greatest of its 9^3 samples, and only then has it active
/// edges. So bricks become active and inactive at values as edges do: a record is a brick at its least (far key:
/// greatest) or greatest key, a brick with both ends in a block's interval is redundant there. That of edges (section
/// 2) states which edges become active and inactive: a brick is active while it has some (BrickActivity).
///
/// A move takes the net changes of the set of active bricks from the list. Bricks that leave are dropped without being
/// read; those that arrive are read once and become the brick's points, as small as their type allows, with normals. Of
/// bricks active at both ends those change which have a sample in between: each knows the nearest keys on either side
/// of the position, so the others cost the reading of 16 bytes. A brick that changes is made from its signs, 64 points
/// at a time: see LIVE.md.
///
/// Where the list is damaged on every way to a threshold, the bricks active there are found from all samples, and from
/// there on those that come and go from the samples of the bricks that the list names.
///
/// Cost: O(log N + records on the way + bricks that come, go or have a crossed sample) and 16 bytes per active brick.
template <class Sample>
class BrickSource final : public ChangeSource<LiveOf<Sample>> {
public:
    using Key = KeyOf<Sample>;
    using Live = LiveOf<Sample>;
    using typename ChangeSource<Live>::Move;

    /// `list` states what becomes active and inactive, bricks or edges; it and `samples` must outlive the source.
    /// `listBound`: within which the cells were merged that edges carry vertices for.
    BrickSource(const index::IndexReader& list, SampleReader<Sample>& samples, std::uint64_t cacheBytes,
                const MergeBound& listBound = {});
    ~BrickSource() override;

    Status move(const Move& move, LiveSurface<Live>& surface, SlideStats& stats, const JobControl& control) override;
    void setMergeBound(const MergeBound& bound) override;
    void setRegion(const std::optional<BrickBox>& region) override {
        if (region == region_)
            return;
        ahead_ = {}; // it reads what the other one would need
        region_ = region;
        hasNewRegion_ = true;
    }
    /// Nothing but from an empty surface: bricks that stay are never dearer than bricks that arrive, whatever way the
    /// list is walked (isLookedUp()). Where that way is damaged, all samples.
    std::uint64_t estimate(KeyThreshold from, KeyThreshold to) const override {
        if (!isEnd(from))
            return 0;
        return isWayBlocked(from, to) ? reader_.grid().brickCount() * kBrickSide * kBrickSide * kBrickSide
                                      : estimateWay(from, to);
    }
    /// Never from an empty surface.
    bool isBlocked(KeyThreshold from, KeyThreshold to) const override { return !isEnd(from) && isWayBlocked(from, to); }
    std::uint64_t partsLost() const override { return walk_.pagesLost(); }
    void setBuildsLevels(bool builds) override { walk_.setBuildsLevels(builds); }
    KeyThreshold threshold(double isovalue) const override { return thresholdOf<Sample>(isovalue); }
    KeyThreshold lowest() const override { return 0; }
    KeyThreshold highest() const override { return KeyThreshold{keyOf(static_cast<Sample>(reader_.info().max))} + 1; }
    /// Reads the samples of bricks that will arrive, as far as there is room.
    void prefetch(KeyThreshold from, KeyThreshold to) override;
    void waitForPrefetch() override {
        if (ahead_.joinable())
            ahead_.join();
        walk_.waitForLevels();
    }
    std::uint64_t listBytes() const override { return walk_.memoryBytes(); }
    void dropCaches() override {
        walk_.dropCaches();
        samples_.dropCaches();
        sureCells_.release(0); // found again where they are wanted
    }

private:
    using Part = typename BlockWalk<Key>::Part;
    using Stored = StoredSample<Sample>;

    using Points = BrickPoints<Sample>;

    /// The nearest keys of a live brick, of those of its samples that its surface depends on: `up` is the least that
    /// is not below the position, `down` the greatest that is. A slot without a brick is never crossed.
    struct Watch {
        std::uint64_t up = ~std::uint64_t{0};
        std::uint64_t down = 0;
        bool isSet() const { return up != ~std::uint64_t{0} || down != 0; } ///< the brick has been made
    };
    struct Job {
        BrickSlot slot;
        bool isNew;
    };
    struct NetBricks {
        std::vector<BrickIndex> arrive, leave;
    };
    struct Scratch;
    class Corners;

    /// What a move does with each of its bricks.
    struct Work {
        bool (BrickSource::*make)(const Move&, LiveSurface<Live>&, const Job&, Scratch&); ///< false when samples are
                                                                                          ///< wanted that are not ready
        /// Asks for what is read first, or leaves it to others to do so.
        void (BrickSource::*prefetch)(const LiveSurface<Live>&, const Job&, LinesAhead&) const;
    };

    bool isEnd(KeyThreshold at) const { return at == lowest() || at == highest(); }
    bool isWayBlocked(KeyThreshold from, KeyThreshold to) const {
        return walk_.isBlocked(std::min(from, to), std::max(from, to));
    }
    std::uint64_t estimateWay(KeyThreshold from, KeyThreshold to) const {
        return walk_.estimate(std::min(from, to), std::max(from, to));
    }
    void reset();
    Status activeBricks(KeyThreshold at, SlideStats& stats, std::stop_token stop, NetBricks& net);
    bool isLookedUp(const Move& move) const;
    Status bricksBySamples(KeyThreshold at, SlideStats& stats, std::stop_token stop, NetBricks& net);
    Status netBricksBySamples(std::vector<BrickIndex> touched, KeyThreshold to, SlideStats& stats, std::stop_token stop,
                              NetBricks& net);
    Status findActive(std::vector<BrickIndex> among, KeyThreshold at, SlideStats& stats, std::stop_token stop,
                      std::vector<BrickIndex>& active);
    bool isInRegion(BrickIndex brick) const { return !region_ || region_->contains(reader_.grid().brickCoords(brick)); }
    Status netBricks(KeyThreshold lower, KeyThreshold upper, bool goesUp, bool isAhead, SlideStats& stats,
                     std::stop_token stop, NetBricks& net);
    Status lookUpBricks(const Move& move, const LiveSurface<Live>& surface, SlideStats& stats, std::stop_token stop,
                        NetBricks& net);
    Status changeActiveSet(const Move& move, LiveSurface<Live>& surface, SlideStats& stats, std::stop_token stop,
                           std::vector<Job>& jobs);
    void listCrossed(const Move& move, const LiveSurface<Live>& surface, std::vector<Job>& jobs,
                     std::vector<BrickSlot>& refreshed) const;
    Status runJobs(const Move& move, LiveSurface<Live>& surface, std::vector<Job> jobs, SlideStats& stats,
                   const JobControl& control, const Work& work);
    Status runMerging(const Move& move, LiveSurface<Live>& surface, std::vector<Job> jobs, SlideStats& stats,
                      const JobControl& control);
    void prefetchPoints(const LiveSurface<Live>& surface, const Job& job, LinesAhead& ahead) const;
    void prefetchForLeaves(const LiveSurface<Live>& surface, const Job& job, LinesAhead& ahead) const;
    bool rebuild(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch);
    void makeUnmerged(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch);
    void addOtherLeaves(BrickSlot slot, Scratch& scratch);
    bool findLeaves(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch);
    bool rebuildMerged(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch);
    void makeOneLeaf(const Move& move, LiveSurface<Live>& surface, const Job& job, const OneLeaf& leaf,
                     Scratch& scratch);
    void prefetchMerged(const LiveSurface<Live>& surface, const Job& job, LinesAhead& ahead) const;
    SureCells& sureCellsOf(BrickSlot slot) { return sureCells_[brickOf_[slot.index()].index()]; }
    const SureCells& sureCellsOf(BrickSlot slot) const { return sureCells_[brickOf_[slot.index()].index()]; }
    BrickLeaves& leavesOf(BrickSlot slot) { return leavesOf_[brickOf_[slot.index()].index()]; }
    const BrickLeaves& leavesOf(BrickSlot slot) const { return leavesOf_[brickOf_[slot.index()].index()]; }
    void addBricksBeside(const LiveSurface<Live>& surface, std::vector<Job>& jobs) const;
    bool begin(const LiveSurface<Live>& surface, const Job& job, Scratch& scratch) const;
    void finish(const Move& move, LiveSurface<Live>& surface, const Job& job, Scratch& scratch);
    void compareEdgeCount(const LiveSurface<Live>& surface, const Job& job, Scratch& scratch) const;
    static const Points& pointsOf(const LiveSurface<Live>& surface, const Job& job, const Scratch& scratch);
    std::optional<BitsInMemory> aboveBefore(const LiveSurface<Live>& surface, const Job& job,
                                            const Scratch& scratch) const;
    void classifyFor(const Move& move, const LiveSurface<Live>& surface, const Job& job, Scratch& scratch) const;
    void sortForReading(std::vector<BrickIndex>& bricks, bool backwards) const;
    Status readAhead(KeyThreshold from, KeyThreshold to, std::stop_token stop);

    const index::IndexReader& reader_;
    bool isListOfEdges_; ///< else of bricks
    BrickActivity<Key> activity_;
    bool hasCounts_ = false; ///< its counts are those of the position
    BlockWalk<Key> walk_; ///< uses activity_, also from a separate thread
    SampleReader<Sample>& samples_;
    glm::vec3 inverseSpacing_;
    MergeBound listBound_; ///< of the cells whose edges the list has
    ChunkedArray<std::uint32_t, 16> slotOf_; ///< by brick; one more than the slot, 0 for none
    std::vector<Watch> watch_; ///< by slot
    std::vector<BrickIndex> brickOf_; ///< by slot, where there is a brick
    MergeBound bound_;
    bool hasNewBound_ = false; ///< since the last move
    std::optional<BrickBox> region_; ///< of the bricks that are live; none: all
    bool hasNewRegion_ = false; ///< since the last move
    /// By brick, while cells are merged: leavesOfSurface(); those of a brick that is not live are none. So what lies
    /// around a brick is found without a look at slots.
    VirtualArray<BrickLeaves> leavesOf_;
    std::vector<BrickLeaves> usableLeaves_; ///< by slot, likewise; else empty, as is shownLeaves_
    VirtualArray<SureCells> sureCells_; ///< by brick, of those that have been live with this bound:
    MergeBound sureBound_;
    ChunkedArray<LeafEdgeSamples<Stored>, 10> edgeSamples_; ///< by slot, where isOneLeaf_
    ChunkedArray<ExceedingEdges, 10> exceedingEdges_; ///< by slot, of the others
    /// What findLeaves() has read of a brick's samples, for rebuildMerged() of the same move.
    struct FoundSigns {
        BitString above;
        Stored up, down;
        std::uint32_t move = 0; ///< as moves_ counts
    };
    ChunkedArray<FoundSigns, 10> foundSigns_; ///< by slot
    std::uint32_t moves_ = 0;
    std::vector<BrickLeaves> shownLeaves_; ///< by slot: those that its surface was made with
    std::vector<std::uint8_t> isOneLeaf_; ///< by slot, as sureCells_ has it
    std::vector<std::uint8_t> isMadeOfEdges_; ///< by slot: by makeOneLeaf(), which leaves no signs in the surface
    bool readsBackwards_ = false;
    std::uint64_t bytesAhead_ = 0;
    std::unique_ptr<tbb::enumerable_thread_specific<Scratch>> scratches_;
    std::jthread ahead_; ///< the last member: it uses the others
};

} // namespace isoslider::extract
