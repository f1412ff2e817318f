#include <algorithm>
#include <array>
#include <cstring>
#include <system_error>

#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

// What is looked at to know a format: a DICOM file reports it at byte 128, an MRC map at 208.
constexpr std::size_t kStartBytes = 512;

constexpr std::string_view kMetaImage[] = {".mhd", ".mha"};
constexpr std::string_view kNrrd[] = {".nrrd", ".nhdr"};
constexpr std::string_view kNifti[] = {".nii", ".nii.gz", ".hdr", ".img", ".hdr.gz", ".img.gz"};
constexpr std::string_view kVtkXml[] = {".vti", ".vtr", ".vts", ".vtu"};
constexpr std::string_view kVtkLegacy[] = {".vtk"};
constexpr std::string_view kMrc[] = {".mrc",    ".map",    ".ccp4",    ".rec",    ".st",    ".mrcs",
                                     ".mrc.gz", ".map.gz", ".ccp4.gz", ".rec.gz", ".st.gz", ".mrcs.gz"};
constexpr std::string_view kCube[] = {".cube", ".cub", ".cube.gz", ".cub.gz"};
constexpr std::string_view kPlot3d[] = {"xyz.bin", "q.bin", ".xyz", ".q", ".p3d"};
constexpr std::string_view kDicom[] = {".dcm", ".ima", ".dicom"};
constexpr std::string_view kTiff[] = {".tif", ".tiff"};
constexpr std::string_view kNetcdf[] = {".nc", ".nc4", ".cdf", ".netcdf"};
constexpr std::string_view kHdf5[] = {".h5", ".hdf5", ".he5", ".hdf", ".vtkhdf"};

template <std::size_t size>
bool beginsWith(std::span<const std::byte> start, const char (&magic)[size]) {
    return start.size() >= size - 1 && std::memcmp(start.data(), magic, size - 1) == 0;
}

bool contains(std::span<const std::byte> start, std::string_view words) {
    return std::string_view(reinterpret_cast<const char*>(start.data()), start.size()).find(words) !=
           std::string_view::npos;
}

// A text of "Key = value" lines; one of these comes first in what programs write.
bool isMetaImage(const fs::path&, std::span<const std::byte> start) {
    return (beginsWith(start, "ObjectType") || beginsWith(start, "NDims") || beginsWith(start, "Comment")) &&
           contains(start, "NDims");
}
bool isVtkXml(const fs::path&, std::span<const std::byte> start) {
    return (beginsWith(start, "<?xml") || beginsWith(start, "<VTKFile")) && contains(start, "<VTKFile");
}
bool isNrrd(const fs::path&, std::span<const std::byte> start) { return beginsWith(start, "NRRD000"); }
bool isNifti(const fs::path&, std::span<const std::byte> start) {
    return start.size() >= 348 && (beginsWith(start.subspan(344), "n+1") || beginsWith(start.subspan(4), "n+2"));
}
bool isMrc(const fs::path&, std::span<const std::byte> start) {
    return start.size() >= 212 && beginsWith(start.subspan(208), "MAP ");
}
bool isVtkLegacy(const fs::path&, std::span<const std::byte> start) { return beginsWith(start, "# vtk DataFile"); }
// NetCDF-4 files are HDF5; unless the name is that of NetCDF, they are read as that.
bool isNetcdf(const fs::path&, std::span<const std::byte> start) {
    return beginsWith(start, "CDF\1") || beginsWith(start, "CDF\2") || beginsWith(start, "CDF\5");
}
bool isHdf5(const fs::path&, std::span<const std::byte> start) { return beginsWith(start, "\x89HDF\r\n\x1a\n"); }

const Format kFormats[] = {
    {"MetaImage", kMetaImage, openMetaImage, listMetaImage, isMetaImage},
    {"NRRD", kNrrd, openNrrd, listNrrd, isNrrd},
    {"NIfTI", kNifti, openNifti, listNifti, isNifti},
    {"VTK XML", kVtkXml, nullptr, nullptr, isVtkXml},
    {"VTK", kVtkLegacy, nullptr, nullptr, isVtkLegacy},
    {"PLOT3D", kPlot3d},
    {"MRC", kMrc, openMrc, listMrc, isMrc},
    {"Gaussian cube", kCube, openCube, listCube},
    {"DICOM", kDicom, nullptr, nullptr, isDicom, true},
    {"TIFF", kTiff, nullptr, nullptr, isTiff, true},
    {"NetCDF", kNetcdf, nullptr, nullptr, isNetcdf},
    {"HDF5", kHdf5, nullptr, nullptr, isHdf5},
};

} // namespace

std::span<const Format> knownFormats() { return kFormats; }

Result<const Format*> findFormat(const fs::path& path) {
    const bool isSeries = isFolder(path);
    std::array<std::byte, kStartBytes> buffer;
    std::span<const std::byte> start;
    if (!isSeries) {
        const std::string name = lowerCase(path.filename().string());
        for (const Format& format : kFormats)
            if (std::any_of(format.suffixes.begin(), format.suffixes.end(),
                            [&](std::string_view suffix) { return name.ends_with(suffix); }))
                return &format;
        const auto file = defaultFileSystem().openForReading(path);
        if (!file.isOk())
            return file.error();
        const auto count = file.value()->readAt(0, buffer);
        if (!count.isOk())
            return count.error();
        start = std::span(buffer).first(count.value());
    }
    for (const Format& format : kFormats)
        if (format.recognises != nullptr && format.readsFolders >= isSeries && format.recognises(path, start))
            return &format;
    return makeError(ErrorCode::InvalidArgument,
                     isSeries
                         ? "is a folder without slices of a volume"
                         : "is of no volume format that is known by name or content; raw samples need dims and type",
                     path);
}

} // namespace isoslider::io
