#pragma once

#include <filesystem>
#include <optional>

#include "preprocess/build_index.h"
#include "preprocess/resume/build_checkpoints.h"

namespace isoslider::preprocess {

/// That an index is complete, and only its topology is still to be added (RESUME.md): stated in NAME.resume beside it.
class CompletedBuild {
public:
    CompletedBuild(const std::filesystem::path& indexPath, BuildIdentity identity, const BuildOptions& options);

    /// What is known of the index; none unless it is stated, by this version of the program and of this input and these
    /// parameters, and the index is still that one.
    std::optional<BuildReport> find() const;
    /// Where it cannot be written nothing is stated, and a build starts again.
    void note(const BuildReport& report) const;

private:
    std::filesystem::path index_;
    BuildIdentity identity_;
    FileSystem& fileSystem_;
};

} // namespace isoslider::preprocess
