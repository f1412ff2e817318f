#include <algorithm>
#include <cmath>

#include "core/base/file_system.h"
#include "core/volume_io/formats/arrays/hdf5_file.h"
#include "core/volume_io/formats/arrays/hdf5_placement.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/sources/array_source.h"
#include "core/volume_io/volume_choice.h"

// HDF5 states nothing of space: the last axis of a data set is taken for x, as NumPy users write z, y, x. Where the
// file follows openPMD, VTKHDF or MINC 2, or gives element_size_um as ilastik and Fiji do, spacing, origin and order
// are taken from there. NetCDF-4 files are HDF5; whatever they are named, they are read as NetCDF.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kFormat = "HDF5";

VolumeField fieldOf(const Hdf5Dataset& dataset, const Placement& placement) {
    VolumeField field;
    field.name = dataset.path;
    field.typeName = dataset.problem.empty() ? std::string(fileTypeName(dataset.type)) : "";
    field.problem = dataset.problem;
    field.dims = {1, 1, 1};
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (placement.axisOf[axis] >= 0) // extents beyond what is read are refused when it is opened
            field.dims[axis] = static_cast<std::int64_t>(std::min<std::uint64_t>(
                dataset.extents[static_cast<std::size_t>(placement.axisOf[axis])], std::uint64_t{1} << 62));
    if (dataset.extents.size() == 4)
        field.frames = static_cast<std::int64_t>(std::min<std::uint64_t>(dataset.extents[0], std::uint64_t{1} << 62));
    if (field.frames < 1) {
        field.frames = 1;
        field.problem = "it is a series of none";
    }
    return field;
}

hid_t memoryTypeId(FileType type) {
    switch (type) {
        case FileType::U8: return H5T_NATIVE_UINT8;
        case FileType::I8: return H5T_NATIVE_INT8;
        case FileType::U16: return H5T_NATIVE_UINT16;
        case FileType::I16: return H5T_NATIVE_INT16;
        case FileType::U32: return H5T_NATIVE_UINT32;
        case FileType::I32: return H5T_NATIVE_INT32;
        case FileType::U64: return H5T_NATIVE_UINT64;
        case FileType::I64: return H5T_NATIVE_INT64;
        case FileType::F16: break; // HDF5 widens these itself
        case FileType::F32: return H5T_NATIVE_FLOAT;
        case FileType::F64: return H5T_NATIVE_DOUBLE;
    }
    checkFailed("known FileType", __FILE__, __LINE__);
}

class Hdf5ArrayReader final : public ArrayReader {
public:
    Hdf5ArrayReader(Hdf5Handle file, Hdf5Handle dataset, std::string name, FileType type, fs::path path)
        : file_(std::move(file)),
          dataset_(std::move(dataset)),
          name_(std::move(name)),
          type_(type),
          path_(std::move(path)) {}
    ~Hdf5ArrayReader() override {
        const Hdf5Session session;
        dataset_.close();
        file_.close();
    }

    Status read(std::span<const std::uint64_t> start, std::span<const std::uint64_t> count,
                std::span<std::byte> out) override {
        const Hdf5Session session;
        const std::vector<hsize_t> begin(start.begin(), start.end()), size(count.begin(), count.end());
        const Hdf5Handle from(H5Dget_space(dataset_.id()), H5Sclose);
        const Hdf5Handle to(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
        if (H5Sselect_hyperslab(from.id(), H5S_SELECT_SET, begin.data(), nullptr, size.data(), nullptr) < 0 ||
            H5Dread(dataset_.id(), memoryTypeId(type_), to.id(), from.id(), H5P_DEFAULT, out.data()) < 0)
            return session.error("samples of " + inQuotes(name_) + " cannot be read", path_);
        return {};
    }

private:
    Hdf5Handle file_, dataset_;
    std::string name_;
    FileType type_;
    fs::path path_;
};

/// A file and what is in it.
struct Opened {
    Hdf5Handle file;
    Hdf5Tree tree;
    VolumeContents contents;
    std::vector<Placement> placements; ///< as many as fields
};

Result<Opened> openTree(const Hdf5Session& session, const fs::path& path) {
    auto file = openHdf5File(session, path);
    if (!file.isOk())
        return std::move(file).error();
    Opened opened;
    opened.file = std::move(file).value();
    opened.tree = walkHdf5(opened.file.id());
    opened.contents.format = kFormat;
    for (const Hdf5Dataset& dataset : opened.tree.datasets) {
        opened.placements.push_back(placementOf(opened.file.id(), dataset));
        opened.contents.fields.push_back(fieldOf(dataset, opened.placements.back()));
    }
    // The one that can be opened is preferred.
    const auto& fields = opened.contents.fields;
    const auto isSound = [](const VolumeField& field) { return field.problem.empty(); };
    const auto first = std::find_if(fields.begin(), fields.end(), isSound);
    if (first != fields.end()) {
        opened.contents.preferred = static_cast<std::size_t>(first - fields.begin());
        opened.contents.isPreferredChosen = std::count_if(fields.begin(), fields.end(), isSound) == 1;
    }
    return opened;
}

/// Everything but the samples. The order of the members is that in which they have to go.
struct Prepared {
    VolumeInfo info;
    ArrayView view;
    std::unique_ptr<ArrayReader> reader;
};

Result<Prepared> prepare(const fs::path& path, ReadOptions options, std::uint64_t fileBytes) {
    const Hdf5Session session;
    auto opened = openTree(session, path);
    if (!opened.isOk())
        return std::move(opened).error();
    Opened& tree = opened.value();
    if (!options.field.empty() && options.field[0] != '/')
        options.field.insert(0, "/");
    const auto chosen = chooseField(tree.contents, options, path);
    if (!chosen.isOk())
        return chosen.error();
    const Hdf5Dataset& dataset = tree.tree.datasets[chosen.value()];
    const VolumeField& field = tree.contents.fields[chosen.value()];
    const auto choice = chooseIn(field, options, path);
    const auto dims = checkDims(field.dims, "dims of " + inQuotes(field.name), path);
    if (!choice.isOk() || !dims.isOk())
        return !choice.isOk() ? choice.error() : dims.error();
    Hdf5Handle handle = openDataset(tree.file.id(), dataset.path);
    if (!handle.isOpen())
        return session.error(inQuotes(dataset.path) + " cannot be opened", path);
    ISO_TRY(checkStorage(session, handle.id(), dataset.path, path, fileBytes));

    Prepared prepared;
    Placement& placement = tree.placements[chosen.value()];
    prepared.info.format = kFormat;
    prepared.info.fieldName = dataset.path;
    prepared.info.lengthUnit = std::move(placement.lengthUnit);
    prepared.info.notes = std::move(placement.notes);
    if (tree.tree.isCut)
        prepared.info.notes.push_back("the file has more data sets than are listed");
    prepared.info.geometry = placement.geometry;
    prepared.info.geometry.dims = dims.value();
    ISO_TRY(checkGeometry(prepared.info.geometry, "gridSpacing, gridGlobalOffset", path));
    prepared.view.type = dataset.type;
    prepared.view.axisOf = placement.axisOf;
    prepared.view.start.assign(dataset.extents.size(), 0);
    if (dataset.extents.size() == 4)
        prepared.view.start[0] = static_cast<std::uint64_t>(choice.value().frame);
    prepared.reader =
        std::make_unique<Hdf5ArrayReader>(std::move(tree.file), std::move(handle), dataset.path, dataset.type, path);
    return prepared;
}

// The mark that the NetCDF library leaves in every file it writes.
bool isNetcdf4(const fs::path& path) {
    const Hdf5Session session;
    const auto file = openHdf5File(session, path);
    return file.isOk() && H5Aexists(file.value().id(), "_NCProperties") > 0;
}

ReadOptions netcdfOptions(ReadOptions options) { // where names have no slash in front
    if (options.field.starts_with('/'))
        options.field.erase(0, 1);
    return options;
}

} // namespace

Result<VolumeContents> listHdf5(const fs::path& path, const ReadOptions& options) {
    if (isNetcdf4(path))
        return listNetcdf(path, netcdfOptions(options));
    const Hdf5Session session;
    auto opened = openTree(session, path);
    if (!opened.isOk())
        return std::move(opened).error();
    ISO_TRY(checkAnyField(opened.value().contents, path));
    return std::move(opened.value().contents);
}

Result<std::unique_ptr<VolumeSource>> openHdf5(const fs::path& path, const ReadOptions& options) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    if (isNetcdf4(path))
        return openNetcdf(path, netcdfOptions(options));
    auto prepared = prepare(path, options, file.value()->sizeBytes());
    if (!prepared.isOk())
        return std::move(prepared).error();
    Prepared& parts = prepared.value();
    return makeArraySource(std::move(parts.info), std::move(parts.view), {}, std::move(parts.reader), path,
                           options.memoryBytes);
}

} // namespace isoslider::io
