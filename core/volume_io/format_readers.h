#pragma once

#include "core/volume_io/volume_reader.h"

// One function per family of formats; volume_reader.cpp chooses by suffix.

namespace isoslider::io {

Result<std::unique_ptr<VolumeSource>> openRaw(const std::filesystem::path& path, const RawLayout& layout);
Result<std::unique_ptr<VolumeSource>> openMetaImage(const std::filesystem::path& path);
Result<std::unique_ptr<VolumeSource>> openNrrd(const std::filesystem::path& path);
Result<std::unique_ptr<VolumeSource>> openNifti(const std::filesystem::path& path);
Result<std::unique_ptr<VolumeSource>> openVtkXml(const std::filesystem::path& path, const ReadOptions& options);
Result<std::unique_ptr<VolumeSource>> openVtkLegacy(const std::filesystem::path& path, const ReadOptions& options);
Result<std::unique_ptr<VolumeSource>> openPlot3d(const std::filesystem::path& path, const ReadOptions& options);

/// A source whose samples are made all at once, on the first slab, and then held.
class WholeGridSource : public VolumeSource {
public:
    /// Makes the grid if it is not there yet.
    virtual Result<std::shared_ptr<const ScalarGrid>> grid(const JobControl& job) = 0;
    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) final;
};

} // namespace isoslider::io
