#include "ui/model/session/dataset.h"

#include <algorithm>
#include <sstream>
#include <system_error>

#include "core/base/folders.h"
#include "core/base/plain_text.h"
#include "core/grid/volume_statistics.h"
#include "core/index/index_distribution.h"
#include "core/topology/stored_topology.h"
#include "core/volume_io/sources/coarse_reader.h"
#include "core/volume_io/sources/sample_volumes.h"
#include "ui/model/isovalue/histogram_model.h"
#include "ui/model/isovalue/isovalue_words.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

// All events are read to find the best isovalue: of more, the first picture does not wait for it.
constexpr std::uint64_t kMostEventsAtOnce = 500'000;

fs::path cachedIndexPath(const OpenRequest& request, const IndexCache& cache) {
    if (!request.sampleName.empty())
        return cache.pathForSample(request.sampleName);
    return cache.pathForFile(request.path, layoutText(request.readOptions));
}

/// Of an index that has its topology with it, the best isovalue is known before the first picture.
std::optional<SuggestedIsovalue> bestOfTopology(const Dataset& dataset) {
    const auto topology = topology::openTopology(dataset.indexPath);
    if (!topology.isOk() || topology.value() == nullptr || topology.value()->eventCount() > kMostEventsAtOnce)
        return std::nullopt;
    const auto found = topology::suggestIsovalues(*topology.value());
    if (!found.isOk() || found.value().empty())
        return std::nullopt;
    // The values are those of some samples yet, which may lack a rare one that all samples have.
    SuggestedRange range = dataset.suggestedRange();
    const auto counted = distributionOf(dataset.histogram, dataset.type).body;
    range.min = std::min(range.min, counted.min);
    range.max = std::max(range.max, counted.max);
    const auto suggested = suggestedIsovalues(found.value(), std::nullopt, range);
    return suggested.empty() ? std::nullopt : std::optional(suggested.front());
}

/// REQUIRES: range and values are there.
void chooseFirst(LoadedDataset& loaded, const std::optional<AskedIsovalue>& asked) {
    std::optional<double> wanted;
    if (asked)
        if (const auto value = asked->in(loaded.dataset.values->spread); value.isOk())
            wanted = value.value();
        else
            loaded.refusal = kNoDeviationText; // no isovalue is better than another
    const auto best = wanted || !loaded.engine ? std::nullopt : bestOfTopology(loaded.dataset);
    loaded.isFirstBest = best.has_value();
    if (wanted)
        loaded.first = {*wanted, {}};
    else
        loaded.first = best.value_or(SuggestedIsovalue{
            suggestedAs(firstIsovalue(*loaded.dataset.values), loaded.dataset.suggestedRange()), kHistogramReason});
}

LoadedDataset fromEngine(Dataset dataset, std::unique_ptr<extract::SlideEngine> engine, const OpenRequest& request) {
    LoadedDataset loaded;
    adoptIndex(dataset, engine->info());
    dataset.values =
        std::make_shared<ValueDistribution>(valuesOfIndex(dataset.indexPath, engine->info(), kFirstCountedSamples));
    loaded.dataset = std::move(dataset);
    loaded.engine = std::move(engine);
    chooseFirst(loaded, request.isovalue);
    return loaded;
}

Result<LoadedDataset> loadIndexFile(const OpenRequest& request) {
    auto engine = extract::SlideEngine::open(request.path);
    if (!engine.isOk())
        return engine.error();
    Dataset dataset;
    dataset.name = displayName(request);
    dataset.path = request.path;
    dataset.format = "ISOSLIDER index";
    dataset.indexPath = request.path;
    return fromEngine(std::move(dataset), std::move(engine).value(), request);
}

/// The cached index, if there is a whole one that is of this volume's shape and of metacells, as they are built now:
/// it counts as used.
std::unique_ptr<extract::SlideEngine> openCached(const Dataset& dataset) {
    if (!isPresent(dataset.indexPath))
        return nullptr;
    auto engine = extract::SlideEngine::open(dataset.indexPath);
    if (engine.isOk() && engine.value()->info().geometry == dataset.geometry &&
        engine.value()->info().type == dataset.type && engine.value()->info().kind == index::IndexKind::Metacells) {
        IndexCache::noteUse(dataset.indexPath);
        return std::move(engine).value();
    }
    return nullptr; // damaged, of another shape or kind: the next build replaces it
}

/// What is known of a volume without its samples. Complete once they are read.
void describe(const io::VolumeInfo& info, Dataset& dataset) {
    dataset.geometry = info.geometry;
    dataset.type = info.type;
    dataset.format = info.format;
    dataset.fieldName = info.fieldName;
    dataset.fieldTitle = info.fieldTitle;
    dataset.lengthUnit = info.lengthUnit;
    dataset.statesPatientSpace = info.isPatientSpace;
    dataset.notes = info.notes;
}

Status takeGrid(Result<std::shared_ptr<const ScalarGrid>> grid, LoadedDataset& loaded) {
    if (!grid.isOk())
        return std::move(grid).error();
    loaded.grid = std::move(grid).value();
    loaded.dataset.geometry = loaded.grid->geometry();
    loaded.dataset.type = loaded.grid->type();
    return {};
}

Status readPreview(io::VolumeSource& source, std::uint64_t mostBytes, const JobControl& job, LoadedDataset& loaded) {
    auto& dataset = loaded.dataset;
    const auto& dims = dataset.geometry.dims;
    const auto sampleBytes = scalarTypeSizeBytes(dataset.type);
    const auto planeSamples = static_cast<std::uint64_t>(dims[0] * dims[1]);
    const auto mostSamples = mostBytes / sampleBytes;
    const auto step = io::coarseStep(dims, std::min(kMostPreviewSamples, mostSamples));
    if (!step || planeSamples > mostSamples)
        return makeError(ErrorCode::OutOfSpace,
                         "does not fit in memory, and is too flat for a preview; build its index with isoslider-cli "
                         "build, and open that",
                         dataset.path.string());
    ISO_TRY(source.prepare(job.part(0.0, 0.35)));
    auto grid = io::readCoarse(source, *step, job.part(0.35, 0.7));
    if (!grid.isOk())
        return grid.error();
    dataset.coarseStep = *step;
    loaded.grid = std::move(grid).value();
    return {};
}

Error allMissingError(const Dataset& dataset) {
    return makeError(
        ErrorCode::InvalidArgument,
        dataset.coarseStep > 1
            ? "every sample of its preview is missing (NaN or infinite), so there is nothing to show; "
              "build its index with isoslider-cli build, and open that"
            : "every sample is missing (NaN or infinite), so there is no isosurface; choose another file or "
              "field",
        dataset.path.string());
}

Status addStatistics(LoadedDataset& loaded, const JobControl& job) {
    job.report(0.7, "Counting values");
    const bool isWhole = loaded.dataset.coarseStep == 1;
    const JobControl counting = job.part(0.7, 0.9), spreading = job.part(0.9, 0.95);
    auto statistics = computeStatistics(*loaded.grid, isWhole, 512, counting);
    if (!statistics.isOk()) // of good bins, only samples can be refused
        return statistics.error().code == ErrorCode::InvalidArgument ? allMissingError(loaded.dataset)
                                                                     : statistics.error();
    const auto& facts = statistics.value();
    auto& dataset = loaded.dataset;
    dataset.min = facts.min;
    dataset.max = facts.max;
    dataset.distinctValues = facts.distinctValues;
    dataset.missingSamples = facts.nanCount;
    dataset.histogram = facts.histogram;
    auto values = distributionOf(*loaded.grid, facts.min, facts.max, spreading);
    if (!values.isOk())
        return std::move(values).error();
    auto counted = std::make_shared<ValueDistribution>(std::move(values).value());
    counted->spread.isExact = counted->spread.isExact && isWhole;
    dataset.values = std::move(counted);
    return {};
}

} // namespace

std::string layoutText(const io::ReadOptions& options) {
    std::ostringstream text;
    text << options.field;
    if (options.component)
        text << ",component " << *options.component;
    if (options.frame)
        text << ",frame " << *options.frame;
    if (options.resampleDims[0] > 0)
        text << ",resampled " << options.resampleDims[0] << 'x' << options.resampleDims[1] << 'x'
             << options.resampleDims[2];
    if (options.raw) {
        const auto& raw = *options.raw;
        for (int axis = 0; axis < 3; ++axis)
            text << ',' << raw.dims[static_cast<std::size_t>(axis)] << ',' << raw.spacing[axis];
        text << ',' << raw.skipBytes << (raw.isBigEndian ? "be" : "le") << scalarTypeName(raw.type);
    }
    return text.str();
}

bool isPatientSpace(const Dataset& dataset) {
    if (dataset.statesPatientSpace)
        return true;
    if (dataset.format != "DICOM" && dataset.format != "NIfTI")
        return false;
    return std::none_of(dataset.notes.begin(), dataset.notes.end(),
                        [](const std::string& note) { return note.find("orientation") != std::string::npos; });
}

std::uint64_t Dataset::sampleBytes() const {
    return static_cast<std::uint64_t>(pointCount(geometry.dims)) * scalarTypeSizeBytes(type);
}

double Dataset::bytesPerVoxel() const {
    const auto points = pointCount(geometry.dims);
    return index && points > 0 ? static_cast<double>(index->indexBytes) / static_cast<double>(points) : 0.0;
}

void adoptIndex(Dataset& dataset, const index::IndexInfo& info) {
    dataset.geometry = info.geometry;
    dataset.type = info.type;
    dataset.min = info.min;
    dataset.max = info.max;
    dataset.distinctValues = info.distinctValues;
    dataset.missingSamples = info.nanCount;
    dataset.histogram = info.histogram;
    // An index of an earlier version does not know these.
    dataset.statesPatientSpace = dataset.statesPatientSpace || info.isPatientSpace;
    if (!info.lengthUnit.empty())
        dataset.lengthUnit = info.lengthUnit;
    dataset.index = info;
}

ValueDistribution valuesOfIndex(const fs::path& path, const index::IndexInfo& info, std::uint64_t mostSamples,
                                const JobControl& job) {
    const auto reader = index::IndexReader::open(path);
    if (reader.isOk())
        if (auto values = index::distributionOf(*reader.value(), mostSamples, job); values.isOk())
            return std::move(values).value();
    return distributionOf(info.histogram, info.type);
}

bool isIndexFile(const fs::path& path) { return path.extension() == ".isx"; }

std::string displayName(const OpenRequest& request) {
    if (!request.sampleName.empty()) {
        for (const auto& sample : io::sampleVolumes())
            if (sample.name == request.sampleName)
                return sample.title;
        return request.sampleName;
    }
    const auto name = request.path.filename().string();
    return name.empty() ? request.path.parent_path().filename().string() : name;
}

std::string fileStem(const Dataset& dataset) {
    if (dataset.path.empty())
        return dataset.name; // the title of a built-in sample
    fs::path name = dataset.name;
    if (lowerCase(name.extension().string()) == ".gz")
        name = name.stem();
    return name.stem().string();
}

Result<LoadedDataset> loadDataset(const OpenRequest& request, const IndexCache& cache, const SampleLoader& samples,
                                  std::uint64_t wholeVolumeBytes, const JobControl& job, const VolumeAccess& volumes) {
    if (request.sampleName.empty() && isIndexFile(request.path))
        return loadIndexFile(request);
    LoadedDataset loaded;
    auto& dataset = loaded.dataset;
    dataset.name = displayName(request);
    dataset.path = request.path;
    dataset.sampleName = request.sampleName;
    dataset.readOptions = request.readOptions;
    dataset.format = "built-in sample";
    dataset.indexPath = cachedIndexPath(request, cache);
    if (request.sampleName.empty()) {
        auto source = volumes.open(request.path, request.readOptions);
        if (!source.isOk())
            return source.error();
        describe(source.value()->info(), dataset);
        auto stamp = VolumeStamp::of(request.path, source.value()->info().dataFiles);
        if (stamp.isOk()) // without one, the index serves this run only
            dataset.stamp = std::move(stamp).value();
        const auto finding = dataset.stamp
                                 ? cache.find(*dataset.stamp, layoutText(dataset.readOptions), job.part(0.0, 0.1))
                                 : IndexCache::Finding::None;
        if (auto engine = finding == IndexCache::Finding::Fresh ? openCached(dataset) : nullptr)
            return fromEngine(std::move(dataset), std::move(engine), request);
        if (dataset.sampleBytes() > wholeVolumeBytes)
            ISO_TRY(readPreview(*source.value(), wholeVolumeBytes, job, loaded));
        else
            ISO_TRY(takeGrid(volumes.read(*source.value(), request.path, job.part(0.0, 0.7)), loaded));
        dataset.notes = source.value()->info().notes;
        if (finding == IndexCache::Finding::Stale)
            dataset.notes.emplace_back("changed since its index was built, which is built again");
        dataset.resampling = source.value()->info().resampling;
    } else {
        ISO_TRY(takeGrid(samples(request.sampleName, job.part(0.0, 0.7)), loaded));
        if (auto engine = openCached(dataset))
            return fromEngine(std::move(dataset), std::move(engine), request);
    }
    ISO_TRY(addStatistics(loaded, job));
    chooseFirst(loaded, request.isovalue);
    return loaded;
}

Status buildIndexOf(const Dataset& volume, const std::shared_ptr<const ScalarGrid>& grid, IndexBuilder& builder,
                    const IndexCache& cache, const JobControl& job) {
    const auto& path = volume.indexPath;
    ISO_TRY(makeFolders(path.parent_path()));
    IndexCache::forget(path);
    io::VolumeInfo about;
    about.lengthUnit = volume.lengthUnit;
    about.resampling = volume.resampling;
    ISO_TRY(volume.coarseStep > 1
                ? builder.buildFromFile(volume.path, volume.readOptions, volume.name, path, job.part(0.0, 0.95))
                : builder.build(grid, volume.name, about, path, job.part(0.0, 0.95)));
    if (volume.stamp) // what cannot be recorded is built again the next time
        (void)IndexCache::record(path, *volume.stamp, layoutText(volume.readOptions), job.part(0.95, 1.0));
    cache.trim(path);
    return {};
}

} // namespace isoslider::model
