#include "app/cli/report/volume_measures.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "app/cli/scratch_folder.h"
#include "core/base/memory_limit.h"
#include "core/extract/full_extraction.h"
#include "core/extract/merged/merged_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"

namespace isoslider::cli {
namespace {

constexpr int kFreshExtractions = 3; // of each step size
constexpr double kErrorStepPercent = 1.0;
constexpr int kErrorSteps = 6;

template <class Work>
double millisecondsOf(const Work& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

double medianOf(std::vector<double> values) {
    if (values.empty())
        return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Goes from isovalue to isovalue; the first is where it starts.
Result<StepCost> walk(extract::SlideEngine& engine, const std::vector<double>& isovalues, const JobControl& job) {
    extract::SurfaceFrame shown, next;
    std::vector<double> times;
    double changed = 0.0;
    for (std::size_t i = 0; i < isovalues.size(); ++i) {
        Result<extract::SlideStats> stats = extract::SlideStats();
        const double ms = millisecondsOf([&] {
            stats = engine.slideTo(isovalues[i], {job.stop, {}});
            if (stats.isOk())
                engine.copyFrame(next);
        });
        if (!stats.isOk())
            return stats.error();
        std::swap(shown, next); // the picture before is held meanwhile, as a window does
        if (i == 0)
            continue;
        times.push_back(ms);
        changed += static_cast<double>(stats.value().edgesAdded + stats.value().edgesRemoved);
    }
    return StepCost{times.empty() ? 0.0 : changed / static_cast<double>(times.size()), medianOf(times)};
}

/// Measures one volume step by step.
class Measuring {
public:
    Measuring(io::VolumeSource& source, const std::filesystem::path& path, const MeasureOptions& options)
        : source_(source), path_(path), options_(options) {
        measured_.name = path.filename().string();
    }

    Result<VolumeMeasures> run(const JobControl& job) {
        const JobControl building = job.part(0.0, 0.5), reading = job.part(0.5, 0.55), sliding = job.part(0.55, 0.8),
                         merging = job.part(0.8, 1.0);
        ISO_TRY(folder_.make(options_.folder, "isoslider-report"));
        ISO_TRY(buildAll(building));
        ISO_TRY(hold(reading));
        ISO_TRY(measureSteps(sliding));
        ISO_TRY(measureErrors(merging));
        return std::move(measured_);
    }

private:
    Status buildAll(const JobControl& job) {
        const io::VolumeInfo& volume = source_.info();
        measured_.dims = volume.geometry.dims;
        measured_.type = volume.type;
        measured_.fileBytes = static_cast<std::uint64_t>(pointCount(measured_.dims)) * scalarTypeSizeBytes(volume.type);
        for (std::size_t k = 0; k < options_.kinds.size(); ++k) {
            MeasuredIndex index;
            index.kind = options_.kinds[k];
            const double expected = preprocess::kBytesPerVoxelAim * static_cast<double>(pointCount(measured_.dims));
            if (index.kind == index::IndexKind::Metacells || expected <= static_cast<double>(options_.mostIndexBytes)) {
                const auto count = static_cast<double>(options_.kinds.size());
                const JobControl building =
                    job.part(static_cast<double>(k) / count, static_cast<double>(k + 1) / count);
                preprocess::BuildOptions build;
                build.kind = index.kind;
                build.memoryBytes = options_.memoryBytes;
                build.sourceName = measured_.name;
                auto report = preprocess::buildIndex(source_, indexPath(k), build, building);
                if (!report.isOk())
                    return report.error();
                index.buildSeconds = report.value().seconds;
                measured_.facts = report.value().info;
                index.info = std::move(report).value().info;
            }
            measured_.indexes.push_back(std::move(index));
        }
        if (measured_.facts.levels.empty())
            return makeError(ErrorCode::InvalidArgument, "an index of edges would be too large; measure metacells, too",
                             path_.string());
        measured_.centre = busiestIsovalue(measured_.facts);
        return {};
    }

    Status hold(const JobControl& job) {
        measured_.isInMemory = 2 * measured_.fileBytes <= usableMemoryBytes();
        if (!measured_.isInMemory)
            return {};
        auto grid = io::readVolume(source_, path_, job);
        if (!grid.isOk())
            return grid.error();
        grid_ = std::move(grid).value();
        return {};
    }

    Status measureSteps(const JobControl& job) {
        for (const double percent : options_.percents)
            measured_.steps.push_back({percent, {}, 0.0});
        for (std::size_t k = 0; k < measured_.indexes.size(); ++k) {
            std::unique_ptr<extract::SlideEngine> engine;
            if (measured_.indexes[k].info)
                ISO_TRY(open(k, engine));
            for (std::size_t i = 0; i < measured_.steps.size(); ++i) {
                MeasuredStep& step = measured_.steps[i];
                step.byKind.emplace_back();
                if (!engine)
                    continue;
                auto cost = walk(*engine, isovaluesOf(step.percent, options_.steps), job);
                if (!cost.isOk())
                    return cost.error();
                step.byKind.back() = cost.value();
                job.report(0.7 * static_cast<double>(k * measured_.steps.size() + i + 1) /
                               static_cast<double>(measured_.indexes.size() * measured_.steps.size()),
                           "sliding");
            }
        }
        for (std::size_t i = 0; grid_ && i < measured_.steps.size(); ++i) {
            ISO_TRY(measureFresh(measured_.steps[i], job));
            job.report(0.7 + 0.3 * static_cast<double>(i + 1) / static_cast<double>(measured_.steps.size()),
                       "extracting");
        }
        return {};
    }

    Status measureFresh(MeasuredStep& step, const JobControl& job) {
        const std::vector<double> isovalues = isovaluesOf(step.percent, options_.steps);
        std::vector<double> times;
        for (int i = 0; i < kFreshExtractions; ++i) {
            const double at = isovalues[static_cast<std::size_t>(i) * (isovalues.size() - 1) / (kFreshExtractions - 1)];
            Result<extract::SurfaceMesh> surface = extract::SurfaceMesh();
            JobControl quiet;
            quiet.stop = job.stop;
            times.push_back(millisecondsOf([&] { surface = extract::extractFull(*grid_, at, quiet); }));
            if (!surface.isOk())
                return surface.error();
        }
        step.freshMs = medianOf(times);
        return {};
    }

    Status measureErrors(const JobControl& job) {
        std::vector<extract::MergeError> errors{{}};
        errors.insert(errors.end(), options_.errors.begin(), options_.errors.end());
        std::unique_ptr<extract::SlideEngine> engine;
        for (std::size_t k = 0; k < measured_.indexes.size(); ++k)
            if (measured_.indexes[k].kind == index::IndexKind::Metacells)
                ISO_TRY(open(k, engine));
        for (const extract::MergeError& error : errors) {
            MeasuredError row{error, 0, 0, 0.0};
            const extract::MergeBound bound = extract::boundOf(error, measured_.facts.min, measured_.facts.max);
            if (engine) {
                engine->setMergeBound(bound);
                auto cost = walk(*engine, isovaluesOf(kErrorStepPercent, kErrorSteps), job);
                if (!cost.isOk())
                    return cost.error();
                row.ms = cost.value().ms;
                const auto stats = engine->slideTo(measured_.centre, {job.stop, {}});
                if (!stats.isOk())
                    return stats.error();
                row.trianglesOfSlide = stats.value().triangles;
            }
            if (grid_) {
                JobControl quiet;
                quiet.stop = job.stop;
                const auto surface =
                    extract::extractMerged(*grid_, measured_.centre, bound, extract::kMaxMergeLevel, quiet);
                if (!surface.isOk())
                    return surface.error();
                row.triangles = surface.value().triangles.size() / 3;
            }
            measured_.errors.push_back(row);
            job.report(static_cast<double>(measured_.errors.size()) / static_cast<double>(errors.size()), "merging");
        }
        return {};
    }

    std::vector<double> isovaluesOf(double percent, int steps) const {
        return walkAround(measured_.facts, measured_.centre, percent, steps);
    }

    Status open(std::size_t k, std::unique_ptr<extract::SlideEngine>& engine) const {
        extract::SlideOptions options;
        options.readsAhead = false; // the next step follows at once
        options.buildsLevels = false; // what is measured must not depend on how far they are
        auto opened = extract::SlideEngine::open(indexPath(k), options);
        if (!opened.isOk())
            return opened.error();
        engine = std::move(opened).value();
        return {};
    }

    io::VolumeSource& source_;
    const std::filesystem::path& path_;
    const MeasureOptions& options_;
    std::filesystem::path indexPath(std::size_t k) const { return folder_.path() / fmt::format("{}.isx", k); }

    ScratchFolder folder_; ///< indexes, by their place in measured_.indexes
    std::shared_ptr<const ScalarGrid> grid_;
    VolumeMeasures measured_;
};

} // namespace

double busiestIsovalue(const index::IndexInfo& info) {
    const auto& counts = info.activeEdgesPerBin;
    const auto bins = static_cast<std::ptrdiff_t>(counts.size());
    if (bins == 0)
        return info.min;
    // At a bin's lower end; that of the very first has no surface.
    const auto first = counts.begin() + std::max<std::ptrdiff_t>(bins > 1 ? 1 : 0, (3 * bins) / 10);
    const auto last = counts.begin() + std::max(first - counts.begin() + 1, (7 * bins + 9) / 10);
    const auto bin = static_cast<double>(std::max_element(first, last) - counts.begin()) / static_cast<double>(bins);
    return info.min * (1.0 - bin) + info.max * bin;
}

std::vector<double> walkAround(const index::IndexInfo& info, double centre, double percent, int steps) {
    const double range = info.max - info.min, step = range * percent / 100.0;
    const double lowest = info.min + 0.02 * range, highest = info.min + 0.98 * range;
    double at = std::clamp(centre - step * steps / 2.0, lowest, highest), direction = 1.0;
    std::vector<double> isovalues;
    for (int i = 0; i <= steps; ++i) {
        isovalues.push_back(at);
        if (const double next = at + direction * step; next > highest || next < lowest)
            direction = -direction;
        at = std::clamp(at + direction * step, lowest, highest);
    }
    return isovalues;
}

Result<VolumeMeasures> measureVolume(io::VolumeSource& source, const std::filesystem::path& path,
                                     const MeasureOptions& options, const JobControl& job) {
    return Measuring(source, path, options).run(job);
}

} // namespace isoslider::cli
