#include "core/topology/topology_analysis.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include <tbb/parallel_invoke.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/domain_boundary.h"
#include "core/topology/analysis/layer_components.h"
#include "core/topology/analysis/layer_euler.h"
#include "core/topology/analysis/layer_measures.h"
#include "core/topology/analysis/layer_window.h"
#include "core/topology/analysis/link_collector.h"
#include "core/topology/event_assembly.h"

namespace isoslider::topology {
namespace {

// Of one layer while it is worked on: samples, what points lead to, and in noise a link and a saddle for each.
constexpr std::uint64_t kLayerBytesPerSample = 160;
constexpr std::int64_t kMostPlaneSamples = std::int64_t{1} << 27;

// One side of all layers, put together as they come.
class SideGraph {
public:
    explicit SideGraph(Side side) { graph_.side = side; }

    // Grid points between two layers belong to both: what they lead to above and below is one from their scalars on.
    template <class Sample>
    Status add(LayerComponents& layer, const LayerWindow<Sample>& window) {
        const std::size_t base = graph_.seeds.size();
        if (base + layer.seeds.size() >= kNoSeed)
            return makeError(ErrorCode::OutOfSpace, "the volume has too many extremes for its topology to be analysed");
        graph_.seeds.insert(graph_.seeds.end(), layer.seeds.begin(), layer.seeds.end());
        const auto first = static_cast<std::uint32_t>(base);
        for (Link link : layer.links) {
            link.a += first;
            link.b += first;
            graph_.links.push_back(link);
        }
        LinkCollector between(graph_.side);
        for (std::size_t i = 0; i < top_.size(); ++i)
            if (top_[i] != kNoSeed && layer.bottom[i] != kNoSeed)
                between.add(static_cast<double>(window.layer()[i]), Cause::vertex(window.firstPoint() + i), top_[i],
                            layer.bottom[i] + first);
        const std::vector<Link> links = between.take();
        graph_.links.insert(graph_.links.end(), links.begin(), links.end());
        top_ = std::move(layer.top);
        for (std::uint32_t& seed : top_)
            seed += seed != kNoSeed ? first : 0;
        return {};
    }
    std::uint64_t sizeBytes() const { return graph_.seeds.size() * sizeof(Seed) + graph_.links.size() * sizeof(Link); }
    ComponentGraph take() { return std::move(graph_); }

private:
    ComponentGraph graph_;
    std::vector<std::uint32_t> top_;
};

template <class Sample>
class Analysis {
public:
    Analysis(const PlaneSource& source, const AnalysisOptions& options, const JobControl& job)
        : source_(source), options_(options), job_(job), dims_(source.geometry.dims) {
        // Thick enough that little is said twice, thin enough for the caches and for many threads.
        constexpr std::int64_t kLayerSamples = 1 << 20;
        const std::int64_t plane = std::max<std::int64_t>(1, dims_[0] * dims_[1]);
        planesAtOnce_ = options.planesAtOnce > 0 ? std::max<std::int64_t>(3, options.planesAtOnce)
                                                 : std::clamp<std::int64_t>(kLayerSamples / plane, 3, 16);
        layerBytes_ = static_cast<std::uint64_t>(plane * std::min(dims_[2], planesAtOnce_ + 2)) * kLayerBytesPerSample;
    }

    Result<TopologyCurve> run() {
        if (std::min({dims_[0], dims_[1], dims_[2]}) < 2)
            return TopologyCurve(); // no cells, no surface
        if (layerBytes_ > options_.memoryBytes)
            return tooLarge();
        // Two layers for each thread: one that is being worked on, one that waits; fewer where memory is scarce.
        const auto tokens = static_cast<std::size_t>(
            std::clamp<std::uint64_t>(options_.memoryBytes / 2 / layerBytes_, 1,
                                      static_cast<std::uint64_t>(2 * tbb::this_task_arena::max_concurrency())));
        tbb::parallel_pipeline(
            tokens,
            tbb::make_filter<void, std::shared_ptr<Layer>>(tbb::filter_mode::serial_in_order,
                                                           [this](tbb::flow_control& flow) { return next(flow); }) &
                tbb::make_filter<std::shared_ptr<Layer>, std::shared_ptr<Layer>>(tbb::filter_mode::parallel,
                                                                                 [this](std::shared_ptr<Layer> layer) {
                                                                                     if (!job_.isStopRequested())
                                                                                         analyse(*layer);
                                                                                     return layer;
                                                                                 }) &
                tbb::make_filter<std::shared_ptr<Layer>, void>(
                    tbb::filter_mode::serial_in_order, [this](const std::shared_ptr<Layer>& layer) { add(*layer); }));
        if (job_.isStopRequested())
            return cancelledError();
        ISO_TRY(problem_);
        return assemble();
    }

private:
    Error tooLarge() const {
        return makeError(ErrorCode::OutOfSpace, "the topology of this volume takes more than the " +
                                                    std::to_string(options_.memoryBytes >> 20) + " MB it may use");
    }
    void fail(Status status) {
        const std::lock_guard lock(problemMutex_);
        problem_ = std::move(status);
        hasFailed_ = true;
    }

    struct Layer {
        LayerWindow<Sample> window;
        LayerChanges changes;
        LayerComponents above, below;
        DomainBoundary::Part boundary;
        MeasureSums measures;
    };

    // ---- in turn: reading

    std::shared_ptr<Layer> next(tbb::flow_control& flow) {
        if (zBegin_ + 1 >= dims_[2] || job_.isStopRequested() || hasFailed_) {
            flow.stop();
            return {};
        }
        auto layer = std::make_shared<Layer>();
        LayerWindow<Sample>& window = layer->window;
        const std::int64_t step = dims_[0] * dims_[1];
        // The last plane read lies beyond the layer, but at the end of the grid.
        const std::int64_t read = std::min(dims_[2], readEnd_ + planesAtOnce_);
        window.dims = dims_;
        window.stop = job_.stop;
        window.zBegin = zBegin_;
        window.zEnd = read == dims_[2] ? read - 1 : read - 2;
        window.firstPlane = std::max<std::int64_t>(0, zBegin_ - 1);
        window.samples = std::move(kept_);
        window.samples.resize(static_cast<std::size_t>(step * (read - window.firstPlane)));
        const auto fresh =
            std::span(window.samples).subspan(static_cast<std::size_t>(step * (readEnd_ - window.firstPlane)));
        if (Status status = source_.read(readEnd_, read, std::as_writable_bytes(fresh)); !status.isOk()) {
            fail(std::move(status));
            flow.stop();
            return {};
        }
        readEnd_ = read;
        zBegin_ = window.zEnd;
        const std::int64_t keepFrom = std::max<std::int64_t>(0, zBegin_ - 1);
        kept_.assign(window.samples.begin() + static_cast<std::ptrdiff_t>(step * (keepFrom - window.firstPlane)),
                     window.samples.end());
        return layer;
    }

    // ---- at once: layers

    void analyse(Layer& layer) {
        layer.window.findStars();
        layer.changes = findLayerChanges(layer.window);
        tbb::parallel_invoke(
            [&] { layer.above = findLayerComponents(Side::Above, layer.window, layer.changes.above); },
            [&] { layer.below = findLayerComponents(Side::Below, layer.window, layer.changes.below); });
        layer.boundary = DomainBoundary::partOf(layer.window, layer.changes);
        layer.measures = measureLayer(layer.window, options_.measures, source_.geometry);
    }

    // ---- in turn: putting together

    void add(Layer& layer) {
        if (job_.isStopRequested() || hasFailed_)
            return;
        euler_.insert(euler_.end(), layer.changes.euler.begin(), layer.changes.euler.end());
        boundary_.add(layer.boundary);
        measures_.add(layer.measures);
        Status status = above_.add(layer.above, layer.window);
        if (status.isOk())
            status = below_.add(layer.below, layer.window);
        // Following and sorting them, and the events, take four times as much again (measured on noise).
        const std::uint64_t bytes =
            5 * (euler_.size() * sizeof(EulerChange) + above_.sizeBytes() + below_.sizeBytes() + boundary_.sizeBytes());
        if (status.isOk() && bytes > options_.memoryBytes)
            status = tooLarge();
        if (!status.isOk())
            fail(std::move(status));
        for (std::int64_t at = 0; at < layer.window.planeStep() * (layer.window.ownedEnd() - layer.window.zBegin); ++at)
            if (layer.window.stars[static_cast<std::size_t>(at)] != 0) {
                const auto scalar = static_cast<double>(layer.window.layer()[at]);
                least_ = std::min(least_, scalar);
                greatest_ = std::max(greatest_, scalar);
            }
        job_.report(0.8 * static_cast<double>(layer.window.zEnd) / static_cast<double>(dims_[2]), "analysing topology");
    }

    Result<TopologyCurve> assemble() {
        EventParts parts;
        const double span = std::min(greatest_ - least_, std::numeric_limits<double>::max());
        tbb::parallel_invoke(
            [&] {
                ComponentGraph graph = above_.take();
                parts.above = followComponents(graph, span);
            },
            [&] {
                ComponentGraph graph = below_.take();
                parts.below = followComponents(graph, span);
            });
        job_.report(0.9, "analysing topology");
        parts.aboveOnBoundary = boundary_.follow(Side::Above, span);
        parts.belowOnBoundary = boundary_.follow(Side::Below, span);
        parts.euler = std::move(euler_);
        if (job_.isStopRequested())
            return cancelledError();
        const bool areExact = boundary_.isOfSpheres(parts.aboveOnBoundary.lasting);
        return TopologyCurve(assembleEvents(std::move(parts), dims_),
                             measures_.curves(options_.measures, source_.geometry), areExact);
    }

    const PlaneSource& source_;
    const AnalysisOptions& options_;
    const JobControl& job_;
    GridDims dims_;
    std::int64_t planesAtOnce_ = 0;
    std::uint64_t layerBytes_ = 0; ///< that one layer takes while it is worked on, at most about
    std::int64_t zBegin_ = 0, readEnd_ = 0; ///< of the next layer; planes read so far
    std::vector<Sample> kept_; ///< planes read that the next layer needs, too
    std::mutex problemMutex_;
    Status problem_;
    std::atomic<bool> hasFailed_ = false;
    std::vector<EulerChange> euler_;
    SideGraph above_{Side::Above}, below_{Side::Below};
    DomainBoundary boundary_;
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
    if (dims[0] * dims[1] >= kMostPlaneSamples)
        return makeError(ErrorCode::InvalidArgument, "the topology of planes of 2^27 samples or more is not analysed");
    return visitScalarType(source.type,
                           [&](auto sample) { return Analysis<decltype(sample)>(source, options, job).run(); });
}

} // namespace isoslider::topology
