#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::model {

/// How the window learns what is in a file or folder, and reads it. Tests put their own in place of the
/// readers. Called on worker threads, several at once; errors as of the functions of the same names.
struct VolumeAccess {
    using List = Result<io::VolumeContents>(const std::filesystem::path&, const io::ReadOptions&);
    using Open = Result<std::unique_ptr<io::VolumeSource>>(const std::filesystem::path&, const io::ReadOptions&);
    using Read = Result<std::shared_ptr<const ScalarGrid>>(io::VolumeSource&, const std::filesystem::path&,
                                                           const JobControl&);

    std::function<List> list = [](const auto& path, const auto& options) { return io::listVolumes(path, options); };
    std::function<Open> open = [](const auto& path, const auto& options) { return io::openVolume(path, options); };
    std::function<Read> read = static_cast<Read*>(io::readVolume);
};

} // namespace isoslider::model
