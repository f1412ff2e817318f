#include "app/desktop/preprocess_index_builder.h"

#include "core/volume_io/volume_source.h"
#include "preprocess/brick_list.h"
#include "preprocess/build_index.h"

namespace isoslider::desktop {

Status PreprocessIndexBuilder::build(const std::shared_ptr<const ScalarGrid>& grid, const std::string& sourceName,
                                     const std::filesystem::path& indexPath, const JobControl& job) {
    const auto source = io::makeMemorySource(grid);
    preprocess::BuildOptions options;
    options.sourceName = sourceName;
    auto report = preprocess::buildIndex(*source, indexPath, options, job);
    if (!report.isOk())
        return report.error();
    return {};
}

Result<std::unique_ptr<extract::SlideEngine>> PreprocessIndexBuilder::engineInMemory(const std::shared_ptr<const ScalarGrid>& grid,
                                                                                    const JobControl& job) {
    return preprocess::makeMemoryEngine(grid, job);
}

} // namespace isoslider::desktop
