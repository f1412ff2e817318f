#include "preprocess/build_index.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <tbb/task_arena.h>

#include "core/base/file_system.h"
#include "core/base/helper_priority.h"
#include "core/base/machine.h"
#include "core/index/format/index_format.h"
#include "core/index/level_store.h"
#include "preprocess/forecast/metered_file_system.h"
#include "preprocess/index_builds.h"
#include "preprocess/resume/completed_build.h"

namespace isoslider::preprocess {

namespace {

Status checkOptions(const BuildOptions& options, const GridGeometry& geometry) {
    if (options.skipLevels < 1 || options.skipLevels > index::kMaxSkipLevels)
        return makeError(ErrorCode::InvalidArgument,
                         "skip levels must be 1 to " + std::to_string(index::kMaxSkipLevels));
    if (!(options.redundancyThreshold >= 0.0) || !std::isfinite(options.redundancyThreshold))
        return makeError(ErrorCode::InvalidArgument, "redundancy threshold must not be negative");
    if (options.memoryBytes < kMinBuildMemoryBytes)
        return makeError(ErrorCode::InvalidArgument, "memory budget is below the minimum of 64M");
    if (options.mergeError.amount > 0.0 && options.kind != index::IndexKind::Edges)
        return makeError(ErrorCode::InvalidArgument, "metacells are merged while sliding, not when they are built");
    if (!(options.mergeError.amount >= 0.0) || !std::isfinite(options.mergeError.amount))
        return makeError(ErrorCode::InvalidArgument, "error of merged cells must not be negative");
    if (options.threads < 0)
        return makeError(ErrorCode::InvalidArgument, "number of threads is negative");
    for (const std::int64_t dim : geometry.dims)
        if (dim < 1 || dim > kMaxDim)
            return makeError(ErrorCode::InvalidArgument,
                             "the volume has an extent outside 1 to " + std::to_string(kMaxDim));
    if (BrickGrid(geometry.dims).brickCount() > std::numeric_limits<BrickIndex::NumberType>::max())
        return makeError(ErrorCode::InvalidArgument, "the volume has more than 2^32 bricks of 8^3 points");
    return {};
}

} // namespace

Result<BuildReport> buildIndex(io::VolumeSource& source, const std::filesystem::path& indexPath,
                               const BuildOptions& options, const JobControl& job) {
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [start] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    ISO_TRY(checkOptions(options, source.info().geometry));
    ISO_TRY(checkOutputPath(indexPath));
    ISO_TRY(source.prepare(job)); // a grid that is resampled shows its progress
    MeteredFileSystem metered(fileSystemOf(options), indexPath);
    BuildOptions actual = options;
    actual.fileSystem = &metered;
    // One that is brief elsewhere makes none on a slow machine either: the forecast has no room for them.
    if (isBrief(source.info().geometry.dims, options))
        actual.checkpointSeconds = -1.0;
    BuildReport report;
    std::optional<CompletedBuild> completed;
    if (options.leavesTopology)
        completed.emplace(indexPath, BuildIdentity::of(source, options), options);
    if (completed && options.resumes)
        if (auto found = completed->find()) {
            found->seconds = seconds();
            return std::move(*found);
        }
    const auto build = options.kind == index::IndexKind::Edges ? buildEdges : buildMetacells;
    // More threads than cores would only make TBB complain.
    const int cores = tbb::this_task_arena::max_concurrency();
    tbb::task_arena arena(options.threads == 0 ? cores : std::min(options.threads, cores));
    const HelperPriority priority(arena);
    ISO_TRY(arena.execute([&] { return build(source, indexPath, actual, job, report); }));
    if (fileSystemOf(options).keepsFiles())
        index::LevelStore::discard(indexPath, fileSystemOf(options)); // of the index that was there before
    report.temporaryBytes = metered.mostBytes();
    report.seconds = seconds();
    report.peakRssBytes = peakRssBytes();
    if (completed && actual.checkpointSeconds >= 0.0)
        completed->note(report);
    return report;
}

} // namespace isoslider::preprocess
