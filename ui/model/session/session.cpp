#include "ui/model/session/session.h"

#include <system_error>

#include "core/base/folders.h"
#include "core/base/memory_limit.h"
#include "core/extract/pieces/kept_pieces.h"
#include "core/extract/slide_engine.h"
#include "core/mesh/mesh_export.h"
#include "core/topology/index_topology.h"
#include "ui/model/isovalue/histogram_model.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/read_files.h"

namespace isoslider::model {
namespace fs = std::filesystem;

namespace {

// What a certificate names of a volume.
class SourceOfMesh {
public:
    // A window on an index file shows that file's name; its surfaces are of the volume.
    explicit SourceOfMesh(const Dataset& dataset) : least_(dataset.min), greatest_(dataset.max) {
        const bool hasSourceName = dataset.index && !dataset.index->sourceName.empty();
        std::string lost = dataset.index ? dataset.index->resampling : std::string();
        if (dataset.resampling)
            lost = io::lossText(*dataset.resampling, dataset.geometry.dims);
        source_ = {hasSourceName ? dataset.index->sourceName : dataset.name,
                   dataset.missingSamples,
                   dataset.lengthUnit,
                   std::move(lost),
                   {},
                   isPatientSpace(dataset)};
    }
    // How its cells are merged, the mesh states: meanwhile another error may have been chosen.
    mesh::SurfaceSource of(const extract::SurfaceMesh& surface) const {
        mesh::SurfaceSource source = source_;
        source.merging = mesh::mergingText(surface.mergeBound, least_, greatest_, 1 << extract::kMaxBrickMergeLevel);
        return source;
    }

private:
    mesh::SurfaceSource source_;
    double least_, greatest_;
};

// For the comments of its mesh.
std::string textOf(const Session::ExportPart& part) {
    std::string text;
    if (part.pieces)
        text = groupedText(part.pieces->kept.size()) + " of the pieces; the others are left out";
    if (part.clipping.clipsAnything())
        text += std::string(text.empty() ? "" : "; ") + "what is clipped is left out";
    if (part.sides == CropSides::Closed)
        text += ", closed at the sides of the crop box";
    return text;
}

Result<extract::SurfaceMesh> partOf(extract::SurfaceMesh surface, const Session::ExportPart& part,
                                    const JobControl& job) {
    if (part.pieces) {
        if (surface.isovalue != part.pieces->isovalue)
            return makeError(ErrorCode::InvalidArgument, "the isovalue has changed since; export again");
        auto kept = keepPieces(surface, part.pieces->kept, job);
        if (!kept.isOk())
            return kept;
        surface = std::move(kept).value();
    }
    return clippedMesh(std::move(surface), part.clipping, part.sides, job);
}

} // namespace

Session::Session(SessionServices services)
    : services_(std::move(services)),
      cache_(services_.cacheFolder),
      slot_(std::make_shared<FrameSlot>()),
      worker_(std::make_unique<SlideWorker>(workerCallbacks())),
      runner_(std::make_unique<JobRunner>(jobs_, services_.postToMain)) {
    requestSubscription_ = isovalue_.observeRequest([this](double isovalue) {
        firstIsovalue_.noteRequest(isovalue);
        requestMove(isovalue);
        surfaces_.setIsovalue(isovalue);
    });
    detailSubscription_ = detail_.observe([this] {
        mergeCells();
        redraw();
        second_->mergeWithin(detail_.error());
    });
    inactive_ = std::make_unique<InactiveSurfaces>(
        *runner_, services_.postToMain, [this](const ListedSurface& surface, const Error& error) {
            fail("The surface " + surface.name + " could not be extracted", error);
        });
    second_ = std::make_unique<SecondVolume>(*runner_, services_, cache_, surfaces_,
                                             [this](const Notice& notice) { post(notice); });
    surfacesSubscription_ = surfaces_.observe([this] { followSurfaces(); });
}

Session::~Session() = default;

void Session::open(OpenRequest request) {
    if (loadJob_)
        runner_->cancel(*loadJob_);
    const auto ticket = ++loadTicket_;
    loadJob_ = runner_->run<OpenedVolume>(
        "Open " + displayName(request),
        [request, cache = cache_, services = services_](const JobControl& job) {
            return openOrAsk(request, services, cache, job);
        },
        [this, ticket, request](Result<OpenedVolume> opened) {
            if (ticket == loadTicket_)
                onOpened(std::move(opened), request);
        });
    datasetChanged_.notify();
}

void Session::cancelOpening() {
    if (loadJob_)
        runner_->cancel(*loadJob_);
}

void Session::onOpened(Result<OpenedVolume> opened, const OpenRequest& request) {
    loadJob_.reset();
    if (opened.isOk() && opened.value().loaded)
        return adopt(std::move(*opened.value().loaded));
    datasetChanged_.notify();
    if (opened.isOk())
        choiceNeeded_.notify(request, opened.value().contents);
    else if (!opened.isCancelled())
        fail("Could not open " + displayName(request), opened.error());
}

void Session::forgetDataset() {
    datasetGeneration_ = DatasetGeneration{static_cast<std::uint64_t>(datasetGeneration_) + 1};
    if (indexJob_)
        runner_->cancel(*indexJob_);
    indexJob_.reset();
    if (topologyJob_)
        runner_->cancel(*topologyJob_);
    topologyJob_.reset();
    if (valuesJob_)
        runner_->cancel(*valuesJob_);
    valuesJob_.reset();
    areValuesCounted_ = false;
    topology_.clear();
    indexState_ = IndexState::None;
    dataset_.reset();
    lookedAt_.reset();
    grid_.reset();
    frame_.reset();
    failedIsovalue_.reset();
    isMoveStopped_ = false;
    moveProgress_ = 0.0;
    certificate_.reset();
    isCheckingMesh_ = false;
    isPictureComing_ = false;
    inactive_->clear();
    second_->close();
    standIn_.reset();
    isFrameOfActive_ = true;
    surfaces_.clear();
    detail_.clearError(); // last: nothing is left to be made with another error
}

void Session::adopt(LoadedDataset loaded) {
    forgetDataset();
    if (const auto& index = loaded.dataset.index; loaded.engine && index && index->mergeError > 0.0)
        detail_.setError(extract::builtError(*index)); // it was built to be seen so
    pictureLimit_ = std::numeric_limits<std::uint64_t>::max();
    worker_->limitPicture(pictureLimit_);
    second_->limitPicture(pictureLimit_);
    dataset_ = std::move(loaded.dataset);
    grid_ = std::move(loaded.grid);
    isovalue_.setDomain(dataset_->min, dataset_->max, loaded.first.isovalue);
    surfaces_.begin(isovalue_.requested());
    firstIsovalue_.begin(std::move(loaded.first), loaded.isFirstBest, std::move(loaded.refusal));
    if (loaded.engine) {
        indexState_ = IndexState::Ready;
        useSource(makeIndexSource(std::move(loaded.engine)));
    } else {
        useSource(makeMemorySource(grid_, services_.indexBuilder));
    }
    datasetChanged_.notify();
    frameChanged_.notify();
    certificateChanged_.notify();
}

void Session::close() {
    if (loadJob_)
        runner_->cancel(*loadJob_);
    loadJob_.reset();
    ++loadTicket_;
    forgetDataset();
    generation_ = worker_->setSource(nullptr, datasetGeneration_, std::nullopt);
    isovalue_.clearDomain();
    firstIsovalue_.end();
    datasetChanged_.notify();
    frameChanged_.notify();
    certificateChanged_.notify();
}

void Session::buildIndex() {
    if (indexState_ == IndexState::Failed || indexState_ == IndexState::Cancelled)
        startIndexBuild();
}

void Session::startIndexBuild() {
    if (!grid_ || !services_.indexBuilder)
        return;
    indexState_ = IndexState::Building;
    auto work = [builder = services_.indexBuilder, grid = grid_, volume = *dataset_,
                 cache = cache_](const JobControl& job) { return buildIndexOf(volume, grid, *builder, cache, job); };
    const bool goesOn = dataset_->coarseStep > 1 && services_.indexBuilder->hasUnfinished(dataset_->indexPath);
    indexJob_ = runner_->run<void>((goesOn ? "Finish index of " : "Build index of ") + dataset_->name, std::move(work),
                                   [this, ticket = datasetGeneration_](const Status& status) {
                                       if (ticket == datasetGeneration_)
                                           onIndexBuilt(status);
                                   },
                                   services_.backgroundPriority);
    datasetChanged_.notify();
}

void Session::onIndexBuilt(const Status& status) {
    indexJob_.reset();
    if (status.isOk())
        return openBuiltIndex();
    indexState_ = status.isCancelled() ? IndexState::Cancelled : IndexState::Failed;
    datasetChanged_.notify();
    if (!status.isCancelled())
        fail(isPreview() ? "The index could not be built; the preview stays"
                         : "The index could not be built; the volume stays in memory for sliding",
             status.error());
}

void Session::openBuiltIndex() {
    indexJob_ = runner_->run<OpenedIndex>(
        "Open index of " + dataset_->name,
        [volume = *dataset_](const JobControl&) -> Result<OpenedIndex> {
            auto engine = extract::SlideEngine::open(volume.indexPath);
            if (!engine.isOk())
                return engine.error();
            OpenedIndex opened;
            opened.info = engine.value()->info();
            if (opened.info.geometry != volume.geometry || opened.info.type != volume.type)
                return makeError(ErrorCode::InvalidArgument, "was changed after it was opened; open it again",
                                 volume.path.string());
            if (volume.coarseStep > 1)
                opened.values = valuesOfIndex(volume.indexPath, opened.info, kFirstCountedSamples);
            opened.source = makeIndexSource(std::move(engine).value());
            return opened;
        },
        [this, ticket = datasetGeneration_](Result<OpenedIndex> opened) {
            if (ticket != datasetGeneration_)
                return;
            indexJob_.reset();
            if (opened.isOk())
                return useIndex(std::move(opened).value());
            indexState_ = IndexState::Failed;
            datasetChanged_.notify();
            if (!opened.isCancelled())
                fail("The index could not be opened", opened.error());
        });
}

void Session::useIndex(OpenedIndex opened) {
    indexState_ = IndexState::Ready;
    adoptIndex(*dataset_, opened.info);
    if (opened.values)
        dataset_->values = std::make_shared<ValueDistribution>(std::move(*opened.values));
    // A preview may have missed the ends of the range, and with them the isovalue that was asked for.
    isovalue_.changeDomain(dataset_->min, dataset_->max, firstIsovalue_.isovalue().value_or(isovalue_.requested()));
    surfaces_.setIsovalue(isovalue_.requested());
    grid_.reset(); // exploring needs memory in proportion to the surface, not to the volume
    useSource(std::move(opened.source));
    datasetChanged_.notify();
}

std::vector<SuggestedIsovalue> Session::suggestions() const {
    if (!dataset_)
        return {};
    if (!(dataset_->min < dataset_->max)) // no isovalue has a surface
        return {};
    return suggestedIsovalues(topology_.suggestions(), model::firstIsovalue(*dataset_->values),
                              dataset_->suggestedRange());
}

void Session::improveFirstIsovalue() {
    if (!firstIsovalue_.canImprove() || topology_.suggestions().empty())
        return;
    const auto all = suggestions();
    if (all.empty())
        return;
    const SuggestedIsovalue& best = all.front();
    firstIsovalue_.improve(best);
    isovalue_.request(best.isovalue);
}

void Session::analyseTopology() {
    topology_.setAnalysing();
    // Not stored: analysed again the next time.
    startTopology("Analyse topology of " + dataset_->name, topology::topologyOfIndex,
                  [this](Result<FoundTopology> found) {
                      if (!found.isOk())
                          return topology_.setFailed(found.isCancelled() ? "stopped" : found.error().line());
                      topology_.setContent(std::move(found.value().content));
                      if (!topology_.hasEvents() && !found.value().isNew)
                          addEvents();
                  });
}

// The index may have been built with less memory. Meanwhile, and where there is no more, what is known serves.
void Session::addEvents() {
    const auto find = [](const auto& index, const auto& options, const auto& job) {
        auto found = topology::addEvents(index, options, job);
        const bool isTooLarge = !found.isOk() && found.error().code == ErrorCode::OutOfSpace;
        return isTooLarge ? Result<topology::IndexTopology>(topology::IndexTopology()) : std::move(found);
    };
    startTopology("Find events of topology of " + dataset_->name, find, [this](Result<FoundTopology> found) {
        if (found.isOk() && found.value().isNew)
            topology_.setContent(std::move(found.value().content));
    });
}

void Session::startTopology(const std::string& name, const FindTopology& find,
                            const std::function<void(Result<FoundTopology>)>& use) {
    topology::AnalysisOptions options;
    options.memoryBytes = usableMemoryBytes() / 4;
    topologyJob_ = runner_->run<FoundTopology>(
        name,
        [path = dataset_->indexPath, options, find](const JobControl& job) -> Result<FoundTopology> {
            auto found = find(path, options, job);
            if (!found.isOk())
                return std::move(found).error();
            if (!found.value().summary)
                return FoundTopology{};
            auto content = TopologyModel::contentOf(std::move(found.value().summary));
            if (!content.isOk())
                return std::move(content).error();
            return FoundTopology{std::move(content).value(), found.value().isNew};
        },
        [this, use, ticket = datasetGeneration_](Result<FoundTopology> found) {
            if (ticket != datasetGeneration_)
                return;
            topologyJob_.reset();
            use(std::move(found));
        },
        services_.backgroundPriority);
}

// Of an index, what is shown at first is of some of its samples.
void Session::countValues() {
    areValuesCounted_ = true;
    valuesJob_ = runner_->run<ValueDistribution>(
        "Count values of " + dataset_->name,
        [path = dataset_->indexPath, info = *dataset_->index](const JobControl& job) -> Result<ValueDistribution> {
            auto values = valuesOfIndex(path, info, kMostCountedSamples, job);
            if (job.isStopRequested())
                return cancelledError();
            return values;
        },
        [this, ticket = datasetGeneration_](Result<ValueDistribution> values) {
            if (ticket != datasetGeneration_)
                return;
            valuesJob_.reset();
            if (!values.isOk())
                return;
            dataset_->values = std::make_shared<ValueDistribution>(std::move(values).value());
            datasetChanged_.notify();
        },
        services_.backgroundPriority);
}

bool Session::isPreview() const { return dataset_ && dataset_->coarseStep > 1 && indexState_ != IndexState::Ready; }

std::int64_t Session::shownStep() const { return frame_ && !frame_->isFromIndex ? dataset_->coarseStep : 1; }

bool Session::refusesMesh(const std::string& title, const std::string& verb) {
    if (!isPreview())
        return false;
    const bool isComing =
        services_.indexBuilder && (indexState_ == IndexState::None || indexState_ == IndexState::Building);
    fail(title, makeError(ErrorCode::InvalidArgument,
                          (isComing ? "the index is still being built; the preview is not "
                                    : "the volume has no index; build it first, the preview is not ") +
                              verb));
    return true;
}

bool Session::refusesExport() { return refusesMesh("The mesh was not exported", "exported"); }

void Session::checkMesh() {
    if (!frame_ || isCheckingMesh_ || refusesMesh("The mesh was not checked", "checked"))
        return;
    isCheckingMesh_ = true;
    runner_->run<mesh::Certificate>(
        "Check mesh",
        [worker = worker_.get(), of = datasetGeneration_,
         source = SourceOfMesh(*dataset_)](const JobControl& job) -> Result<mesh::Certificate> {
            job.report(0.05, "Taking the surface");
            auto surface = worker->takeMesh(of, job);
            if (!surface.isOk())
                return surface.error();
            job.report(0.3, "Checking with OpenMesh");
            return mesh::certify(surface.value(), source.of(surface.value()), job);
        },
        [this, ticket = datasetGeneration_](Result<mesh::Certificate> certificate) {
            if (ticket != datasetGeneration_)
                return;
            isCheckingMesh_ = false;
            if (!certificate.isOk()) {
                certificateChanged_.notify();
                if (!certificate.isCancelled())
                    fail("The mesh could not be checked", certificate.error());
                return;
            }
            certificate_ = std::move(certificate).value();
            certificateChanged_.notify();
        });
    certificateChanged_.notify();
}

Session::TakeMesh Session::takeActive() const {
    return
        [worker = worker_.get(), of = datasetGeneration_](const JobControl& job) { return worker->takeMesh(of, job); };
}

void Session::exportMesh(const fs::path& path, DatasetGeneration of, std::string remark) {
    exportSurface(path, of, std::nullopt, takeActive(), std::move(remark));
}

void Session::exportPart(const fs::path& path, DatasetGeneration of, ExportPart part) {
    exportSurface(path, of, std::move(part), takeActive());
}

void Session::exportSurface(const fs::path& path, DatasetGeneration of, std::optional<ExportPart> part, TakeMesh take,
                            std::string remark) {
    if (of != datasetGeneration_)
        return fail("The mesh was not exported",
                    makeError(ErrorCode::InvalidArgument, "its volume has been closed or replaced", path.string()));
    if (!frame_ || refusesExport())
        return;
    if (!mesh::isExportSuffix(path))
        return fail("The mesh was not exported",
                    makeError(ErrorCode::InvalidArgument, "the file name must end in .ply, .obj, .stl, .off or .om",
                              path.string()));
    const bool isWhole = !part;
    runner_->run<mesh::Certificate>(
        "Export " + path.filename().string(),
        [take = std::move(take), source = SourceOfMesh(*dataset_), path, part = std::move(part),
         read = ReadFiles({&*dataset_, second_->dataset()})](const JobControl& job) -> Result<mesh::Certificate> {
            ISO_TRY(read.checkNotReplacedBy(path));
            job.report(0.05, "Taking the surface");
            auto surface = take(job);
            if (!surface.isOk())
                return surface.error();
            bool isChecked = true;
            mesh::SurfaceSource about = source.of(surface.value());
            if (part) {
                about.part = textOf(*part);
                isChecked = !cutsTriangles(surface.value(), part->clipping, part->sides);
                surface = partOf(std::move(surface).value(), *part, job);
                if (!surface.isOk())
                    return surface.error();
            }
            job.report(0.2, "Checking with OpenMesh");
            const JobControl checking = job.part(0.2, 0.7), writing = job.part(0.7, 1.0);
            auto certificate = isChecked ? mesh::certify(surface.value(), about, checking)
                                         : Result(mesh::uncheckedCertificate(surface.value(), about));
            if (!certificate.isOk())
                return certificate;
            job.report(0.7, "Writing");
            ISO_TRY(mesh::exportMesh(surface.value(), certificate.value(), path, writing));
            return certificate;
        },
        [this, of, path, isWhole, remark = std::move(remark)](Result<mesh::Certificate> certificate) {
            if (certificate.isOk())
                onExported(path, of, std::move(certificate).value(), isWhole, remark);
            else if (!certificate.isCancelled())
                fail("The mesh was not exported", certificate.error());
        });
}

void Session::onExported(const fs::path& path, DatasetGeneration of, mesh::Certificate certificate, bool isWhole,
                         const std::string& remark) {
    const auto faults = mesh::faultsOf(certificate);
    if (certificate.report.triangles == 0) { // an error to look at: nobody wants such a file
        const std::string why = isWhole ? "there is no surface at isovalue " + exactText(certificate.isovalue)
                                        : std::string("nothing of the surface is in the part that was exported");
        post(Notice{Notice::Severity::Error, "The exported mesh is empty", path.string() + ": " + why});
    } else if (faults.empty()) {
        post(Notice{Notice::Severity::Information, "Mesh exported",
                    path.string() + (remark.empty() ? "" : '\n' + remark)});
    } else {
        std::string detail = path.string() + ": ";
        for (std::size_t i = 0; i < faults.size(); ++i)
            detail += (i == 0 ? "" : ", ") + faults[i];
        post(Notice{Notice::Severity::Error, "Mesh exported, but it is not sound", detail});
    }
    if (of != datasetGeneration_ || !isWhole)
        return;
    certificate_ = std::move(certificate);
    certificateChanged_.notify();
}

void Session::cancelJob(JobId id) { runner_->cancel(id); }

bool Session::isSettled() const {
    if (jobs_.runningCount() > 0)
        return false;
    if (!dataset_)
        return true;
    if (isMoving() || inactive_->isBusy() || second_->isBusy())
        return false;
    switch (indexState_) {
        case IndexState::None: return !grid_ || !services_.indexBuilder;
        case IndexState::Ready: return hasMoveFailed() || frame_->isFromIndex;
        default: return true;
    }
}

void Session::fail(const std::string& title, const Error& error) {
    post(Notice{Notice::Severity::Error, title, error.line(), error.code});
}

} // namespace isoslider::model
