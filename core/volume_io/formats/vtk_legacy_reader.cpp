#include <algorithm>
#include <charconv>
#include <limits>
#include <locale>
#include <sstream>

#include <vtkCharArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStructuredPoints.h>
#include <vtkStructuredPointsReader.h>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/header_checks.h"
#include "core/volume_io/sample_source.h"
#include "core/volume_io/text_scanner.h"
#include "core/volume_io/formats/vtk_bridge.h"

// VTK reads the header and the samples, but only what has passed the gate here, handed over in
// memory: the checked header lines and the one array that is wanted. By itself VTK allocates what
// any header line asks for, reads every array to get at one, and on text that is no number warns
// and leaves the values unset.
// DEVIATION: "nan" and "inf" in text files are refused, for VTK reads neither; binary samples may be NaN.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

struct TypeName {
    std::string_view name;
    FileType type;
};
/// The first name of each type is the one that VTK is given.
constexpr TypeName kTypes[] = {
    {"unsigned_char", FileType::U8}, {"char", FileType::I8},         {"unsigned_short", FileType::U16},
    {"short", FileType::I16},        {"unsigned_int", FileType::U32}, {"int", FileType::I32},
    {"vtktypeuint64", FileType::U64}, {"vtktypeint64", FileType::I64}, {"unsigned_long", FileType::U64},
    {"long", FileType::I64},         {"vtkidtype", FileType::I32},   {"float", FileType::F32},
    {"double", FileType::F64}};

struct Array {
    std::string name;
    FileType type = FileType::F32;
    std::uint64_t components = 1;
};

/// What is below the middle between the largest float and the next step rounds to the former.
constexpr double kMaxFloat = 0x1.fffffefffffffp127;

template <class T>
bool isWithin(std::string_view word, T least = std::numeric_limits<T>::lowest(),
              T most = std::numeric_limits<T>::max()) {
    T value{};
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
    return problem == std::errc{} && end == word.data() + word.size() && value >= least && value <= most;
}

/// Whether VTK reads the whole word as a value of the type: anything else it would wrap or skip.
bool isSample(std::string_view word, FileType type) {
    if (word.size() > kMaxScannedWord)
        return false;
    switch (type) {
        case FileType::U8: return isWithin<std::uint16_t>(word, 0, 255);
        case FileType::I8: return isWithin<std::int16_t>(word, -128, 127);
        case FileType::U16: return isWithin<std::uint16_t>(word);
        case FileType::I16: return isWithin<std::int16_t>(word);
        case FileType::U32: return isWithin<std::uint32_t>(word);
        case FileType::I32: return isWithin<std::int32_t>(word);
        case FileType::U64: return isWithin<std::uint64_t>(word);
        case FileType::I64: return isWithin<std::int64_t>(word);
        case FileType::F32: return isWithin<double>(word, -kMaxFloat, kMaxFloat);
        case FileType::F16: break; // no type of VTK
        case FileType::F64: return isWithin<double>(word);
    }
    return false;
}

class LegacyReader {
public:
    LegacyReader(const RandomAccessFile& file, std::string field) : file_(file), scan_(file), field_(std::move(field)) {
        info_.format = "VTK image";
    }

    Result<std::unique_ptr<VolumeSource>> open() {
        ISO_TRY(readPreamble());
        ISO_TRY(readStructure());
        return findScalars();
    }

private:
    Error refuse(std::string_view field, std::string_view problem) const {
        return refuseField(field, problem, scan_.path());
    }

    Status readPreamble() {
        std::string line;
        if (!scan_.line(line) || !line.starts_with("# vtk DataFile Version"))
            return makeError(ErrorCode::InvalidArgument, "is not a VTK file: '# vtk DataFile Version' expected",
                             scan_.path());
        scan_.line(line); // title
        scan_.textLine(line);
        const std::string encoding = lowerCase(trimmed(line));
        if (encoding != "ascii" && encoding != "binary")
            return refuse("encoding", "ASCII or BINARY expected in the third line, found " + inQuotes(trimmed(line)));
        isBinary_ = encoding == "binary";
        if (!scan_.textLine(line))
            return refuse("DATASET", "missing: the file ends early");
        const auto dataset = words(line);
        if (dataset.size() != 2 || lowerCase(dataset[0]) != "dataset" || lowerCase(dataset[1]) != "structured_points")
            return refuse("DATASET", "STRUCTURED_POINTS expected, found " + inQuotes(trimmed(line)));
        return {};
    }

    Status readStructure() {
        std::vector<std::int64_t> sizes;
        std::string line;
        while (scan_.textLine(line)) {
            const auto parts = words(line);
            const std::string key = lowerCase(parts[0]);
            if (key == "point_data")
                return finishStructure(sizes, parts);
            if (key == "cell_data")
                return refuse("CELL_DATA", "values belong to cells; convert them to point data first");
            const std::string_view tail = trimmed(std::string_view(line)).substr(parts[0].size());
            std::vector<double> numbers;
            const bool isKnown = key == "dimensions" ? parseIntegers(tail, sizes) && sizes.size() == 3
                                                     : parseReals(tail, numbers) && numbers.size() == 3;
            if (!isKnown)
                return refuse(inQuotes(parts[0]), "three numbers expected");
            if (key == "spacing" || key == "aspect_ratio") {
                info_.geometry.spacing = {numbers[0], numbers[1], numbers[2]};
                spacingLine_ = trimmed(line);
            } else if (key == "origin") {
                info_.geometry.origin = {numbers[0], numbers[1], numbers[2]};
                originLine_ = trimmed(line);
            } else if (key != "dimensions") {
                return refuse(inQuotes(parts[0]), "is not known here");
            }
            if (scan_.position() > kMaxHeaderBytes)
                return refuse("header", "is longer than " + std::to_string(kMaxHeaderBytes) + " bytes");
        }
        return refuse("POINT_DATA", "missing: there are no samples");
    }

    Status finishStructure(std::span<const std::int64_t> sizes, std::span<const std::string_view> parts) {
        const auto dims = checkDims(sizes, "DIMENSIONS", scan_.path());
        if (!dims.isOk())
            return dims.error();
        info_.geometry.dims = dims.value();
        ISO_TRY(checkGeometry(info_.geometry, "SPACING, ORIGIN", scan_.path()));
        points_ = static_cast<std::uint64_t>(pointCount(dims.value()));
        const auto count = parts.size() == 2 ? parseInteger(parts[1]) : std::nullopt;
        if (!count || *count < 0 || static_cast<std::uint64_t>(*count) != points_)
            return refuse("POINT_DATA", "DIMENSIONS give " + std::to_string(points_) + " points");
        return {};
    }

    // Attributes follow each other; those before the wanted one are stepped over.
    Result<std::unique_ptr<VolumeSource>> findScalars() {
        std::string line;
        while (scan_.textLine(line)) {
            const auto parts = words(line);
            const std::string key = lowerCase(parts[0]);
            if (key == "field") {
                const auto arrays = parts.size() == 3 ? parseInteger(parts[2]) : std::nullopt;
                if (!arrays || *arrays < 0 || *arrays > 10000)
                    return refuse("FIELD", "a name and a number of arrays expected");
                fieldArrays_ = *arrays;
                continue;
            }
            if (key == "metadata") {
                while (scan_.line(line) && !trimmed(line).empty()) {}
                continue;
            }
            if (key == "cell_data")
                break;
            auto array = fieldArrays_ > 0 ? fieldArray(parts) : attribute(key, parts);
            if (!array.isOk())
                return std::move(array).error();
            fieldArrays_ -= fieldArrays_ > 0;
            const bool isWanted = field_.empty() ? array.value().components == 1 : array.value().name == field_;
            if (isWanted)
                return deliver(array.value());
            ISO_TRY(skip(array.value()));
        }
        return refuse("field", field_.empty() ? "the file has no array of scalars"
                                              : "the file has no array named " + inQuotes(field_));
    }

    Result<FileType> type(std::string_view name) const {
        for (const TypeName& known : kTypes)
            if (known.name == lowerCase(name))
                return known.type;
        return refuse("type", inQuotes(name) + " is not a known type of scalars");
    }

    Result<Array> makeArray(std::string_view name, std::string_view typeName, std::string_view components) const {
        const auto known = type(typeName);
        if (!known.isOk())
            return known.error();
        const auto count = parseInteger(components);
        if (!count || *count < 1 || *count > 1000)
            return refuse("components", inQuotes(components) + " is not a number of components");
        return Array{std::string(name), known.value(), static_cast<std::uint64_t>(*count)};
    }

    // "name components tuples type"
    Result<Array> fieldArray(std::span<const std::string_view> parts) const {
        if (parts.size() != 4 || parseInteger(parts[2]) != static_cast<std::int64_t>(points_))
            return refuse("FIELD", "an array with one value per point expected");
        return makeArray(parts[0], parts[3], parts[1]);
    }

    Result<Array> attribute(std::string_view key, std::span<const std::string_view> parts) {
        if (parts.size() < 2)
            return refuse("attribute", inQuotes(key) + " is not known here");
        if (key == "scalars" && parts.size() >= 3) {
            const std::uint64_t before = scan_.position();
            std::string line;
            if (!scan_.textLine(line) || !lowerCase(trimmed(line)).starts_with("lookup_table"))
                scan_.moveTo(before);
            return makeArray(parts[1], parts[2], parts.size() > 3 ? parts[3] : "1");
        }
        if ((key == "vectors" || key == "normals") && parts.size() == 3)
            return makeArray(parts[1], parts[2], "3");
        if (key == "tensors" && parts.size() == 3)
            return makeArray(parts[1], parts[2], "9");
        if (key == "texture_coordinates" && parts.size() == 4)
            return makeArray(parts[1], parts[3], parts[2]);
        if (key == "color_scalars" && parts.size() == 3)
            return makeArray(parts[1], "unsigned_char", parts[2]);
        return refuse("attribute", inQuotes(key) + " is not known here");
    }

    Status checkRoom(const Array& array) const {
        const std::uint64_t least = isBinary_ ? fileTypeSizeBytes(array.type) : 1;
        if (points_ * array.components > scan_.remaining() / least)
            return makeError(ErrorCode::Corruption,
                             "file ends early: " + inQuotes(array.name) + " needs " +
                                 std::to_string(points_ * array.components * least) + " bytes or more, " +
                                 std::to_string(scan_.remaining()) + " remain",
                             scan_.path(), scan_.position());
        return {};
    }

    Status skip(const Array& array) {
        ISO_TRY(checkRoom(array));
        if (isBinary_) {
            scan_.moveTo(scan_.position() + points_ * array.components * fileTypeSizeBytes(array.type));
            return {};
        }
        std::string ignored;
        for (std::uint64_t i = 0; i < points_ * array.components; ++i)
            if (!scan_.word(ignored))
                return refuse(array.name, "file ends early");
        return {};
    }

    Result<std::unique_ptr<VolumeSource>> deliver(const Array& array) {
        if (array.components != 1)
            return refuse("components", inQuotes(array.name) + " has " + std::to_string(array.components) +
                                            "; only scalar volumes are read");
        ISO_TRY(checkRoom(array));
        info_.fieldName = array.name;
        const std::uint64_t sampleBytes = points_ * fileTypeSizeBytes(array.type);
        const std::uint64_t fileBytes = isBinary_ ? sampleBytes : scan_.remaining();
        ISO_TRY(checkFitsMemory(2 * fileBytes + 2 * sampleBytes, scan_.path())); // VTK copies both
        std::string text = headerFor(array);
        ISO_TRY(isBinary_ ? appendSamples(text, sampleBytes) : appendWords(text, array.type));
        return readByVtk(std::move(text));
    }

    std::string headerFor(const Array& array) const {
        const GridDims& dims = info_.geometry.dims;
        const auto* known = std::ranges::find(kTypes, array.type, &TypeName::type);
        std::ostringstream text;
        text.imbue(std::locale::classic());
        text << "# vtk DataFile Version 3.0\nvolume\n" << (isBinary_ ? "BINARY" : "ASCII")
             << "\nDATASET STRUCTURED_POINTS\nDIMENSIONS " << dims[0] << ' ' << dims[1] << ' ' << dims[2] << '\n'
             << spacingLine_ << '\n' << originLine_ << "\nPOINT_DATA " << points_ << "\nSCALARS samples "
             << known->name << " 1\nLOOKUP_TABLE default\n";
        return text.str();
    }

    Status appendSamples(std::string& text, std::uint64_t sizeBytes) {
        const std::size_t begin = text.size();
        text.resize(begin + sizeBytes);
        return file_.readExactlyAt(scan_.position(), std::as_writable_bytes(std::span(text).subspan(begin)));
    }

    Status appendWords(std::string& text, FileType type) {
        std::string word;
        for (std::uint64_t i = 0; i < points_; ++i) {
            scan_.word(word);
            if (!isSample(word, type))
                return makeError(ErrorCode::InvalidArgument,
                                 "sample " + std::to_string(i) + ": " + inQuotes(word) + " is not a value of its type",
                                 scan_.path(), scan_.position());
            text += word;
            text += '\n';
        }
        return {};
    }

    Result<std::unique_ptr<VolumeSource>> readByVtk(std::string text) {
        const VtkSession session;
        const vtkNew<vtkCharArray> input;
        input->SetArray(text.data(), static_cast<vtkIdType>(text.size()), 1);
        const vtkNew<vtkStructuredPointsReader> reader;
        reader->ReadFromInputStringOn();
        reader->SetInputArray(input);
        reader->Update();
        vtkImageData* image = reader->GetOutput();
        if (!session.complaint().empty() || !session.warning().empty() || image == nullptr)
            return session.error(session.warning(), scan_.path());
        const GridDims dims = info_.geometry.dims;
        vtkDataArray* array = image->GetPointData()->GetArray("samples");
        if (array == nullptr || array->GetNumberOfComponents() != 1 || array->GetNumberOfTuples() != pointCount(dims))
            return session.error("the array has not one value per point", scan_.path());
        info_.geometry = geometryOf(*image, dims);
        auto grid = toGrid(info_.geometry, *array, scan_.path());
        if (!grid.isOk())
            return std::move(grid).error();
        return makeMemorySource(std::make_shared<const ScalarGrid>(std::move(grid).value()), std::move(info_));
    }

    VolumeInfo info_;
    const RandomAccessFile& file_;
    TextScanner scan_;
    std::string field_;
    std::string spacingLine_, originLine_; ///< as the file has them, checked
    bool isBinary_ = false;
    std::uint64_t points_ = 0;
    std::int64_t fieldArrays_ = 0;
};

} // namespace

Result<std::unique_ptr<VolumeSource>> openVtkLegacy(const fs::path& path, const ReadOptions& options) {
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    return LegacyReader(*file.value(), options.field).open();
}

} // namespace isoslider::io
