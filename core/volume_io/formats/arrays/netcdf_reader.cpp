#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <netcdf.h>

#include "core/base/file_system.h"
#include "core/grid/length_unit.h"
#include "core/volume_io/formats/arrays/hdf5_file.h"
#include "core/volume_io/formats/arrays/netcdf_catalogue.h"
#include "core/volume_io/formats/arrays/netcdf_classic_header.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/resampling/rectilinear_resampler.h"
#include "core/volume_io/sources/array_source.h"
#include "core/volume_io/volume_choice.h"

// Classic and NetCDF-4 files by the NetCDF library. What variables mean is read by the CF conventions: coordinate
// variables, missing values, packing.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

/// An open file; closed within a session.
class NetcdfFile {
public:
    NetcdfFile() = default;
    explicit NetcdfFile(int id) : id_(id) {}
    NetcdfFile(NetcdfFile&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
    NetcdfFile& operator=(NetcdfFile&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    ~NetcdfFile() { close(); }
    void close() {
        if (id_ >= 0)
            nc_close(std::exchange(id_, -1));
    }
    int id() const { return id_; }

private:
    int id_ = -1;
};

Error netcdfError(std::string_view what, int code, const fs::path& path) {
    return makeError(ErrorCode::Corruption, std::string(what) + ": " + nc_strerror(code), path);
}

Result<NetcdfFile> openFile(const fs::path& path) {
    const auto bytes = defaultFileSystem().openForReading(path);
    if (!bytes.isOk())
        return bytes.error();
    ISO_TRY(checkClassicNetcdf(*bytes.value()));
    int id = -1;
    // With an absolute path nothing in a name can pass for an address.
    std::error_code ignored;
    const int code = nc_open(fs::absolute(path, ignored).c_str(), NC_NOWRITE, &id);
    if (code != NC_NOERR)
        return netcdfError("is not readable NetCDF", code, path);
    return NetcdfFile(id);
}

bool isHdf5Based(int file) {
    int format = 0;
    return nc_inq_format(file, &format) == NC_NOERR &&
           (format == NC_FORMAT_NETCDF4 || format == NC_FORMAT_NETCDF4_CLASSIC);
}

class NetcdfArrayReader final : public ArrayReader {
public:
    NetcdfArrayReader(NetcdfFile file, const NetcdfVariable& variable, fs::path path)
        : file_(std::move(file)),
          group_(variable.group),
          id_(variable.id),
          name_(variable.name),
          path_(std::move(path)) {}
    ~NetcdfArrayReader() override {
        const Hdf5Session session;
        file_.close();
    }

    Status read(std::span<const std::uint64_t> start, std::span<const std::uint64_t> count,
                std::span<std::byte> out) override {
        const Hdf5Session session;
        const std::vector<std::size_t> begin(start.begin(), start.end()), size(count.begin(), count.end());
        const int code = nc_get_vara(group_, id_, begin.data(), size.data(), out.data());
        if (code != NC_NOERR)
            return netcdfError("samples of " + inQuotes(name_) + " cannot be read", code, path_);
        return {};
    }

private:
    NetcdfFile file_;
    int group_, id_;
    std::string name_;
    fs::path path_;
};

std::string shortText(double value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return std::string(text, end);
}

/// What the attributes of a variable state of its values.
class MeaningReader {
public:
    MeaningReader(const NetcdfVariable& variable, const fs::path& path) : variable_(variable), path_(path) {
        isUnsigned_ = lowerCase(text("_Unsigned")) == "true";
        type_ = netcdfFileType(variable.type, isUnsigned_);
    }

    FileType type() const { return type_; }

    Result<ArrayMeaning> run(std::vector<std::string>& notes) {
        readMissing(notes);
        ISO_TRY(readPacking());
        if (const std::string units = text("units"); !units.empty())
            notes.push_back("values are in " + inQuotes(units));
        return std::move(meaning_);
    }

private:
    std::string text(const char* name) const { return netcdfText(variable_.group, variable_.id, name); }
    std::vector<double> numbers(const char* name, int* type = nullptr) const {
        return netcdfNumbers(variable_.group, variable_.id, name, type);
    }

    /// As the samples come: unsigned ones are stored under signed types in classic files.
    double asStored(double value) const {
        return isUnsigned_ && value < 0 ? value + std::ldexp(1.0, 8 * static_cast<int>(fileTypeSizeBytes(type_)))
                                        : value;
    }

    void readMissing(std::vector<std::string>& notes) {
        const auto fill = numbers("_FillValue");
        std::vector<double> values = numbers("missing_value");
        values.insert(values.begin(), fill.begin(), fill.end());
        for (const double value : values) {
            if (std::isnan(value))
                continue;
            meaning_.missing.push_back(asStored(value));
            if (type_ == FileType::F32) // 1e20 as text or f64 is another number than the f32 that stands for it
                meaning_.missing.push_back(static_cast<double>(static_cast<float>(value)));
            notes.push_back("the stored value " + shortText(value) + " is missing");
        }
        // What the library leaves where nothing was written. Integers may well have such values.
        if (fill.empty() && (type_ == FileType::F32 || type_ == FileType::F64))
            meaning_.missing.push_back(type_ == FileType::F32 ? static_cast<double>(NC_FILL_FLOAT) : NC_FILL_DOUBLE);
        std::sort(meaning_.missing.begin(), meaning_.missing.end());
        meaning_.missing.erase(std::unique(meaning_.missing.begin(), meaning_.missing.end()), meaning_.missing.end());
        readValidRange(notes);
    }

    void readValidRange(std::vector<std::string>& notes) {
        if (const auto range = numbers("valid_range"); range.size() == 2) {
            meaning_.low = asStored(range[0]);
            meaning_.high = asStored(range[1]);
        }
        if (const auto low = numbers("valid_min"); low.size() == 1)
            meaning_.low = asStored(low[0]);
        if (const auto high = numbers("valid_max"); high.size() == 1)
            meaning_.high = asStored(high[0]);
        if (meaning_.low || meaning_.high)
            notes.push_back("stored values outside the valid range " +
                            (meaning_.low ? shortText(*meaning_.low) : std::string("..")) + " to " +
                            (meaning_.high ? shortText(*meaning_.high) : std::string("..")) + " are missing");
    }

    Status readPacking() {
        int slopeType = NC_FLOAT, offsetType = NC_FLOAT;
        const auto slope = numbers("scale_factor", &slopeType), offset = numbers("add_offset", &offsetType);
        if (slope.empty() && offset.empty())
            return {};
        Rescale rescale{slope.empty() ? 1.0 : slope[0], offset.empty() ? 0.0 : offset[0]};
        if (!std::isfinite(rescale.slope) || rescale.slope == 0.0 || !std::isfinite(rescale.intercept))
            return refuseField("scale_factor, add_offset", "are no numbers that values can be packed with", path_);
        meaning_.rescale = rescale;
        // CF: unpacked values are of the type of these attributes. More than 16 bits do not fit f32.
        meaning_.isRescaleWide = slopeType != NC_FLOAT || offsetType != NC_FLOAT || fileTypeSizeBytes(type_) > 2;
        if (type_ == FileType::F32)
            meaning_.isRescaleWide = slopeType == NC_DOUBLE || offsetType == NC_DOUBLE;
        return {};
    }

    const NetcdfVariable& variable_;
    const fs::path& path_;
    bool isUnsigned_ = false;
    FileType type_;
    ArrayMeaning meaning_;
};

/// Where samples lie along one axis; by index, with a note, where the file gives no usable places.
GridAxis coordinatesOf(const NetcdfAxis& axis, std::vector<std::string>& notes, const fs::path& path) {
    const auto count = static_cast<std::int64_t>(axis.extent);
    if (axis.variable < 0) {
        notes.push_back(inQuotes(axis.name) + " has no coordinates: spacing 1 is taken");
        return indexAxis(count);
    }
    std::vector<double> places(axis.extent);
    if (nc_get_var_double(axis.group, axis.variable, places.data()) != NC_NOERR) {
        notes.push_back("the coordinates of " + inQuotes(axis.name) + " cannot be read: spacing 1 is taken");
        return indexAxis(count);
    }
    if (axis.isDownwards)
        for (double& place : places)
            place = -place;
    auto made = makeAxis(std::move(places), axis.name, path);
    if (!made.isOk()) {
        notes.push_back(made.error().message + ": spacing 1 is taken");
        return indexAxis(count);
    }
    if (axis.isDownwards)
        notes.push_back(inQuotes(axis.name) + " grows downwards: its negative is taken, so that up is up");
    return std::move(made).value();
}

/// The unit of all axes of space, if they have one of length; else it is noted what their coordinates are in.
std::string lengthUnitOf(const NetcdfVariable& variable, std::vector<std::string>& notes) {
    std::vector<std::string> own;
    std::set<std::string> units;
    for (const int index : variable.axisOf) {
        if (index < 0)
            continue;
        const NetcdfAxis& axis = variable.axes[static_cast<std::size_t>(index)];
        const std::string unit = axis.variable < 0 ? "" : netcdfText(axis.group, axis.variable, "units");
        units.insert(knownLengthUnit(unit));
        if (!unit.empty())
            own.push_back(inQuotes(axis.name) + " is in " + inQuotes(unit));
    }
    if (units.size() == 1 && !units.begin()->empty())
        return *units.begin();
    notes.insert(notes.end(), own.begin(), own.end());
    return {};
}

/// All of a variable but its samples, read while nobody else calls the library.
struct Prepared {
    VolumeInfo info;
    ArrayView view;
    ArrayMeaning meaning;
    std::array<GridAxis, 3> axes;
    std::unique_ptr<ArrayReader> reader;
};

/// A variable of an open file.
struct Chosen {
    NetcdfFile file;
    NetcdfVariable variable;
    VolumeField field;
};

Result<Chosen> choose(const fs::path& path, const ReadOptions& options) {
    auto file = openFile(path);
    if (!file.isOk())
        return std::move(file).error();
    auto variables = catalogueNetcdf(file.value().id(), path);
    if (!variables.isOk())
        return std::move(variables).error();
    VolumeContents contents = contentsOf(variables.value());
    const auto index = chooseField(contents, options, path);
    if (!index.isOk())
        return index.error();
    return Chosen{std::move(file).value(), std::move(variables.value()[index.value()]),
                  std::move(contents.fields[index.value()])};
}

/// Of a NetCDF-4 file, which must not be open in the NetCDF library: the two ask for different ways of closing it.
Status checkHdf5Storage(const Hdf5Session& session, const NetcdfVariable& variable, const fs::path& path) {
    const auto bytes = defaultFileSystem().openForReading(path);
    if (!bytes.isOk())
        return bytes.error();
    const std::uint64_t fileBytes = bytes.value()->sizeBytes();
    const auto hdf5 = openHdf5File(session, path);
    if (!hdf5.isOk())
        return hdf5.error();
    const std::size_t slash = variable.name.rfind('/');
    const std::size_t leaf = slash == std::string::npos ? 0 : slash + 1;
    Hdf5Handle dataset = openDataset(hdf5.value().id(), "/" + variable.name);
    if (!dataset.isOpen()) // that of a variable named as a dimension that is not its own
        dataset = openDataset(hdf5.value().id(),
                              "/" + variable.name.substr(0, leaf) + "_nc4_non_coord_" + variable.name.substr(leaf));
    if (!dataset.isOpen())
        return session.error(inQuotes(variable.name) + " cannot be opened", path);
    return checkStorage(session, dataset.id(), variable.name, path, fileBytes);
}

std::vector<std::uint64_t> startOf(const NetcdfVariable& variable, std::int64_t frame) {
    std::vector<std::uint64_t> start(variable.axes.size(), 0);
    auto left = static_cast<std::uint64_t>(frame);
    for (auto axis = variable.others.rbegin(); axis != variable.others.rend(); ++axis) {
        const std::uint64_t extent = variable.axes[*axis].extent; // not 0: there is such a frame
        start[*axis] = left % extent;
        left /= extent;
    }
    return start;
}

Result<Prepared> prepare(const fs::path& path, const ReadOptions& options) {
    const Hdf5Session session;
    auto chosen = choose(path, options);
    if (!chosen.isOk())
        return std::move(chosen).error();
    const VolumeField field = chosen.value().field;
    const auto dims = checkDims(field.dims, "dims of " + inQuotes(field.name), path);
    const auto choice = chooseIn(field, options, path);
    if (!choice.isOk() || !dims.isOk())
        return !dims.isOk() ? dims.error() : choice.error();
    if (isHdf5Based(chosen.value().file.id())) { // a classic file is checked before it is opened
        chosen.value().file.close();
        ISO_TRY(checkHdf5Storage(session, chosen.value().variable, path));
        chosen = choose(path, options);
        if (!chosen.isOk())
            return std::move(chosen).error();
    }
    const NetcdfVariable& variable = chosen.value().variable;

    Prepared prepared;
    prepared.info.format = "NetCDF";
    prepared.info.fieldName = variable.name;
    prepared.info.fieldTitle = field.title;
    prepared.info.geometry.dims = dims.value();
    MeaningReader reader(variable, path);
    auto meaning = reader.run(prepared.info.notes);
    if (!meaning.isOk())
        return std::move(meaning).error();
    prepared.meaning = std::move(meaning).value();
    prepared.view.type = reader.type();
    prepared.view.axisOf = variable.axisOf;
    prepared.view.start = startOf(variable, choice.value().frame);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int own = variable.axisOf[axis];
        prepared.axes[axis] =
            own < 0 ? indexAxis(1)
                    : coordinatesOf(variable.axes[static_cast<std::size_t>(own)], prepared.info.notes, path);
        prepared.view.isFlipped[axis] = prepared.axes[axis].isDescending;
    }
    prepared.info.lengthUnit = lengthUnitOf(variable, prepared.info.notes);
    prepared.reader = std::make_unique<NetcdfArrayReader>(std::move(chosen.value().file), variable, path);
    return prepared;
}

} // namespace

Result<VolumeContents> listNetcdf(const fs::path& path, const ReadOptions& options) {
    const Hdf5Session session;
    const auto file = openFile(path);
    if (!file.isOk())
        return file.error();
    const auto variables = catalogueNetcdf(file.value().id(), path);
    if (!variables.isOk())
        return variables.error();
    VolumeContents contents = contentsOf(variables.value());
    ISO_TRY(checkAnyField(contents, path));
    std::map<std::pair<int, int>, GridAxis> known; // by coordinate variable, each read once
    const auto gridAxis = [&](const NetcdfAxis& axis) {
        if (axis.variable < 0)
            return indexAxis(static_cast<std::int64_t>(axis.extent));
        const auto [at, isNew] = known.try_emplace({axis.group, axis.variable});
        std::vector<std::string> ignored;
        if (isNew)
            at->second = coordinatesOf(axis, ignored, path);
        return at->second;
    };
    for (std::size_t i = 0; i < contents.fields.size(); ++i) {
        VolumeField& field = contents.fields[i];
        const NetcdfVariable& variable = variables.value()[i];
        std::array<GridAxis, 3> axes;
        for (std::size_t place = 0; place < 3; ++place) {
            axes[place] = indexAxis(1);
            if (variable.axisOf[place] < 0)
                continue;
            const NetcdfAxis& axis = variable.axes[static_cast<std::size_t>(variable.axisOf[place])];
            if (axis.extent < 1 || axis.extent > static_cast<std::uint64_t>(kMaxDim))
                continue;
            axes[place] = gridAxis(axis);
            field.isResampled = field.isResampled || !axes[place].isEven;
        }
        if (!field.isResampled)
            continue;
        field.dims =
            options.resampleDims == GridDims{0, 0, 0} ? defaultDims(axes, options.memoryBytes) : options.resampleDims;
    }
    return contents;
}

Result<std::unique_ptr<VolumeSource>> openNetcdf(const fs::path& path, const ReadOptions& options) {
    auto prepared = prepare(path, options);
    if (!prepared.isOk())
        return std::move(prepared).error();
    Prepared& parts = prepared.value();
    auto source = makeArraySource(std::move(parts.info), std::move(parts.view), std::move(parts.meaning),
                                  std::move(parts.reader), path, options.memoryBytes);
    return placeOnAxes(std::move(source), std::move(parts.axes), options, path);
}

} // namespace isoslider::io
