#include "core/index/validation/sample_survey.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/grid/classification.h"
#include "core/grid/distinct_keys.h"
#include "core/grid/scalar_key.h"
#include "core/index/format/chunk_grid.h"
#include "core/index/validation/missing_cell_lookup.h"
#include "core/index/validation/value_thresholds.h"

namespace isoslider::index {
namespace {

/// Layers of 16 planes, with one plane before and the layer after: all that cells and bricks of a layer reach.
template <class Sample>
class PlaneWindow {
public:
    PlaneWindow(const ComparedVolume& volume)
        : volume_(volume),
          dims_(volume.geometry.dims),
          plane_(static_cast<std::size_t>(dims_[0] * dims_[1])),
          samples_(plane_ * static_cast<std::size_t>(std::min<std::int64_t>(dims_[2] + 1, 2 * kChunkSide + 1))) {}

    /// Moves on to layer `layer`: 0, then the next ones in turn.
    Status advance(std::int64_t layer) {
        const std::int64_t begin = layer * kChunkSide, end = std::min(dims_[2], begin + 2 * kChunkSide);
        if (layer == 0) {
            begin_ = 0;
            filled_ = 0;
        } else { // keep the plane before the layer, and what of it is there
            const std::int64_t keepFrom = begin - 1;
            const auto from = static_cast<std::size_t>(keepFrom - begin_) * plane_,
                       to = static_cast<std::size_t>(filled_ - begin_) * plane_;
            std::copy(samples_.begin() + static_cast<std::ptrdiff_t>(from),
                      samples_.begin() + static_cast<std::ptrdiff_t>(to), samples_.begin());
            begin_ = keepFrom;
        }
        if (filled_ < end) {
            const auto at = static_cast<std::size_t>(filled_ - begin_) * plane_;
            const auto count = static_cast<std::size_t>(end - filled_) * plane_;
            ISO_TRY(volume_.read(filled_, end, std::as_writable_bytes(std::span(samples_).subspan(at, count))));
            filled_ = end;
        }
        return {};
    }
    Sample at(std::int64_t x, std::int64_t y, std::int64_t z) const { return row(y, z)[x]; }
    const Sample* row(std::int64_t y, std::int64_t z) const {
        return samples_.data() + static_cast<std::size_t>(z - begin_) * plane_ + static_cast<std::size_t>(y * dims_[0]);
    }

private:
    const ComparedVolume& volume_;
    GridDims dims_;
    std::size_t plane_;
    std::vector<Sample> samples_;
    std::int64_t begin_ = 0, filled_ = 0;
};

template <class Sample>
class SampleSurvey {
public:
    using Key = KeyOf<Sample>;

    SampleSurvey(const IndexReader& reader, const ComparedVolume& planes, const Level0Sums* sums, FaultList& faults,
                 const SurveyOptions& options)
        : reader_(reader),
          info_(reader.info()),
          grid_(reader.grid()),
          planes_(planes),
          sums_(sums),
          faults_(faults),
          options_(options),
          missing_(reader.meta().missingCells),
          thresholds_(info_),
          intervals_(grid_.brickCount()),
          distinct_(options.memoryBytes),
          countsEdges_(info_.kind == IndexKind::Metacells || !(info_.mergeError > 0.0)) {
        if (sums_ && sums_->pointKeys)
            pointKeys_.emplace(grid_.brickCount());
    }

    Status run(const JobControl& job) {
        ISO_TRY(pass(job.part(0.0, 0.9), true));
        while (!distinct_.endPass())
            ISO_TRY(pass(job.part(0.9, 1.0), false));
        compare();
        return {};
    }

private:
    struct Counts {
        Counts(std::size_t bins, std::size_t levels) : histogram(bins), curve(bins + 1), entries(levels) {}
        std::uint64_t finite = 0;
        double min = std::numeric_limits<double>::infinity(), max = -min;
        std::vector<std::uint64_t> histogram;
        std::vector<std::int64_t> curve;
        std::vector<std::uint64_t> entries; ///< that levels above 0 have of edges
    };

    Status pass(const JobControl& job, bool isFirst) {
        PlaneWindow<Sample> window(planes_);
        const GridDims& dims = grid_.dims();
        const std::int64_t layers = (dims[2] + kChunkSide - 1) / kChunkSide;
        tbb::enumerable_thread_specific<Counts> counts(info_.histogram.counts.size(), info_.levels.size());
        for (std::int64_t layer = 0; layer < layers; ++layer) {
            if (job.isStopRequested())
                return cancelledError();
            job.report(static_cast<double>(layer) / static_cast<double>(layers), "checking samples");
            ISO_TRY(window.advance(layer));
            const std::int64_t z0 = layer * kChunkSide, z1 = std::min(dims[2], z0 + kChunkSide);
            const std::int64_t rowsOfBricks = grid_.bricks()[1];
            tbb::parallel_for(std::int64_t{0}, rowsOfBricks, [&](std::int64_t by) {
                Counts& local = counts.local();
                for (std::int64_t bz = z0 / kBrickSide; bz * kBrickSide < z1; ++bz)
                    for (std::int64_t bx = 0; bx < grid_.bricks()[0]; ++bx)
                        takeBrick(window, {bx, by, bz}, isFirst ? &local : nullptr);
            });
        }
        if (isFirst)
            for (const Counts& local : counts)
                merge(local);
        return {};
    }

    void takeBrick(const PlaneWindow<Sample>& window, const std::array<std::int64_t, 3>& brick, Counts* counts) {
        std::array<std::int64_t, 3> begin{}, end{};
        for (std::size_t a = 0; a < 3; ++a) {
            begin[a] = brick[a] * kBrickSide;
            end[a] = std::min(grid_.dims()[a], begin[a] + kBrickSide);
        }
        for (std::int64_t z = begin[2]; z < end[2]; ++z)
            for (std::int64_t y = begin[1]; y < end[1]; ++y) {
                const Sample* row = window.row(y, z);
                distinct_.add(std::span(row + begin[0], static_cast<std::size_t>(end[0] - begin[0])));
                for (std::int64_t x = begin[0]; counts && x < end[0]; ++x)
                    takeSample(window, {x, y, z}, row[x], *counts);
            }
        if (!counts)
            return;
        const BrickIndex index = grid_.brickAt(brick[0], brick[1], brick[2]);
        compareMissingCells(window, index, begin, end);
        if (info_.kind == IndexKind::Metacells)
            takeInterval(window, index, begin);
    }

    void takeSample(const PlaneWindow<Sample>& window, const std::array<std::int64_t, 3>& at, Sample sample,
                    Counts& counts) {
        if (isMissing(sample))
            return;
        ++counts.finite;
        const double value = static_cast<double>(sample);
        counts.min = std::min(counts.min, value);
        counts.max = std::max(counts.max, value);
        if (value >= info_.min && value <= info_.max && !counts.histogram.empty())
            ++counts.histogram[binOf(value)];
        const Key key = keyOf(sample);
        const std::uint64_t id = grid_.pointId(at[0], at[1], at[2]).number();
        if (pointKeys_ && sums_->pointKeys->has(id))
            pointKeys_->add(id / kBrickPoints, PointKeySums::keyHash(id, key));
        if (!countsEdges_)
            return;
        for (int axis = 0; axis < 3; ++axis) {
            auto far = at;
            if (++far[static_cast<std::size_t>(axis)] >= grid_.dims()[static_cast<std::size_t>(axis)])
                continue;
            const Sample other = window.at(far[0], far[1], far[2]);
            if (isMissing(other) || keyOf(other) == key || !missing_.isEdgeUsable(grid_, at, axis))
                continue;
            const std::uint64_t otherKey = keyOf(other);
            ++counts.curve[thresholds_.firstAbove(std::min<std::uint64_t>(key, otherKey))];
            --counts.curve[thresholds_.firstAbove(std::max<std::uint64_t>(key, otherKey))];
            if (info_.kind == IndexKind::Edges)
                takeEdge({id, key}, {grid_.pointId(far[0], far[1], far[2]).number(), otherKey}, axis, counts);
        }
    }

    struct EdgeEnd {
        std::uint64_t id, key;
    };
    void takeEdge(const EdgeEnd& lower, const EdgeEnd& upper, int axis, Counts& counts) {
        const bool rises = upper.key > lower.key;
        intervals_.add(lower.id / kBrickPoints, edgeEndHash(lower.id, lower.key, 2 * axis + 1, rises));
        intervals_.add(upper.id / kBrickPoints, edgeEndHash(upper.id, upper.key, 2 * axis, !rises));
        const auto [least, greatest] = std::minmax(lower.key, upper.key);
        for (std::size_t level = 1; level < counts.entries.size(); ++level)
            counts.entries[level] += isRedundant(level, least, greatest) ? 0 : 2;
    }

    // Whether a level has both keys in one block.
    bool isRedundant(std::size_t level, std::uint64_t least, std::uint64_t greatest) const {
        const auto& blocks = reader_.meta().levels[level].blocks;
        const auto block =
            std::partition_point(blocks.begin(), blocks.end(), [&](const BlockEntry& b) { return b.lastKey < least; });
        return block != blocks.end() && block->firstKey <= least && greatest <= block->lastKey;
    }

    // The bin of FORMAT.md, in halves: max - min may overflow.
    std::size_t binOf(double value) const {
        const std::size_t bins = info_.histogram.counts.size();
        const double low = info_.min * 0.5, range = info_.max * 0.5 - low;
        if (!(range > 0.0))
            return 0;
        const double share = (value * 0.5 - low) / range;
        return std::min(bins - 1, static_cast<std::size_t>(share * static_cast<double>(bins)));
    }

    void compareMissingCells(const PlaneWindow<Sample>& window, BrickIndex brick,
                             const std::array<std::int64_t, 3>& begin, const std::array<std::int64_t, 3>& end) {
        if constexpr (!std::is_floating_point_v<Sample>) {
            if (reader_.meta().missingCells.empty())
                return;
        }
        for (std::int64_t z = begin[2]; z < std::min(end[2], grid_.dims()[2] - 1); ++z)
            for (std::int64_t y = begin[1]; y < std::min(end[1], grid_.dims()[1] - 1); ++y)
                for (std::int64_t x = begin[0]; x < std::min(end[0], grid_.dims()[0] - 1); ++x) {
                    bool lacksCorner = false;
                    for (int corner = 0; corner < 8; ++corner)
                        lacksCorner = lacksCorner ||
                                      isMissing(window.at(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)));
                    if (lacksCorner == missing_.isMissing(brick, localOf(grid_.pointId(x, y, z))))
                        continue;
                    IndexFault fault;
                    fault.part = "missing cells";
                    fault.problem = std::string("are not those of ") + options_.origin;
                    fault.box = faults_.boxOfBricks(brick.number(), brick.number());
                    faults_.add(std::move(fault));
                    return;
                }
    }

    // Over the 9^3 grid points at which a brick's edges end.
    void takeInterval(const PlaneWindow<Sample>& window, BrickIndex brick, const std::array<std::int64_t, 3>& begin) {
        Key least = std::numeric_limits<Key>::max(), greatest = 0;
        std::array<std::int64_t, 3> end{};
        bool hasEdge = false;
        for (std::size_t a = 0; a < 3; ++a) {
            end[a] = std::min(grid_.dims()[a], begin[a] + kBrickSide + 1);
            hasEdge = hasEdge || end[a] > begin[a] + 1;
        }
        for (std::int64_t z = begin[2]; z < end[2]; ++z)
            for (std::int64_t y = begin[1]; y < end[1]; ++y)
                for (std::int64_t x = begin[0]; x < end[0]; ++x)
                    if (const Sample sample = window.at(x, y, z); !isMissing(sample)) {
                        least = std::min(least, keyOf(sample));
                        greatest = std::max(greatest, keyOf(sample));
                    }
        if (least < greatest && hasEdge)
            intervals_.add(brick.number(), intervalHash(pointIn(brick, LocalPoint()).number(), least, greatest));
    }

    void merge(const Counts& local) {
        total_.finite += local.finite;
        total_.min = std::min(total_.min, local.min);
        total_.max = std::max(total_.max, local.max);
        total_.histogram.resize(local.histogram.size());
        total_.curve.resize(local.curve.size());
        for (std::size_t b = 0; b < local.histogram.size(); ++b)
            total_.histogram[b] += local.histogram[b];
        for (std::size_t b = 0; b < local.curve.size(); ++b)
            total_.curve[b] += local.curve[b];
        total_.entries.resize(local.entries.size());
        for (std::size_t level = 0; level < local.entries.size(); ++level)
            total_.entries[level] += local.entries[level];
    }

    void compare() {
        const auto refuse = [&](const char* part, const std::string& problem) {
            IndexFault fault;
            fault.part = part;
            fault.problem = problem + options_.origin;
            faults_.add(std::move(fault));
        };
        const auto missing = static_cast<std::uint64_t>(pointCount(grid_.dims())) - total_.finite;
        if (total_.finite > 0 && (total_.min != info_.min || total_.max != info_.max))
            refuse("value range", "is not that of ");
        if (missing != info_.nanCount)
            refuse("number of missing samples",
                   "is " + std::to_string(info_.nanCount) + ", not " + std::to_string(missing) + " as in ");
        if (distinct_.count() != info_.distinctValues)
            refuse("number of distinct values", "is " + std::to_string(info_.distinctValues) + ", not " +
                                                    std::to_string(distinct_.count()) + " as in ");
        if (total_.histogram != info_.histogram.counts)
            refuse("histogram", "is not that of ");
        if (countsEdges_)
            thresholds_.compareCurve(total_.curve, info_, faults_);
        if (!sums_ || !sums_->isWhole)
            return;
        if (pointKeys_)
            comparePointKeys();
        if (!countsEdges_)
            return;
        bool hasOthers = false;
        for (std::uint64_t part = 0; part < intervals_.parts(); ++part)
            if (intervals_.at(part) != sums_->intervals.at(part)) {
                hasOthers = true;
                IndexFault fault;
                fault.part = "level 0";
                fault.problem =
                    std::string(info_.kind == IndexKind::Edges ? "has other edges than " : "has other bricks than ") +
                    options_.origin;
                fault.box = faults_.boxOfBricks(intervals_.firstBrick(part), intervals_.lastBrick(part));
                faults_.add(std::move(fault));
            }
        if (info_.kind == IndexKind::Edges && !hasOthers)
            compareEntries();
    }

    void comparePointKeys() {
        const PartSums& stated = sums_->pointKeys->keys();
        for (std::uint64_t part = 0; part < stated.parts(); ++part)
            if (stated.at(part) != pointKeys_->at(part)) {
                IndexFault fault;
                fault.part = "level 0";
                fault.problem = std::string("has points of other values than ") + options_.origin;
                fault.box = faults_.boxOfBricks(stated.firstBrick(part), stated.lastBrick(part));
                faults_.add(std::move(fault));
            }
    }

    // Edges with both ends in one block add up to nothing: that a level has them shows by their number only.
    void compareEntries() {
        for (std::size_t level = 1; level < total_.entries.size(); ++level)
            if (total_.entries[level] != info_.levels[level].edges) {
                IndexFault fault;
                fault.part = "level " + std::to_string(level);
                fault.problem = "has " + std::to_string(info_.levels[level].edges) + " entries, where the edges of " +
                                options_.origin + " make " + std::to_string(total_.entries[level]);
                faults_.add(std::move(fault));
            }
    }

    const IndexReader& reader_;
    const IndexInfo& info_;
    const BrickGrid& grid_;
    const ComparedVolume& planes_;
    const Level0Sums* sums_;
    FaultList& faults_;
    const SurveyOptions& options_;
    MissingCellLookup missing_;
    ValueThresholds thresholds_;
    PartSums intervals_;
    std::optional<PartSums> pointKeys_; ///< of the points that have records
    DistinctKeys<Sample> distinct_;
    bool countsEdges_;
    Counts total_{0, 0};
};

} // namespace

Status surveySamples(const IndexReader& reader, const ComparedVolume& planes, const Level0Sums* sums, FaultList& faults,
                     const SurveyOptions& options, const JobControl& job) {
    return visitScalarType(reader.info().type, [&](auto sample) {
        return SampleSurvey<decltype(sample)>(reader, planes, sums, faults, options).run(job);
    });
}

} // namespace isoslider::index
