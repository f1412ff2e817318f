#include "app/desktop/preprocess_index_builder.h"

#include <algorithm>

#include "core/base/memory_limit.h"
#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "preprocess/metacells/brick_list.h"
#include "preprocess/resume/build_checkpoints.h"

namespace isoslider::desktop {
namespace {

// As isoslider-cli: the window and the volume or its preview are there too.
std::uint64_t budgetBytes() { return std::max(preprocess::kMinBuildMemoryBytes, usableMemoryBytes() / 4); }

Status buildFrom(io::VolumeSource& source, const std::string& sourceName, const std::filesystem::path& indexPath,
                 bool resumes, const JobControl& job) {
    preprocess::BuildOptions options;
    options.resumes = resumes;
    options.replacesUnfit = true;
    options.withTopology = true; // it comes as soon as the index is there
    options.sourceName = sourceName;
    options.kind = index::IndexKind::Metacells; // as fast, far smaller, and their cells merge while sliding
    options.memoryBytes = budgetBytes();
    auto report = preprocess::buildIndex(source, indexPath, options, job);
    if (!report.isOk())
        return report.error();
    return {};
}

} // namespace

Status PreprocessIndexBuilder::build(const std::shared_ptr<const ScalarGrid>& grid, const std::string& sourceName,
                                     const io::VolumeInfo& about, const std::filesystem::path& indexPath,
                                     const JobControl& job) {
    io::VolumeInfo info;
    info.lengthUnit = about.lengthUnit;
    info.resampling = about.resampling;
    return buildFrom(*io::makeMemorySource(grid, std::move(info)), sourceName, indexPath, false, job);
}

Status PreprocessIndexBuilder::buildFromFile(const std::filesystem::path& volume, const io::ReadOptions& options,
                                             const std::string& sourceName, const std::filesystem::path& indexPath,
                                             const JobControl& job) {
    io::ReadOptions reading = options;
    reading.memoryBytes = budgetBytes() / 2;
    const auto source = io::openVolume(volume, reading);
    if (!source.isOk())
        return source.error();
    return buildFrom(*source.value(), sourceName, indexPath, true, job);
}

bool PreprocessIndexBuilder::hasUnfinished(const std::filesystem::path& indexPath) const {
    return preprocess::hasCheckpoint(indexPath);
}

Result<std::unique_ptr<extract::SlideEngine>> PreprocessIndexBuilder::engineInMemory(
    const std::shared_ptr<const ScalarGrid>& grid, const JobControl& job) {
    return preprocess::makeMemoryEngine(grid, job);
}

} // namespace isoslider::desktop
