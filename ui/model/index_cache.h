#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace isoslider::model {

/// Where the indexes of opened volumes are kept between runs.
class IndexCache {
public:
    explicit IndexCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

    const std::filesystem::path& folder() const { return folder_; }
    /// The index file of a volume as it is now: another size or modification time of the file, or of
    /// its companions (same stem, same folder), gives another name. A folder counts by its entries.
    /// `layout` tells apart readings of one headerless file.
    std::filesystem::path pathForFile(const std::filesystem::path& volume, std::string_view layout = {}) const;
    std::filesystem::path pathForSample(std::string_view name) const;

private:
    std::filesystem::path pathForKey(std::string_view stem, std::string key) const;

    std::filesystem::path folder_;
};

} // namespace isoslider::model
