#include "core/topology/topology_analysis.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "core/base/process_memory.h"
#include "core/base/scratch_file.h"
#include "core/topology/analysis/analysis_memory.h"
#include "core/topology/analysis/coarse_counts.h"
#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/distinct_growth.h"
#include "core/topology/analysis/domain_boundary.h"
#include "core/topology/analysis/isovalue_sums.h"
#include "core/topology/analysis/layer_window.h"
#include "core/topology/analysis/side_graph.h"
#include "core/topology/analysis/spread_cubes.h"
#include "core/topology/analysis/strip_changes.h"
#include "core/topology/analysis/strip_components.h"
#include "core/topology/analysis/strip_cut.h"
#include "core/topology/analysis/strip_measures.h"
#include "core/topology/event_assembly.h"

namespace isoslider::topology {
namespace {

// Noise of 32 bits, for each sample; there is hardly a volume with more. More memory than that is not asked after.
constexpr Findings kMostFindings{1.25, 0.8, 0.4, 1.6, 0.0};
constexpr double kMostBytesPerSample = 768.0;
constexpr double kBoundaryBytesPerPoint = 40.0;

// Where counts are made if there are no events: where surfaces are measured, and between.
std::vector<double> coarseIsovalues(const MeasurePlan& plan) {
    constexpr int kSteps = 2048; // enough for every pixel of a plot
    std::vector<double> isovalues = plan.isovalues;
    const auto [low, high] = plan.usual;
    for (int i = 0; i <= kSteps; ++i) {
        const double part = static_cast<double>(i) / kSteps;
        isovalues.push_back(std::clamp(low * (1.0 - part) + high * part, plan.least, plan.greatest));
    }
    isovalues.insert(isovalues.end(), {plan.least, plan.greatest});
    std::sort(isovalues.begin(), isovalues.end());
    isovalues.erase(std::unique(isovalues.begin(), isovalues.end()), isovalues.end());
    return isovalues;
}

enum class Detail { Events, Counts };

template <class Sample>
class Analysis {
public:
    Analysis(const PlaneSource& source, const AnalysisOptions& options, Detail detail, const JobControl& job)
        : source_(source),
          options_(options),
          job_(job),
          dims_(source.geometry.dims),
          aimBytes_(aimBytes()),
          changesFile_(scratchFile()),
          cut_(source.geometry.dims, {options.planesAtOnce, options.rowsAtOnce, detail == Detail::Counts}) {
        if (detail == Detail::Counts)
            coarse_ = std::make_unique<CoarseCounts>(coarseIsovalues(options.measures), options.boundaryPointsAtOnce);
    }

    Result<TopologyCurve> run() {
        if (std::min({dims_[0], dims_[1], dims_[2]}) < 2)
            return TopologyCurve(); // no cells, no surface
        ISO_TRY(planMemory());
        tbb::parallel_pipeline(
            stripsAtOnce_,
            tbb::make_filter<void, std::shared_ptr<Part>>(tbb::filter_mode::serial_in_order,
                                                          [this](tbb::flow_control& flow) { return next(flow); }) &
                tbb::make_filter<std::shared_ptr<Part>, std::shared_ptr<Part>>(tbb::filter_mode::parallel,
                                                                               [this](std::shared_ptr<Part> part) {
                                                                                   if (!job_.isStopRequested())
                                                                                       analyse(*part);
                                                                                   return part;
                                                                               }) &
                tbb::make_filter<std::shared_ptr<Part>, void>(
                    tbb::filter_mode::serial_in_order, [this](const std::shared_ptr<Part>& part) { add(*part); }));
        spare_.clear();
        kept_ = {};
        returnFreeBlocks(); // what follows takes others
        if (job_.isStopRequested())
            return cancelledError();
        ISO_TRY(problem_);
        return coarse_ ? coarseCurve() : assemble();
    }

private:
    // ---- before: what it will take

    Error tooLarge(double bytes) const {
        const auto megabytes = [](double of) { return std::to_string(static_cast<std::uint64_t>(of) >> 20) + " MB"; };
        return makeError(ErrorCode::OutOfSpace, "topology takes about " + megabytes(bytes + (1 << 20)) +
                                                    " of memory here, and may use " +
                                                    megabytes(static_cast<double>(options_.memoryBytes)));
    }

    bool hasScratch() const { return !options_.scratch.empty(); }
    std::shared_ptr<ScratchFile> scratchFile() const {
        return hasScratch() ? std::make_shared<ScratchFile>(options_.scratch, *options_.fileSystem) : nullptr;
    }
    // What is to be taken: with a scratch file less than may be.
    double aimBytes() const {
        constexpr double kLeast = 80 << 20; // for which thicker layers save time
        const double most = static_cast<double>(options_.memoryBytes);
        const double each = static_cast<double>(kBytesPerSample) * static_cast<double>(pointCount(dims_));
        return hasScratch() ? std::min(most, std::max(kLeast, each)) : most;
    }
    // There are five large kinds of changes and some small ones; each is held some 1.5 times where it is sorted.
    ChangeStore store() const { return {changesFile_.get(), static_cast<std::size_t>(aimBytes_ / 64.0)}; }
    std::size_t mostEventBytes() const { return static_cast<std::size_t>(aimBytes_ / 4.0); } // the rest in the file
    double keptBytes(const Findings& found) const {
        return hasScratch() ? std::min(found.keptBytes(), aimBytes_ / 8.0) : found.keptBytes();
    }
    // From when all layers are put together until events are stored.
    double assemblyBytes(double kept, double eulerChanges) const {
        const double events = eventBytes(eulerChanges);
        return 1.25 * kept + (hasScratch() ? std::min(events, static_cast<double>(mostEventBytes())) : events);
    }

    // On the disk, as far as the system reports it. Noise may need many times what its volume does.
    Status checkRoom() const {
        const std::filesystem::path folder = options_.scratch.parent_path();
        const auto space = options_.fileSystem->space(folder.empty() ? "." : folder);
        // The file of changes is gone when the index gets its events; pages that memory does not hold are there with
        // both. Most events take half of what they may.
        const double events = 0.5 * eventBytes(expected_.euler);
        const double pages = std::max(0.0, events - static_cast<double>(mostEventBytes())),
                     changes = std::max(0.0, expected_.keptBytes() - static_cast<double>(store().mostBytes));
        if (!space.isOk() || pages + std::max(changes, events) <= static_cast<double>(space.value().freeBytes))
            return {};
        return makeError(ErrorCode::OutOfSpace, "what is found of the topology does not fit on the disk",
                         options_.scratch.string());
    }

    // Cubes spread over the volume state how much there is in it: where that is hopeless it shows at once.
    Status planMemory() {
        const auto points = static_cast<double>(pointCount(dims_)), memory = static_cast<double>(options_.memoryBytes);
        Findings each = kMostFindings;
        const bool isTight = aimBytes_ < kMostBytesPerSample * points;
        expected_ = each * points;
        // Half as many cubes tell enough of a small volume, where the disk holds the most that there can be.
        constexpr double kSmall = 1 << 23;
        const bool isRoomy = hasScratch() && !coarse_ && points < kSmall && checkRoom().isOk();
        if (isTight)
            ISO_TRY(lookAt({.levels = isRoomy ? 4 : 8}, each, expected_));
        if (hasScratch() && !coarse_) {
            ISO_TRY(checkRoom());
            if (expected_.keptBytes() > static_cast<double>(store().mostBytes))
                ISO_TRY(changesFile_->begin());
        }
        if (coarse_) {
            each.changes = 0.0;
            expected_ = {};
        }
        const auto sides = static_cast<double>(dims_[0] * dims_[1] + dims_[1] * dims_[2] + dims_[2] * dims_[0]);
        expected_.boundaryBytes = coarse_ ? 0.0 : 2.0 * sides * kBoundaryBytesPerPoint;
        const auto bytesOf = [&](double strips) { return cut_.bytes(strips, sizeof(Sample), each); };
        // What threads have given back to the allocator, and it not to the system, is memory of the process, too.
        constexpr double kPlanned = 0.7;
        const double kept = isTight ? keptBytes(expected_) : 0.0, room = std::min(aimBytes_, kPlanned * memory) - kept;
        const auto threads = static_cast<double>(tbb::this_task_arena::max_concurrency());
        // Two small strips at once take less time than a large one.
        const double wanted = hasScratch() ? std::min(2.0, threads) : 1.0;
        while (bytesOf(wanted) > room && cut_.shrink(wanted, sizeof(Sample), each))
            continue;
        neededBytes_ = std::max(assemblyBytes(kept, expected_.euler), kept + bytesOf(1.0));
        constexpr double kUncertainty = 1.25;
        if (isTight && (neededBytes_ > kUncertainty * memory || bytesOf(1.0) > memory))
            return tooLarge(neededBytes_);
        if (isTight && !coarse_ && !hasScratch()) { // grown step by step they would be held twice for a while
            constexpr double kMore = 1.25; // than expected; those that come and are not summed up yet
            euler_.reserve(kMore * distinct_[0]);
            above_.sums().births.reserve(kMore * distinct_[1]);
            above_.sums().joins.reserve(kMore * distinct_[2]);
            below_.sums().births.reserve(kMore * distinct_[3]);
            below_.sums().joins.reserve(kMore * distinct_[4]);
        }
        // A strip for each thread, and one that is read or put together; fewer where memory is scarce.
        while (static_cast<double>(stripsAtOnce_) <= threads && bytesOf(static_cast<double>(stripsAtOnce_ + 1)) <= room)
            ++stripsAtOnce_;
        return {};
    }

    // What is in a cube.
    struct Seen {
        Findings found;
        double cells = 0.0;
        std::array<std::vector<double>, 5> isovalues; ///< of each kind of changes
    };
    static Seen lookAtCube(const LayerWindow<Sample>& window) {
        Seen seen;
        seen.cells = static_cast<double>((window.dims[0] - 1) * (window.dims[1] - 1) * (window.dims[2] - 1));
        const auto note = [&](std::size_t kind, const auto& changes) {
            for (const auto& change : changes)
                seen.isovalues[kind].push_back(change.isovalue);
            return static_cast<double>(changes.size());
        };
        const Strip whole = window.wholeStrip();
        StripSide above(Side::Above), below(Side::Below);
        above.flood(window, whole);
        below.flood(window, whole);
        seen.found.euler = note(0, findStripChanges(window, whole, above, below).euler);
        std::size_t kind = 1;
        for (StripSide* each : {&above, &below}) {
            seen.found.seeds += static_cast<double>(each->seedCount());
            seen.found.links += static_cast<double>(each->linkCount());
            const ComponentHistory settled = each->takeSettled(window, whole).settled;
            seen.found.changes += note(kind++, settled.births);
            seen.found.changes += note(kind++, settled.joins);
        }
        return seen;
    }

    // `each`: of a cell, on average; `all`: of all layers, where changes of one isovalue are summed up.
    Status lookAt(const SpreadCubes& spread, Findings& each, Findings& all) {
        auto cubes = lookAtCubes<Seen, Sample>(
            source_, spread, job_,
            [](const LayerWindow<Sample>& window, const std::array<std::int64_t, 3>&) { return lookAtCube(window); });
        if (!cubes.isOk())
            return std::move(cubes).error();
        each = {};
        double cells = 0.0;
        for (const Seen& seen : cubes.value()) {
            each = each + seen.found;
            cells += seen.cells;
        }
        each = each * (1.0 / cells);
        const double points = static_cast<double>(pointCount(dims_));
        tbb::parallel_for(std::size_t{0}, distinct_.size(), [&](std::size_t kind) {
            std::vector<std::vector<double>> isovalues;
            for (Seen& seen : cubes.value())
                isovalues.push_back(std::move(seen.isovalues[kind]));
            distinct_[kind] = distinctInAll(isovalues, points / cells);
        });
        all = each * points;
        all.euler = distinct_[0];
        all.changes = distinct_[1] + distinct_[2] + distinct_[3] + distinct_[4];
        return {};
    }

    void fail(Status status) {
        const std::lock_guard lock(problemMutex_);
        problem_ = std::move(status);
        hasFailed_ = true;
    }

    struct Layer {
        LayerWindow<Sample> window;
        BoundaryPart boundary;
    };
    struct Part { // of a layer: a strip
        std::shared_ptr<Layer> layer;
        Strip strip;
        StripChanges changes;
        StripComponents above, below;
        MeasureSums measures;
        std::pair<double, double> range; ///< of samples with cells

        bool isLast() const { return layer->window.isLast(strip); }
    };

    // What a strip is worked on with, and the memory of it, serves others after it.
    struct Workspace {
        StripSide above{Side::Above}, below{Side::Below};
    };
    std::unique_ptr<Workspace> takeWorkspace() {
        const std::lock_guard lock(spareMutex_);
        if (spare_.empty())
            return std::make_unique<Workspace>();
        auto workspace = std::move(spare_.back());
        spare_.pop_back();
        return workspace;
    }
    void giveBack(std::unique_ptr<Workspace> workspace) {
        const std::lock_guard lock(spareMutex_);
        spare_.push_back(std::move(workspace));
    }

    // ---- in turn: reading

    std::shared_ptr<Part> next(tbb::flow_control& flow) {
        if (!layer_ && zBegin_ + 1 < dims_[2] && !job_.isStopRequested() && !hasFailed_)
            readLayer();
        if (!layer_ || job_.isStopRequested() || hasFailed_) {
            flow.stop();
            return {};
        }
        auto part = std::make_shared<Part>();
        part->layer = layer_;
        part->strip = cut_.stripAt(nextStrip_++);
        if (part->isLast())
            layer_.reset();
        return part;
    }

    void readLayer() {
        auto layer = std::make_shared<Layer>();
        LayerWindow<Sample>& window = layer->window;
        const std::int64_t step = dims_[0] * dims_[1];
        // The last plane read lies beyond the layer, but at the end of the grid.
        const std::int64_t read = std::min(dims_[2], readEnd_ + cut_.planes());
        window.dims = dims_;
        window.stop = job_.stop;
        window.zBegin = zBegin_;
        window.zEnd = read == dims_[2] ? read - 1 : read - 2;
        window.firstPlane = std::max<std::int64_t>(0, zBegin_ - 1);
        window.samples.resize(static_cast<std::size_t>(step * (read - window.firstPlane)));
        std::copy(kept_.begin(), kept_.end(), window.samples.begin());
        const auto fresh =
            std::span(window.samples).subspan(static_cast<std::size_t>(step * (readEnd_ - window.firstPlane)));
        if (Status status = source_.read(readEnd_, read, std::as_writable_bytes(fresh)); !status.isOk())
            return fail(std::move(status));
        readEnd_ = read;
        zBegin_ = window.zEnd;
        const std::int64_t keepFrom = std::max<std::int64_t>(0, zBegin_ - 1);
        kept_.assign(window.samples.begin() + static_cast<std::ptrdiff_t>(step * (keepFrom - window.firstPlane)),
                     window.samples.end());
        window.prepare();
        layer_ = std::move(layer);
        nextStrip_ = 0;
    }

    // ---- at once: strips

    // What does not depend on each other at once, too: there may be few strips, and the last ones are alone.
    void analyse(Part& part) {
        Layer& layer = *part.layer;
        tbb::parallel_invoke([&] { findChanges(part); },
                             [&] {
                                 part.range = rangeOf(layer.window, part.strip);
                                 part.measures =
                                     measureStrip(layer.window, part.strip, options_.measures, source_.geometry);
                             },
                             [&] {
                                 if (part.strip.yBegin == 0)
                                     layer.boundary = BoundaryPart::of(layer.window);
                             });
    }

    void findChanges(Part& part) {
        const LayerWindow<Sample>& window = part.layer->window;
        std::unique_ptr<Workspace> workspace = takeWorkspace();
        StripSide &above = workspace->above, &below = workspace->below;
        tbb::parallel_invoke([&] { above.flood(window, part.strip); }, [&] { below.flood(window, part.strip); });
        part.changes = findStripChanges(window, part.strip, above, below);
        const auto take = [&](StripSide& side) {
            return coarse_ ? side.takeForest() : side.takeSettled(window, part.strip);
        };
        tbb::parallel_invoke([&] { part.above = take(above); }, [&] { part.below = take(below); });
        giveBack(std::move(workspace));
    }

    static std::pair<double, double> rangeOf(const LayerWindow<Sample>& window, const Strip& strip) {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        std::pair range(kInfinity, -kInfinity);
        for (std::int64_t z = window.zBegin; z <= window.zEnd; ++z) {
            const std::int64_t first = window.planeStep() * (z - window.zBegin);
            for (std::int64_t at = first + window.rowStep() * strip.yBegin;
                 at < first + window.rowStep() * (strip.yEnd + 1); ++at)
                if (window.stars[static_cast<std::size_t>(at)] != 0) {
                    const auto scalar = static_cast<double>(window.layer()[at]);
                    range = {std::min(range.first, scalar), std::max(range.second, scalar)};
                }
        }
        return range;
    }

    // ---- in turn: putting together

    void add(Part& part) {
        if (job_.isStopRequested() || hasFailed_)
            return;
        measures_.add(part.measures);
        part.layer->boundary.add(part.changes);
        if (coarse_)
            addCoarsely(part);
        else
            addWhole(part);
        job_.report(0.8 * doneBy(part), "analysing topology");
    }
    // Of all cells.
    double doneBy(const Part& part) const {
        const LayerWindow<Sample>& window = part.layer->window;
        const double ofLayer = static_cast<double>(part.strip.yEnd) / static_cast<double>(dims_[1] - 1);
        return (static_cast<double>(window.zBegin) + static_cast<double>(window.zEnd - window.zBegin) * ofLayer) /
               static_cast<double>(dims_[2] - 1);
    }

    void addWhole(Part& part) {
        const LayerWindow<Sample>& window = part.layer->window;
        std::array<Status, 4> statuses;
        tbb::parallel_invoke([&] { statuses[0] = above_.add(part.above, window, part.strip); },
                             [&] { statuses[1] = below_.add(part.below, window, part.strip); },
                             [&] { statuses[2] = euler_.add(part.changes.euler); },
                             [&] {
                                 if (part.isLast())
                                     statuses[3] = boundary_.add(part.layer->boundary);
                             });
        Status status = firstProblem(statuses);
        const double kept = static_cast<double>(euler_.count() * sizeof(EulerChange) + above_.sums().sizeBytes() +
                                                below_.sums().sizeBytes() + boundary_.sizeBytes());
        const double bytes = assemblyBytes(kept, static_cast<double>(euler_.count() + euler_.spilledCount()));
        if (status.isOk() && bytes > static_cast<double>(options_.memoryBytes))
            status = tooLarge(std::max(neededBytes_, bytes / doneBy(part)));
        if (!status.isOk())
            fail(std::move(status));
        least_ = std::min(least_, part.range.first);
        greatest_ = std::max(greatest_, part.range.second);
    }

    static Status firstProblem(std::span<Status> statuses) {
        const auto first =
            std::find_if(statuses.begin(), statuses.end(), [](const Status& status) { return !status.isOk(); });
        return first != statuses.end() ? std::move(*first) : Status();
    }

    // REQUIRES: a strip is all of its layer.
    void addCoarsely(const Part& part) {
        const LayerWindow<Sample>& window = part.layer->window;
        const auto planeAt = [&](std::int64_t z) {
            const Sample* const first = window.layer() + window.planeStep() * (z - window.zBegin);
            return std::vector<double>(first, first + window.planeStep());
        };
        coarse_->add(part.above, part.below, part.changes, part.layer->boundary, planeAt(window.zBegin),
                     planeAt(window.zEnd));
        const double bytes = static_cast<double>(coarse_->sizeBytes());
        if (bytes > static_cast<double>(options_.memoryBytes))
            fail(tooLarge(bytes));
    }

    // Each isovalue has the counts at it, and beyond those at the next.
    Result<TopologyCurve> coarseCurve() {
        const std::vector<SurfaceCounts> counts = coarse_->finish();
        if (job_.isStopRequested())
            return cancelledError();
        std::vector<TopologyEvent> steps;
        for (std::size_t i = 0; i < counts.size(); ++i) {
            TopologyEvent step;
            step.isovalue = coarse_->isovalues()[i];
            step.below = counts[i];
            step.above = i + 1 < counts.size() ? counts[i + 1] : SurfaceCounts();
            if (!(step.below == step.above))
                steps.push_back(step);
        }
        return TopologyCurve(steps, measures_.curves(options_.measures, source_.geometry), coarse_->areExact(), false);
    }

    Result<TopologyCurve> assemble() {
        EventParts parts;
        const double span = std::min(greatest_ - least_, std::numeric_limits<double>::max());
        std::array<Status, 4> statuses;
        const auto take = [span](auto& from, SideChanges& to, Status& status, auto... side) {
            auto taken = from.take(side..., span);
            if (taken.isOk())
                to = std::move(taken).value();
            else
                status = std::move(taken).error();
        };
        tbb::parallel_invoke([&] { take(above_, parts.above, statuses[0]); },
                             [&] { take(below_, parts.below, statuses[1]); },
                             [&] { take(boundary_, parts.aboveOnBoundary, statuses[2], Side::Above); },
                             [&] { take(boundary_, parts.belowOnBoundary, statuses[3], Side::Below); },
                             [&] { parts.euler = euler_.take(); });
        ISO_TRY(firstProblem(statuses));
        job_.report(0.9, "analysing topology");
        if (job_.isStopRequested())
            return cancelledError();
        const bool areExact = boundary_.isOfSpheres(parts.aboveOnBoundary.lasting);
        EventCoder coder(scratchFile(), mostEventBytes());
        auto events = assembleEvents(std::move(parts), dims_, coder);
        if (!events.isOk())
            return std::move(events).error();
        return TopologyCurve(std::move(events).value(), measures_.curves(options_.measures, source_.geometry),
                             areExact);
    }

    const PlaneSource& source_;
    const AnalysisOptions& options_;
    const JobControl& job_;
    GridDims dims_;
    double aimBytes_; ///< of memory
    std::shared_ptr<ScratchFile> changesFile_; ///< null: none
    StripCut cut_;
    Findings expected_; ///< of the whole volume, about
    std::array<double, 5> distinct_{}; ///< of it: isovalues of each kind of changes
    double neededBytes_ = 0.0; ///< likewise
    std::size_t stripsAtOnce_ = 1;
    std::int64_t zBegin_ = 0, readEnd_ = 0; ///< of the next layer; planes read so far
    std::shared_ptr<Layer> layer_; ///< not all of whose strips are given out
    std::int64_t nextStrip_ = 0; ///< of it
    std::vector<Sample> kept_; ///< planes read that the next layer needs, too
    std::mutex problemMutex_, spareMutex_;
    std::vector<std::unique_ptr<Workspace>> spare_;
    Status problem_;
    std::atomic<bool> hasFailed_ = false;
    std::unique_ptr<CoarseCounts> coarse_; ///< then nothing goes into what follows but the measures
    IsovalueSums<EulerChange> euler_{store()};
    SideGraph above_{Side::Above, store()}, below_{Side::Below, store()};
    DomainBoundary boundary_{store(), options_.boundaryPointsAtOnce};
    MeasureSums measures_;
    double least_ = std::numeric_limits<double>::infinity(), greatest_ = -std::numeric_limits<double>::infinity();
};

} // namespace

PlaneSource planesOf(const ScalarGrid& grid) {
    const auto planeBytes =
        static_cast<std::size_t>(grid.dims()[0] * grid.dims()[1]) * scalarTypeSizeBytes(grid.type());
    return {
        grid.geometry(), grid.type(), [&grid, planeBytes](std::int64_t zBegin, std::int64_t, std::span<std::byte> out) {
            std::memcpy(out.data(), grid.bytes().data() + planeBytes * static_cast<std::size_t>(zBegin), out.size());
            return Status();
        }};
}

Result<TopologyCurve> analyseTopology(const PlaneSource& source, const AnalysisOptions& options,
                                      const JobControl& job) {
    const GridDims& dims = source.geometry.dims;
    AnalysisOptions own = options;
    own.memoryBytes -= std::min(own.memoryBytes, source.heldBytes);
    if (dims[0] * dims[1] >= kMostPlaneSamples)
        return makeError(ErrorCode::InvalidArgument, "the topology of planes of 2^27 samples or more is not analysed");
    return visitScalarType(source.type, [&](auto sample) {
        using Sample = decltype(sample);
        auto whole = Analysis<Sample>(source, own, Detail::Events, job).run();
        // What can be done without the file is.
        if (!whole.isOk() && !own.scratch.empty() && whole.error().path == own.scratch.string()) {
            const std::string problem = whole.error().line();
            if (options.scratchProblem != nullptr)
                *options.scratchProblem = problem;
            own.scratch.clear();
            whole = Analysis<Sample>(source, own, Detail::Events, job).run();
            if (!whole.isOk() && whole.error().code == ErrorCode::OutOfSpace) {
                Error error = whole.error();
                error.message += "; a temporary file would do, but: " + problem;
                whole = std::move(error);
            }
        }
        if (whole.isOk() || whole.error().code != ErrorCode::OutOfSpace || !options.mayLackEvents ||
            options.measures.isovalues.empty())
            return whole;
        auto counts = Analysis<Sample>(source, own, Detail::Counts, job).run();
        return counts.isOk() || counts.error().code != ErrorCode::OutOfSpace ? std::move(counts) : std::move(whole);
    });
}

} // namespace isoslider::topology
