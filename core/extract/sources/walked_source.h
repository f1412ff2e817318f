#pragma once

#include <algorithm>
#include <cstdint>

#include "core/extract/edge_interpolation.h"
#include "core/extract/sources/block_walk.h"
#include "core/extract/sources/change_source.h"

namespace isoslider::extract {

/// What the sources that walk a skip list have in common, whatever its records stand for.
template <class Sample>
class WalkedSource : public ChangeSource<LiveOf<Sample>> {
public:
    using Key = KeyOf<Sample>;
    using Live = LiveOf<Sample>;

    /// Entries on the way. With bricks, patching never looks at more of them than building it again does.
    std::uint64_t estimate(KeyThreshold from, KeyThreshold to) const override {
        return walk_.estimate(std::min(from, to), std::max(from, to));
    }
    bool isBlocked(KeyThreshold from, KeyThreshold to) const override {
        return walk_.isBlocked(std::min(from, to), std::max(from, to));
    }
    std::uint64_t partsLost() const override { return walk_.pagesLost(); }
    void setBuildsLevels(bool builds) override { walk_.setBuildsLevels(builds); }
    void waitForPrefetch() override { walk_.waitForLevels(); }
    KeyThreshold threshold(double isovalue) const override { return thresholdOf<Sample>(isovalue); }
    KeyThreshold lowest() const override { return 0; }
    KeyThreshold highest() const override { return KeyThreshold{keyOf(static_cast<Sample>(reader_.info().max))} + 1; }

protected:
    using Part = typename BlockWalk<Key>::Part;

    /// `reader` must outlive the source.
    WalkedSource(const index::IndexReader& reader, std::uint64_t cacheBytes, typename BlockWalk<Key>::SumUp sumUp)
        : reader_(reader), walk_(reader, cacheBytes, std::move(sumUp)) {}

    const index::IndexReader& reader_;
    BlockWalk<Key> walk_;
};

} // namespace isoslider::extract
