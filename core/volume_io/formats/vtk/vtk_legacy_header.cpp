#include "core/volume_io/formats/vtk/vtk_legacy_header.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <span>

#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/parsing/text_scanner.h"

namespace isoslider::io {
namespace {

constexpr std::int64_t kMaxComponents = 1000;
constexpr std::int64_t kMaxFieldArrays = 10000;
constexpr std::int64_t kMaxCount = std::int64_t{1} << 40;

struct TypeName {
    std::string_view name;
    FileType type;
};
/// The first name of each type is the one that VTK is given.
constexpr TypeName kTypes[] = {
    {"unsigned_char", FileType::U8},  {"char", FileType::I8},          {"unsigned_short", FileType::U16},
    {"short", FileType::I16},         {"unsigned_int", FileType::U32}, {"int", FileType::I32},
    {"vtktypeuint64", FileType::U64}, {"vtktypeint64", FileType::I64}, {"unsigned_long", FileType::U64},
    {"long", FileType::I64},          {"vtkidtype", FileType::I32},    {"float", FileType::F32},
    {"double", FileType::F64}};

/// What is below the middle between the largest float and the next step rounds to the former.
constexpr double kMaxFloat = 0x1.fffffefffffffp127;

template <class T>
bool isWithin(std::string_view word, T least = std::numeric_limits<T>::lowest(),
              T most = std::numeric_limits<T>::max()) {
    const auto value = parseNumber<T>(word);
    return value && *value >= least && *value <= most;
}

using Words = std::vector<std::string_view>;

class LegacyWalk {
public:
    LegacyWalk(const RandomAccessFile& file, const LegacyRequest& request)
        : file_(file), scan_(file), request_(request) {}

    Result<LegacyFile> run() {
        ISO_TRY(readPreamble());
        ISO_TRY(readStructure());
        ISO_TRY(readArrays());
        return std::move(out_);
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
        out_.isBinary = encoding == "binary";
        if (!scan_.textLine(line))
            return refuse("DATASET", "missing: the file ends early");
        const auto dataset = words(line);
        constexpr std::string_view kKinds[] = {"structured_points", "rectilinear_grid", "structured_grid",
                                               "unstructured_grid"};
        const std::string kind = dataset.size() == 2 ? lowerCase(dataset[1]) : "";
        const auto* found = std::find(std::begin(kKinds), std::end(kKinds), kind);
        if (lowerCase(dataset[0]) != "dataset" || found == std::end(kKinds))
            return refuse("DATASET", "STRUCTURED_POINTS, RECTILINEAR_GRID, STRUCTURED_GRID or UNSTRUCTURED_GRID "
                                     "expected, found " +
                                         inQuotes(trimmed(line)));
        out_.kind = static_cast<VtkKind>(found - std::begin(kKinds));
        keep(trimmed(line));
        return {};
    }

    void keep(std::string_view line) {
        if (request_.keepsStructure)
            (out_.structure += line) += '\n';
    }

    Status readStructure() {
        std::string line;
        while (scan_.textLine(line)) {
            const auto parts = words(line);
            const std::string key = lowerCase(parts[0]);
            if (key == "point_data" || key == "cell_data") {
                ISO_TRY(finishStructure());
                return key == "point_data" ? checkPointCount(parts) : stepOverCells(parts);
            }
            ISO_TRY(readSection(key, line, parts));
            if (++sections_ > 64 || headerBytes_ > kMaxHeaderBytes)
                return refuse("header", "is longer than " + std::to_string(kMaxHeaderBytes) + " bytes or 64 lines");
        }
        return refuse("POINT_DATA", "missing: there are no samples");
    }

    Status readSection(const std::string& key, const std::string& line, const Words& parts) {
        headerBytes_ += line.size();
        if (key == "field") {
            ISO_TRY(beginField(parts));
            for (; fieldArrays_ > 0; --fieldArrays_)
                ISO_TRY(stepOverFieldArray());
            return {};
        }
        if (key == "metadata")
            return stepOverMetadata();
        if (key == "dimensions" && out_.kind != VtkKind::Unstructured) {
            keep(trimmed(line));
            const auto tail = trimmed(std::string_view(line)).substr(parts[0].size());
            return parseIntegers(tail, sizes_) && sizes_.size() == 3
                       ? Status()
                       : Status(refuse("'DIMENSIONS'", "three numbers expected"));
        }
        if (out_.kind == VtkKind::Image)
            return readImagePlace(key, line, parts);
        if (out_.kind == VtkKind::Rectilinear && key.ends_with("_coordinates") && key.size() == 13)
            return readNumbers(key, line, parts, 1);
        if (out_.kind != VtkKind::Rectilinear && key == "points")
            return readNumbers(key, line, parts, 3);
        if (out_.kind == VtkKind::Unstructured && (key == "cells" || key == "cell_types"))
            return readCells(key, line, parts);
        return refuse(inQuotes(parts[0]), "is not known here");
    }

    Status readImagePlace(const std::string& key, const std::string& line, const Words& parts) {
        std::vector<double> numbers;
        if (!parseReals(trimmed(std::string_view(line)).substr(parts[0].size()), numbers) || numbers.size() != 3)
            return refuse(inQuotes(parts[0]), "three numbers expected");
        if (key == "spacing" || key == "aspect_ratio")
            place_.spacing = {numbers[0], numbers[1], numbers[2]};
        else if (key == "origin")
            place_.origin = {numbers[0], numbers[1], numbers[2]};
        else
            return refuse(inQuotes(parts[0]), "is not known here");
        keep(trimmed(line));
        return {};
    }

    // "POINTS n type", "X_COORDINATES n type"
    Status readNumbers(const std::string& key, const std::string& line, const Words& parts, std::uint64_t each) {
        const auto count = parts.size() == 3 ? parseInteger(parts[1]) : std::nullopt;
        if (!count || *count < 1 || *count > kMaxCount)
            return refuse(inQuotes(parts[0]), "a number of points and a type expected");
        const auto known = type(parts[2]);
        if (!known.isOk())
            return known.error();
        if (key == "points") {
            if (out_.points != 0)
                return refuse("POINTS", "is given twice");
            out_.points = static_cast<std::uint64_t>(*count);
        } else {
            const auto axis = static_cast<std::size_t>(key[0] - 'x');
            if (axis > 2)
                return refuse(inQuotes(parts[0]), "is not known here");
            if (sizes_.size() == 3 && sizes_[axis] != *count) // before its numbers are taken for something else
                return refuse(inQuotes(parts[0]), "DIMENSIONS give " + std::to_string(sizes_[axis]) + " coordinates");
            axisPoints_[axis] = *count;
        }
        keep(trimmed(line));
        return keepValues(key, known.value(), static_cast<std::uint64_t>(*count) * each);
    }

    // "CELLS n size" and numbers, or since 5.1 "CELLS offsets size" and two arrays; "CELL_TYPES n" and numbers.
    Status readCells(const std::string& key, const std::string& line, const Words& parts) {
        const bool isTypes = key == "cell_types";
        const auto first = parts.size() == (isTypes ? 2u : 3u) ? parseInteger(parts[1]) : std::nullopt;
        const auto second = first && !isTypes ? parseInteger(parts[2]) : first;
        if (!first || !second || *first < 1 || *second < 1 || *first > kMaxCount || *second > kMaxCount)
            return refuse(inQuotes(parts[0]), "numbers of cells and of points in them expected");
        keep(trimmed(line));
        if (isTypes) {
            cellTypes_ = *first;
            return keepValues(key, FileType::I32, static_cast<std::uint64_t>(*first));
        }
        const std::uint64_t before = scan_.position();
        std::string next;
        if (scan_.textLine(next) && lowerCase(trimmed(next)).starts_with("offsets")) {
            cells_ = *first - 1;
            out_.hasOffsets = true;
            ISO_TRY(keepCellArray("offsets", next, static_cast<std::uint64_t>(*first)));
            if (!scan_.textLine(next))
                return refuse("CONNECTIVITY", "missing: the file ends early");
            return keepCellArray("connectivity", next, static_cast<std::uint64_t>(*second));
        }
        scan_.moveTo(before);
        cells_ = *first;
        return keepValues(key, FileType::I32, static_cast<std::uint64_t>(*second));
    }

    Status keepCellArray(std::string_view key, const std::string& line, std::uint64_t count) {
        const auto parts = words(line);
        if (parts.size() != 2 || lowerCase(parts[0]) != key)
            return refuse(key, "with a type expected, found " + inQuotes(trimmed(line)));
        const auto known = type(parts[1]);
        if (!known.isOk())
            return known.error();
        keep(trimmed(line));
        return keepValues(std::string(key), known.value(), count);
    }

    /// Numbers of the structure: checked, and kept if that is asked for.
    Status keepValues(const std::string& key, FileType type, std::uint64_t count) {
        ISO_TRY(checkRoom(key, type, count));
        if (out_.isBinary) {
            const std::uint64_t size = count * fileTypeSizeBytes(type);
            if (request_.keepsStructure) {
                ISO_TRY(checkFitsMemory(3 * (out_.structure.size() + size), request_.memoryBytes,
                                        scan_.path())); // VTK copies both
                const std::size_t begin = out_.structure.size();
                out_.structure.resize(begin + size);
                ISO_TRY(file_.readExactlyAt(scan_.position(),
                                            std::as_writable_bytes(std::span(out_.structure).subspan(begin))));
                out_.structure += '\n';
            }
            scan_.moveTo(scan_.position() + size);
            return {};
        }
        std::string word;
        for (std::uint64_t i = 0; i < count; ++i) {
            scan_.word(word);
            if (!isLegacySample(word, type))
                return makeError(ErrorCode::InvalidArgument,
                                 key + ": number " + std::to_string(i) + ", " + inQuotes(word) +
                                     ", is not a value of its type",
                                 scan_.path(), scan_.position());
            keep(word);
        }
        return {};
    }

    Status finishStructure() {
        if (out_.kind == VtkKind::Unstructured) {
            if (out_.points == 0 || cells_ < 1 || cells_ != cellTypes_)
                return refuse("CELLS", "points, cells and one type for each cell expected");
            out_.dims = {static_cast<std::int64_t>(out_.points), 1, 1};
            return {};
        }
        const auto dims = checkDims(sizes_, "DIMENSIONS", scan_.path());
        if (!dims.isOk())
            return dims.error();
        out_.dims = dims.value();
        const auto points = static_cast<std::uint64_t>(pointCount(dims.value()));
        if (out_.kind == VtkKind::Image)
            ISO_TRY(checkGeometry(place_, "SPACING, ORIGIN", scan_.path()));
        if (out_.kind == VtkKind::Rectilinear && axisPoints_ != out_.dims)
            return refuse("DIMENSIONS", "do not agree with the numbers of coordinates");
        if (out_.kind == VtkKind::Structured && out_.points != points)
            return refuse("POINTS", "DIMENSIONS give " + std::to_string(points) + " points");
        out_.points = points;
        return {};
    }

    Status checkPointCount(const Words& parts) {
        const auto count = parts.size() == 2 ? parseInteger(parts[1]) : std::nullopt;
        if (!count || *count < 0 || static_cast<std::uint64_t>(*count) != out_.points)
            return refuse("POINT_DATA", "DIMENSIONS give " + std::to_string(out_.points) + " points");
        tuples_ = out_.points;
        return {};
    }

    // Values of cells may come before those of points.
    Status stepOverCells(const Words& parts) {
        const auto count = parts.size() == 2 ? parseInteger(parts[1]) : std::nullopt;
        if (!count || *count < 0 || *count > kMaxCount)
            return refuse("CELL_DATA", "a number of cells expected");
        tuples_ = static_cast<std::uint64_t>(*count);
        std::string line;
        while (scan_.textLine(line)) {
            const auto next = words(line);
            if (lowerCase(next[0]) == "point_data")
                return checkPointCount(next);
            const auto array = readArray(next);
            if (!array.isOk() || (array.value() && !skip(*array.value()).isOk()))
                break; // whatever it is, no values of points have been met
        }
        return refuse("CELL_DATA", "values belong to cells; convert them to point data first");
    }

    // Attributes follow each other.
    Status readArrays() {
        std::string line;
        while (scan_.textLine(line)) {
            const auto parts = words(line);
            if (lowerCase(parts[0]) == "cell_data")
                break;
            auto array = readArray(parts);
            if (!array.isOk())
                return std::move(array).error();
            if (!array.value())
                continue;
            out_.arrays.push_back(*array.value());
            if (request_.isLast && request_.isLast(out_.arrays.back()))
                break;
            ISO_TRY(skip(out_.arrays.back()));
        }
        return {};
    }

    /// None if the line begins no array, but something to step over, which is done.
    Result<std::optional<LegacyArray>> readArray(const Words& parts) {
        const std::string key = lowerCase(parts[0]);
        if (key == "metadata") {
            ISO_TRY(stepOverMetadata());
            return std::optional<LegacyArray>();
        }
        if (fieldArrays_ == 0 && key == "field") {
            ISO_TRY(beginField(parts));
            return std::optional<LegacyArray>();
        }
        if (fieldArrays_ == 0 && key == "lookup_table") {
            ISO_TRY(stepOverTable(parts));
            return std::optional<LegacyArray>();
        }
        auto array = fieldArrays_ > 0 ? fieldArray(parts) : attribute(key, parts);
        if (!array.isOk())
            return std::move(array).error();
        fieldArrays_ -= fieldArrays_ > 0;
        array.value().position = scan_.position();
        return std::optional<LegacyArray>(std::move(array).value());
    }

    Status beginField(const Words& parts) {
        const auto arrays = parts.size() == 3 ? parseInteger(parts[2]) : std::nullopt;
        if (!arrays || *arrays < 0 || *arrays > kMaxFieldArrays)
            return refuse("FIELD", "a name and a number of arrays expected");
        fieldArrays_ = *arrays;
        return {};
    }

    Status stepOverMetadata() {
        std::string line;
        while (scan_.line(line) && !trimmed(line).empty()) {}
        return {};
    }

    // "LOOKUP_TABLE name n": n times four values, in binary files bytes.
    Status stepOverTable(const Words& parts) {
        const auto count = parts.size() == 3 ? parseInteger(parts[2]) : std::nullopt;
        if (!count || *count < 0 || *count > kMaxCount)
            return refuse("LOOKUP_TABLE", "a name and a number of colours expected");
        return skipValues("LOOKUP_TABLE", FileType::U8, 4 * static_cast<std::uint64_t>(*count));
    }

    // An array of the whole data set, "name components tuples type".
    Status stepOverFieldArray() {
        std::string line;
        if (!scan_.textLine(line))
            return refuse("FIELD", "the file ends early");
        auto parts = words(line);
        if (lowerCase(parts[0]) == "metadata") {
            ISO_TRY(stepOverMetadata());
            if (!scan_.textLine(line))
                return refuse("FIELD", "the file ends early");
            parts = words(line);
        }
        const auto tuples = parts.size() == 4 ? parseInteger(parts[2]) : std::nullopt;
        if (!tuples || *tuples < 0 || *tuples > kMaxCount)
            return refuse("FIELD", "an array with a number of values expected");
        const auto array = makeArray(parts[0], parts[3], parts[1]);
        if (!array.isOk())
            return array.error();
        return skipValues(array.value().name, array.value().type,
                          static_cast<std::uint64_t>(*tuples) * array.value().components);
    }

    Result<FileType> type(std::string_view name) const {
        for (const TypeName& known : kTypes)
            if (known.name == lowerCase(name))
                return known.type;
        return refuse("type", inQuotes(name) + " is not a known type of scalars");
    }

    Result<LegacyArray> makeArray(std::string_view name, std::string_view typeName, std::string_view components) const {
        const auto known = type(typeName);
        if (!known.isOk())
            return known.error();
        const auto count = parseInteger(components);
        if (!count || *count < 1 || *count > kMaxComponents)
            return refuse("components", inQuotes(components) + " is not a number of components");
        return LegacyArray{std::string(name), known.value(), static_cast<std::uint64_t>(*count), 0, false};
    }

    // "name components tuples type"
    Result<LegacyArray> fieldArray(const Words& parts) const {
        if (parts.size() != 4 || parseInteger(parts[2]) != static_cast<std::int64_t>(tuples_))
            return refuse("FIELD", "an array with one value per point expected");
        return makeArray(parts[0], parts[3], parts[1]);
    }

    Result<LegacyArray> attribute(std::string_view key, const Words& parts) {
        if (parts.size() < 2)
            return refuse("attribute", inQuotes(key) + " is not known here");
        if (key == "scalars" && parts.size() >= 3) {
            auto array = makeArray(parts[1], parts[2], parts.size() > 3 ? parts[3] : "1");
            if (array.isOk())
                array.value().isScalars = true;
            const std::uint64_t before = scan_.position();
            std::string line;
            if (!scan_.textLine(line) || !lowerCase(trimmed(line)).starts_with("lookup_table"))
                scan_.moveTo(before);
            return array;
        }
        if ((key == "vectors" || key == "normals") && parts.size() == 3)
            return makeArray(parts[1], parts[2], "3");
        if (key == "tensors" && parts.size() == 3)
            return makeArray(parts[1], parts[2], "9");
        if (key == "texture_coordinates" && parts.size() == 4)
            return makeArray(parts[1], parts[3], parts[2]);
        if ((key == "global_ids" || key == "pedigree_ids") && parts.size() == 3)
            return makeArray(parts[1], parts[2], "1");
        if (key == "color_scalars" && parts.size() == 3) // text files have fractions, which are no bytes
            return makeArray(parts[1], out_.isBinary ? "unsigned_char" : "float", parts[2]);
        return refuse("attribute", inQuotes(key) + " is not known here");
    }

    Status checkRoom(const std::string& name, FileType type, std::uint64_t values) const {
        const std::uint64_t least = out_.isBinary ? fileTypeSizeBytes(type) : 1;
        if (values > scan_.remaining() / least)
            return makeError(ErrorCode::Corruption,
                             "file ends early: " + inQuotes(name) + " needs " + std::to_string(values * least) +
                                 " bytes or more, " + std::to_string(scan_.remaining()) + " remain",
                             scan_.path(), scan_.position());
        return {};
    }

    Status skip(const LegacyArray& array) { return skipValues(array.name, array.type, tuples_ * array.components); }

    Status skipValues(const std::string& name, FileType type, std::uint64_t values) {
        ISO_TRY(checkRoom(name, type, values));
        if (out_.isBinary) {
            scan_.moveTo(scan_.position() + values * fileTypeSizeBytes(type));
            return {};
        }
        std::string ignored;
        for (std::uint64_t i = 0; i < values; ++i)
            if (!scan_.word(ignored))
                return refuse(name, "file ends early");
        return {};
    }

    const RandomAccessFile& file_;
    TextScanner scan_;
    const LegacyRequest& request_;
    LegacyFile out_;
    GridGeometry place_;
    std::vector<std::int64_t> sizes_;
    GridDims axisPoints_{0, 0, 0};
    std::int64_t cells_ = 0, cellTypes_ = 0;
    std::uint64_t tuples_ = 0; ///< per array, of points or of cells
    std::int64_t fieldArrays_ = 0; ///< of a field, still to come
    std::uint64_t sections_ = 0, headerBytes_ = 0;
};

} // namespace

Result<LegacyFile> readLegacyHeader(const RandomAccessFile& file, const LegacyRequest& request) {
    return LegacyWalk(file, request).run();
}

std::string_view legacyTypeName(FileType type) { return std::ranges::find(kTypes, type, &TypeName::type)->name; }

bool isLegacySample(std::string_view word, FileType type) {
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
        case FileType::F16: break; // no type of VTK
        case FileType::F32: return isWithin<double>(word, -kMaxFloat, kMaxFloat);
        case FileType::F64: return isWithin<double>(word);
    }
    return false;
}

} // namespace isoslider::io
