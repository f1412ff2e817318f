#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "core/extract/sample_reader.h"
#include "core/extract/virtual_array.h"
#include "core/extract/walked_source.h"
#include "core/index/index_reader.h"

namespace isoslider::extract {

/// Net edge changes from bricks of samples (the paper's metacells, section 3).
///
/// A brick owns the edges that start at its 8^3 points; their ends lie among 9^3 samples. It is active
/// at the thresholds between the least and the greatest of those, and only then has it active edges. So
/// bricks become active and inactive at values as edges do, and their skip list is the same list: a
/// record is a brick at its least (far key: greatest) or greatest key, a brick with both ends in a block's
/// interval is redundant there.
///
/// A move takes the net changes of the set of active bricks from the list. Bricks that leave are emptied
/// without being read; those that arrive are read whole. Of bricks active at both ends those are read
/// which have a sample in between: each active brick knows the next keys on either side of the
/// position, so the others cost the reading of 24 bytes. In a brick that is read, active edges at both
/// thresholds are found as bits, 64 at a time, and what differs is emitted, with normals from the samples.
///
/// Bricks are read in the order in which their samples lie, alternately forwards and backwards: what a
/// cache smaller than the surface still holds of the last move is used before it is put out.
///
/// Cost: O(log N + bricks that come, go or have a crossed sample) and 24 bytes per active brick.
template <class Sample>
class BrickSource final : public WalkedSource<Sample> {
public:
    using typename WalkedSource<Sample>::Key;
    using typename WalkedSource<Sample>::Live;
    using WalkedSource<Sample>::lowest;
    using WalkedSource<Sample>::highest;

    /// `bricks` is the list of brick changes; it and `samples` must outlive the source.
    BrickSource(const index::IndexReader& bricks, SampleReader<Sample>& samples, std::uint64_t cacheBytes);

    Status collect(KeyThreshold from, KeyThreshold to, ChangeSet<Live>& changes, SlideStats& stats, std::stop_token stop) override;
    /// Fetches the samples of bricks that arrive or are crossed, as far as there is room.
    void foresee(KeyThreshold from, KeyThreshold to) override;
    void settle() override {
        if (ahead_.joinable())
            ahead_.join();
    }
    void dropCaches() override {
        walk_.dropCaches();
        samples_.dropCaches();
    }
    Result<std::optional<double>> hiddenScalar(BrickIndex brick, LocalPoint cell, int corner) override;
    std::uint64_t hiddenBytesRead() const override { return hiddenBytesRead_.load(std::memory_order_relaxed); }

private:
    using typename WalkedSource<Sample>::Part;
    using WalkedSource<Sample>::reader_;
    using WalkedSource<Sample>::walk_;
    /// A brick with samples on both sides of the position, and the nearest keys: `up` is the least that is
    /// not below it, `down` the greatest that is.
    struct ActiveBrick {
        std::uint64_t up;
        std::uint64_t down;
        BrickIndex brick;
        bool isNew;
    };
    struct Scratch;

    Status changeActiveSet(KeyThreshold lower, KeyThreshold upper, bool goesUp, ChangeSet<Live>& changes, SlideStats& stats, std::stop_token stop);
    struct NetBricks {
        std::vector<BrickIndex> arrive, leave;
    };
    Status netBricks(KeyThreshold lower, KeyThreshold upper, bool goesUp, SlideStats& stats,
                     std::stop_token stop, NetBricks& net);
    static bool isCrossed(const ActiveBrick& brick, KeyThreshold from, KeyThreshold to) {
        return brick.isNew || (from < to ? brick.up < to : brick.down >= to);
    }
    std::vector<BrickIndex> inReadingOrder(std::vector<BrickIndex> bricks, KeyThreshold from, KeyThreshold to, bool backwards) const;
    Status readAhead(KeyThreshold from, KeyThreshold to, std::stop_token stop);
    void removeActive(BrickIndex brick);
    void emit(ActiveBrick& active, KeyThreshold from, KeyThreshold to, ChangeSet<Live>& changes,
              Scratch& scratch) const;

    SampleReader<Sample>& samples_;
    glm::vec3 inverseSpacing_;
    std::atomic<std::uint64_t> hiddenBytesRead_ = 0;
    std::vector<ActiveBrick> active_;
    VirtualArray<std::uint32_t> placeOf_; ///< in active_, by brick; one more, 0 for none
    bool readsBackwards_ = false;
    std::uint64_t bytesAhead_ = 0;
    std::jthread ahead_; ///< the last member: it uses the others
};

} // namespace isoslider::extract
