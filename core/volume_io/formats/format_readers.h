#pragma once

#include <span>
#include <string_view>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"

// Each family of formats has a function that opens and one that lists; format_registry.cpp names them all.

namespace isoslider::io {

using OpenFormat = Result<std::unique_ptr<VolumeSource>>(const std::filesystem::path& path, const ReadOptions& options);
using ListFormat = Result<VolumeContents>(const std::filesystem::path& path, const ReadOptions& options);

OpenFormat openRaw; ///< REQUIRES: options.raw
OpenFormat openMetaImage;
OpenFormat openNrrd;
OpenFormat openNifti;
OpenFormat openVtkXml;
OpenFormat openVtkLegacy;
OpenFormat openPlot3d;
OpenFormat openMrc;
OpenFormat openCube;

ListFormat listMetaImage;
ListFormat listNrrd;
ListFormat listNifti;
ListFormat listMrc;
ListFormat listCube;
OpenFormat openDicom;
ListFormat listDicom;
/// A file with DICM at byte 128 or elements at its start, or a folder with such files in it.
bool isDicom(const std::filesystem::path& path, std::span<const std::byte> start);
OpenFormat openTiff;
ListFormat listTiff;
/// A file by its first bytes, or a folder with files named .tif or .tiff in it.
bool isTiff(const std::filesystem::path& path, std::span<const std::byte> start);
OpenFormat openNetcdf;
OpenFormat openHdf5;

ListFormat listVtkXml;
ListFormat listVtkLegacy;
ListFormat listPlot3d;
ListFormat listNetcdf;
ListFormat listHdf5;

/// Of formats with one scalar volume per file: what opening it finds.
Result<VolumeContents> listByOpening(OpenFormat open, const std::filesystem::path& path, const ReadOptions& options);

/// A family of formats.
struct Format {
    std::string_view name; ///< for people
    std::span<const std::string_view> suffixes; ///< lower case, with the point; of the whole file name
    OpenFormat* open = nullptr;
    ListFormat* list = nullptr; ///< null: listByOpening
    /// True if a file of whatever name, or a folder, is of this format. Null: known by its suffix only.
    bool (*recognises)(const std::filesystem::path& path, std::span<const std::byte> start) = nullptr;
    bool readsFolders = false;
    bool isIsolated = false; ///< a library parses it: read in a separate process
};

/// openVolume and listVolumes without a separate process, whatever the format.
OpenFormat openInProcess;
ListFormat listInProcess;

/// All of them; the first that fits is taken.
std::span<const Format> knownFormats();
/// By suffix, else by content. Errors: InvalidArgument (none fits, naming those known), IoError.
Result<const Format*> findFormat(const std::filesystem::path& path);

/// A source whose samples are made all at once, on the first slab, and then held.
class WholeGridSource : public VolumeSource {
public:
    /// Makes the grid if it is not there yet.
    virtual Result<std::shared_ptr<const ScalarGrid>> grid(const JobControl& job) = 0;
    Status prepare(const JobControl& job) final;
    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) final;
};

} // namespace isoslider::io
