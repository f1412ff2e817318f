#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"

// Each family of formats has a function that opens and one that lists; format_registry.cpp names the families, and
// reader_process/library_formats.cpp the functions of those that a library parses.

namespace isoslider::io {

using OpenFormat = Result<std::unique_ptr<VolumeSource>>(const std::filesystem::path& path, const ReadOptions& options);
using ListFormat = Result<VolumeContents>(const std::filesystem::path& path, const ReadOptions& options);

OpenFormat openRaw; ///< REQUIRES: options.raw
OpenFormat openMetaImage, openNrrd, openNifti, openMrc, openCube;
ListFormat listMetaImage, listNrrd, listNifti, listMrc, listCube;

// Parsed by a library.
OpenFormat openVtkXml, openVtkLegacy, openPlot3d, openDicom, openTiff, openNetcdf, openHdf5;
ListFormat listVtkXml, listVtkLegacy, listPlot3d, listDicom, listTiff, listNetcdf, listHdf5;

/// A file with DICM at byte 128 or elements at its start, or a folder with such files in it.
bool isDicom(const std::filesystem::path& path, std::span<const std::byte> start);
/// A file by its first bytes, or a folder with files named .tif or .tiff in it.
bool isTiff(const std::filesystem::path& path, std::span<const std::byte> start);

/// Of formats with one scalar volume per file: what opening it finds.
Result<VolumeContents> listByOpening(OpenFormat open, const std::filesystem::path& path, const ReadOptions& options);

/// A family of formats.
struct Format {
    std::string_view name; ///< for people
    std::span<const std::string_view> suffixes; ///< lower case, with the point; of the whole file name
    OpenFormat* open = nullptr; ///< null: a library parses it, in a separate process
    ListFormat* list = nullptr; ///< null where `open` is
    /// True if a file of whatever name, or a folder, is of this format. Null: known by its suffix only.
    bool (*recognises)(const std::filesystem::path& path, std::span<const std::byte> start) = nullptr;
    bool readsFolders = false;
};

using OpenAs = std::function<Result<std::unique_ptr<VolumeSource>>(const Format&)>;
using ListAs = std::function<Result<VolumeContents>(const Format&)>;
/// Opens what is there and of a known format by `openAs`, or as raw samples; what is thrown is an Error.
Result<std::unique_ptr<VolumeSource>> openBy(const OpenAs& openAs, const std::filesystem::path& path,
                                             const ReadOptions& options);
/// The same with listing.
Result<VolumeContents> listBy(const ListAs& listAs, const std::filesystem::path& path, const ReadOptions& options);

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
