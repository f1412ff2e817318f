#pragma once

#include "ui/model/jobs/index_builder.h"

namespace isoslider::desktop {

/// Has indexes built by the preprocessor, in this process.
class PreprocessIndexBuilder final : public model::IndexBuilder {
public:
    Status build(const std::shared_ptr<const ScalarGrid>& grid, const std::string& sourceName,
                 const io::VolumeInfo& about, const std::filesystem::path& indexPath, const JobControl& job) override;
    Status buildFromFile(const std::filesystem::path& volume, const io::ReadOptions& options,
                         const std::string& sourceName, const std::filesystem::path& indexPath,
                         const JobControl& job) override;
    bool hasUnfinished(const std::filesystem::path& indexPath) const override;
    Result<std::unique_ptr<extract::SlideEngine>> engineInMemory(const std::shared_ptr<const ScalarGrid>& grid,
                                                                 const JobControl& job) override;
};

} // namespace isoslider::desktop
