#include "core/volume_io/reader_process/library_formats.h"

#include <algorithm>

#include "core/base/check.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

struct LibraryFormat {
    std::string_view name; ///< that of Format
    OpenFormat* open;
    ListFormat* list;
};

constexpr LibraryFormat kLibraryFormats[] = {
    {"VTK XML", openVtkXml, listVtkXml}, {"VTK", openVtkLegacy, listVtkLegacy}, {"PLOT3D", openPlot3d, listPlot3d},
    {"DICOM", openDicom, listDicom},     {"TIFF", openTiff, listTiff},          {"NetCDF", openNetcdf, listNetcdf},
    {"HDF5", openHdf5, listHdf5},
};

const LibraryFormat& libraryFormat(const Format& format) {
    const auto found = std::ranges::find(kLibraryFormats, format.name, &LibraryFormat::name);
    ISO_CHECK(found != std::end(kLibraryFormats));
    return *found;
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openInProcess(const fs::path& path, const ReadOptions& options) {
    const OpenAs openAs = [&](const Format& format) {
        return format.open != nullptr ? format.open(path, options) : libraryFormat(format).open(path, options);
    };
    return openBy(openAs, path, options);
}

Result<VolumeContents> listInProcess(const fs::path& path, const ReadOptions& options) {
    const ListAs listAs = [&](const Format& format) {
        return format.list != nullptr ? format.list(path, options) : libraryFormat(format).list(path, options);
    };
    return listBy(listAs, path, options);
}

} // namespace isoslider::io
