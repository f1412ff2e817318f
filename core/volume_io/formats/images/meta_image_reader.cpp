#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "core/grid/length_unit.h"
#include "core/volume_io/formats/data_files.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/sources/sample_source.h"
#include "core/volume_io/volume_choice.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kMaxChannels = 10'000;

using Fields = std::map<std::string, std::string, std::less<>>;

struct Header {
    Fields fields;
    std::uint64_t sizeBytes = 0; ///< where local data begins
    std::vector<std::string> list; ///< lines behind "ElementDataFile = LIST"
    std::vector<std::int64_t> sizes;
};

struct TypeName {
    std::string_view name;
    FileType type;
};
constexpr TypeName kTypes[] = {{"MET_UCHAR", FileType::U8},       {"MET_CHAR", FileType::I8},
                               {"MET_USHORT", FileType::U16},     {"MET_SHORT", FileType::I16},
                               {"MET_UINT", FileType::U32},       {"MET_INT", FileType::I32},
                               {"MET_ULONG_LONG", FileType::U64}, {"MET_LONG_LONG", FileType::I64},
                               {"MET_FLOAT", FileType::F32},      {"MET_DOUBLE", FileType::F64}};

// Lists of which MetaIO wants NDims (or NDims squared) numbers.
constexpr std::string_view kPerAxis[] = {"DimSize", "ElementSpacing", "ElementSize",     "Offset",
                                         "Origin",  "Position",       "CenterOfRotation"};
constexpr std::string_view kPerAxisPair[] = {"TransformMatrix", "Rotation", "Orientation"};

bool isList(std::string_view dataFile) { return dataFile.starts_with("LIST"); }

Status readList(std::string_view text, bool isCut, Header& header, const fs::path& path) {
    while (!text.empty()) {
        const auto lineEnd = text.find('\n');
        const std::string_view name = trimmed(text.substr(0, lineEnd));
        text.remove_prefix(lineEnd == std::string_view::npos ? text.size() : lineEnd + 1);
        if (!name.empty())
            header.list.emplace_back(name);
        if (name.size() > kMaxHeaderLine || header.list.size() > kMaxDataFiles)
            return refuseField("ElementDataFile", "the list names more than 65536 files, or one too long", path);
    }
    if (isCut)
        return refuseField("ElementDataFile", "the list does not end within the first MiB of the header", path);
    return {};
}

Result<Header> readHeader(const fs::path& path) {
    auto text = readStart(path);
    if (!text.isOk())
        return std::move(text).error();
    Header header;
    std::string_view rest = text.value();
    while (!rest.empty()) {
        const auto lineEnd = rest.find('\n');
        const std::string_view line = rest.substr(0, lineEnd);
        const auto separator = line.find_first_of("=:");
        if (line.size() > kMaxHeaderLine || line.find('\0') != std::string_view::npos)
            return makeError(ErrorCode::InvalidArgument, "is not a MetaImage: its header is not text", path);
        rest.remove_prefix(lineEnd == std::string_view::npos ? rest.size() : lineEnd + 1);
        if (trimmed(line).empty())
            continue;
        if (separator == std::string_view::npos)
            return makeError(ErrorCode::InvalidArgument,
                             "is not a MetaImage: a line 'name = value' was expected, found " + inQuotes(trimmed(line)),
                             path);
        const std::string key(trimmed(line.substr(0, separator)));
        if (!header.fields.emplace(key, trimmed(line.substr(separator + 1))).second)
            return refuseField(key, "is given twice", path);
        if (key == "ElementDataFile") {
            header.sizeBytes = text.value().size() - rest.size();
            if (isList(header.fields[key]))
                ISO_TRY(readList(rest, text.value().size() == kMaxHeaderBytes, header, path));
            return header;
        }
    }
    return refuseField("ElementDataFile", "missing from the first MiB of the header", path);
}

std::string_view valueOr(const Fields& fields, std::string_view key, std::string_view otherwise) {
    const auto found = fields.find(key);
    return found == fields.end() ? otherwise : std::string_view(found->second);
}

bool isTrue(const Fields& fields, std::string_view key) {
    const std::string_view value = valueOr(fields, key, "False");
    return value.starts_with('T') || value.starts_with('t') || value == "1";
}

Status checkNumbers(Header& header, const fs::path& path) {
    const Fields& fields = header.fields;
    const auto axes = parseInteger(valueOr(fields, "NDims", ""));
    if (!axes || *axes < 1 || *axes > 9)
        return refuseField("NDims", inQuotes(valueOr(fields, "NDims", "")) + " is not a number of dimensions", path);
    const auto hasCount = [&](std::string_view key, std::size_t count) {
        std::vector<double> numbers;
        return !fields.contains(key) ||
               (parseReals(fields.find(key)->second, numbers) && numbers.size() == count &&
                std::all_of(numbers.begin(), numbers.end(), [](double number) { return std::isfinite(number); }));
    };
    const auto count = static_cast<std::size_t>(*axes);
    for (const std::string_view key : kPerAxis)
        if (!hasCount(key, count))
            return refuseField(key, std::to_string(count) + " finite numbers expected", path);
    for (const std::string_view key : kPerAxisPair)
        if (!hasCount(key, count * count))
            return refuseField(key, std::to_string(count * count) + " finite numbers expected", path);
    if (!parseIntegers(valueOr(fields, "DimSize", ""), header.sizes) || header.sizes.empty())
        return refuseField("DimSize", "whole numbers expected", path);
    return checkExtents(header.sizes, "DimSize", path);
}

/// Everything known before a choice is made.
struct Image {
    Header header;
    FileType type = FileType::U8;
    VolumeField field;
    std::vector<FilePart> parts;
    std::uint64_t partBytes = 0;
    Encoded how;
    bool isLonger = false; ///< a file, than its samples
};

Status readSamples(Image& image, const fs::path& path) {
    const Fields& fields = image.header.fields;
    const std::string_view name = valueOr(fields, "ElementType", "");
    const auto known =
        std::find_if(std::begin(kTypes), std::end(kTypes), [&](const TypeName& type) { return type.name == name; });
    if (known == std::end(kTypes))
        return refuseField("ElementType", inQuotes(name) + " is not a known type of scalars", path);
    image.type = known->type;
    const std::string_view channels = valueOr(fields, "ElementNumberOfChannels", "1");
    const auto components = parseInteger(channels);
    if (!components || *components < 1 || *components > kMaxChannels)
        return refuseField("ElementNumberOfChannels", inQuotes(channels) + " is not a number from 1 to 10000", path);
    const auto& sizes = image.header.sizes;
    for (std::size_t axis = 0; axis < sizes.size(); ++axis)
        (axis < 3 ? image.field.dims[axis] : image.field.frames) *= sizes[axis];
    if (pointCount(image.field.dims) * image.field.frames > kMaxPoints / *components)
        return refuseField("ElementNumberOfChannels", "more than 2^40 values in all", path);
    image.field.components = static_cast<int>(*components);
    image.field.typeName = fileTypeName(image.type);
    const bool isText = fields.contains("BinaryData") && !isTrue(fields, "BinaryData");
    const bool isPacked = isTrue(fields, "CompressedData");
    if (isText && isPacked)
        return refuseField("BinaryData", "samples written as text are not compressed", path);
    image.how = {isText ? Encoding::Text : isPacked ? Encoding::Deflate : Encoding::Plain, image.type, 0, false};
    return {};
}

/// Files named in the header, each of the same number of samples; none: they follow the header.
Result<std::vector<std::string>> nameFiles(const Header& header, const fs::path& path) {
    const std::string_view value = valueOr(header.fields, "ElementDataFile", "");
    if (value == "LOCAL" || value == "Local" || value == "local")
        return std::vector<std::string>();
    const bool isPattern = value.find('%') != std::string_view::npos;
    if (value.empty())
        return refuseField("ElementDataFile", "names no file", path);
    if (!isList(value) && !isPattern)
        return std::vector<std::string>{std::string(value)};
    std::size_t fileDims = header.sizes.size() - 1; // of one slice
    if (isList(value) && value != "LIST") {
        const auto parts = words(value);
        std::string_view number = parts.size() == 2 && parts[0] == "LIST" ? parts[1] : "";
        if (number.ends_with('D'))
            number.remove_suffix(1);
        const auto dims = parseInteger(number);
        if (!dims || *dims < 1 || *dims >= static_cast<std::int64_t>(header.sizes.size()))
            return refuseField("ElementDataFile",
                               inQuotes(value) + "; LIST takes the dimensions of a file, fewer than NDims", path);
        fileDims = static_cast<std::size_t>(*dims);
    }
    std::int64_t expected = 1;
    for (std::size_t axis = fileDims; axis < header.sizes.size(); ++axis)
        expected *= header.sizes[axis];
    auto names = isList(value) ? header.list : expandPattern(value, "ElementDataFile", path);
    if (names.isOk() && static_cast<std::int64_t>(names.value().size()) != expected)
        return refuseField("ElementDataFile",
                           std::to_string(expected) + " files expected, found " + std::to_string(names.value().size()),
                           path);
    return names;
}

Status checkCompressedSize(const Fields& fields, std::uint64_t available, const fs::path& path) {
    const std::string_view text = valueOr(fields, "CompressedDataSize", "0");
    const auto size = parseInteger(text); // absent or 0: up to the end of the file
    if (!size || *size < 0)
        return refuseField("CompressedDataSize", inQuotes(text) + " is not a size", path);
    if (static_cast<std::uint64_t>(*size) > available)
        return makeError(ErrorCode::Corruption,
                         "CompressedDataSize: " + std::string(text) + ", but the file has only " +
                             std::to_string(available) + " bytes of data",
                         path);
    return {};
}

// HeaderSize: bytes to leave out of each file, or -1 where the samples end it.
Status placeSamples(Image& image, const fs::path& path) {
    const Fields& fields = image.header.fields;
    const auto skipped = parseInteger(valueOr(fields, "HeaderSize", "0"));
    if (!skipped || *skipped < -1)
        return refuseField("HeaderSize", inQuotes(valueOr(fields, "HeaderSize", "")) + " is neither a size nor -1",
                           path);
    if (*skipped == -1 && image.how.encoding != Encoding::Plain)
        return refuseField("HeaderSize", "-1 has no meaning for compressed data or text", path);
    for (FilePart& part : image.parts) {
        const auto file = defaultFileSystem().openForReading(part.path);
        if (!file.isOk())
            return file.error();
        const std::uint64_t size = file.value()->sizeBytes();
        if (*skipped == -1)
            part.offset = size >= image.partBytes ? size - image.partBytes : 0;
        else if (*skipped > 0)
            part.offset = static_cast<std::uint64_t>(*skipped);
        const std::uint64_t available = size > part.offset ? size - part.offset : 0;
        image.isLonger |= image.how.encoding == Encoding::Plain && available > image.partBytes;
        if (image.how.encoding == Encoding::Deflate && image.parts.size() == 1)
            ISO_TRY(checkCompressedSize(fields, available, path));
    }
    return {};
}

Result<Image> describe(const fs::path& path, const ReadOptions& options) {
    auto header = readHeader(path);
    if (!header.isOk())
        return std::move(header).error();
    Image image;
    image.header = std::move(header).value();
    image.field.dims = {1, 1, 1};
    ISO_TRY(checkNumbers(image.header, path));
    ISO_TRY(readSamples(image, path));
    image.how.allowsTrailing = options.allowsTrailing;
    image.how.probeBytes = planeBytes(image.field, image.type);
    const auto names = nameFiles(image.header, path);
    if (!names.isOk())
        return names.error();
    image.parts = {{path, image.header.sizeBytes}};
    if (!names.value().empty()) {
        auto parts = locateDataFiles(names.value(), "ElementDataFile", path, options.allowsExternalData);
        if (!parts.isOk())
            return std::move(parts).error();
        image.parts = std::move(parts).value();
    }
    const auto values = pointCount(image.field.dims) * image.field.frames * image.field.components;
    image.partBytes = static_cast<std::uint64_t>(values) / image.parts.size() * fileTypeSizeBytes(image.type);
    ISO_TRY(placeSamples(image, path));
    return image;
}

/// The numbers of the first of `keys` that the header has; none has any: empty.
std::vector<double> numbersOf(const Fields& fields, std::initializer_list<std::string_view> keys) {
    std::vector<double> numbers;
    for (const std::string_view key : keys)
        if (const auto found = fields.find(key); found != fields.end() && parseReals(found->second, numbers))
            break;
    return numbers;
}

// Axes beyond the third are frames: their numbers count for nothing. Each row of a matrix is the direction of an axis,
// as MetaIO has it.
GridGeometry placeImage(const Header& header, const GridDims& dims) {
    const std::size_t axes = header.sizes.size();
    const int kept = static_cast<int>(std::min<std::size_t>(axes, 3));
    const auto spacing = numbersOf(header.fields, {"ElementSpacing", "ElementSize"});
    const auto origin = numbersOf(header.fields, {"Offset", "Origin", "Position"});
    const auto matrix = numbersOf(header.fields, {"TransformMatrix", "Rotation", "Orientation"});
    GridGeometry geometry;
    geometry.dims = dims;
    for (int axis = 0; axis < kept; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        if (!spacing.empty())
            geometry.spacing[axis] = spacing[at];
        if (!origin.empty())
            geometry.origin[axis] = origin[at];
        for (int row = 0; row < kept && !matrix.empty(); ++row)
            geometry.direction[axis][row] = matrix[at * axes + static_cast<std::size_t>(row)];
    }
    if (kept < 3)
        completeAxes(geometry.direction, kept);
    return geometry;
}

/// MetaIO's world leads towards left, posterior and superior. AnatomicalOrientation names where each axis comes from,
/// as in RAI; "???" is written where nobody knew. Without a matrix the axes are taken as they are, which is RAI.
/// ITK writes RAI with every image that nobody has placed, be it of a molecule: such a one is no patient.
bool isPatientSpace(const Fields& fields, const GridGeometry& geometry) {
    const std::string_view code = valueOr(fields, "AnatomicalOrientation", "");
    constexpr std::string_view kDirections[] = {"RL", "AP", "IS"};
    const auto isOneOf = [code](std::string_view direction) {
        return std::ranges::count_if(code, [&](char letter) { return direction.find(letter) != direction.npos; }) == 1;
    };
    const bool hasMatrix =
        fields.contains("TransformMatrix") || fields.contains("Rotation") || fields.contains("Orientation");
    const GridGeometry unplaced;
    if (geometry.origin == unplaced.origin && geometry.direction == unplaced.direction)
        return false;
    return code.size() == 3 && std::ranges::all_of(kDirections, isOneOf) && (hasMatrix || code == "RAI");
}

/// What makes intensities of the stored values. ITK leaves them as they are stored, so that is noted.
std::optional<Rescale> readMetaRescale(const Fields& fields, VolumeInfo& info) {
    const std::string_view slopeText = valueOr(fields, "ElementToIntensityFunctionSlope", "1");
    const std::string_view offsetText = valueOr(fields, "ElementToIntensityFunctionOffset", "0");
    const auto slope = parseReal(slopeText), offset = parseReal(offsetText);
    if (!slope || !offset || !std::isfinite(*slope) || !std::isfinite(*offset) || *slope == 0.0) {
        info.notes.push_back("ElementToIntensityFunctionSlope or Offset is not usable as a number and is ignored");
        return std::nullopt;
    }
    if (*slope == 1.0 && *offset == 0.0)
        return std::nullopt;
    info.notes.push_back("samples are the stored values times " + std::string(slopeText) + " plus " +
                         std::string(offsetText) + ", as ElementToIntensityFunctionSlope and Offset state");
    return Rescale{*slope, *offset};
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openMetaImage(const fs::path& path, const ReadOptions& options) {
    const auto described = describe(path, options);
    if (!described.isOk())
        return described.error();
    const Image& image = described.value();
    auto bytes = openEncoded(image.parts, image.partBytes, image.how);
    if (!bytes.isOk())
        return std::move(bytes).error();
    const auto choice = chooseInOnlyField(image.field, options, path);
    if (!choice.isOk())
        return choice.error();
    const GridGeometry geometry = placeImage(image.header, image.field.dims);
    ISO_TRY(checkGeometry(geometry, "ElementSpacing, Offset, TransformMatrix", path));
    VolumeInfo info;
    info.format = "MetaImage";
    info.dataFiles = filesBeside(path, image.parts);
    info.geometry = geometry;
    info.lengthUnit = knownLengthUnit(valueOr(image.header.fields, "DistanceUnits", ""));
    info.isPatientSpace = isPatientSpace(image.header.fields, geometry);
    if (image.isLonger)
        info.notes.push_back("the data file is longer than the samples; the rest is ignored");
    const Fields& fields = image.header.fields;
    const bool isBig = image.how.encoding == Encoding::Text
                           ? std::endian::native == std::endian::big
                           : isTrue(fields, "BinaryDataByteOrderMSB") || isTrue(fields, "ElementByteOrderMSB");
    SampleLayout layout{
        image.type, isBig, readMetaRescale(fields, info), image.field.components, choice.value().component, 0};
    layout.firstValue =
        static_cast<std::uint64_t>(choice.value().frame * pointCount(image.field.dims) * image.field.components);
    return makeSampleSource(std::move(info), layout, std::move(bytes).value(), path);
}

Result<VolumeContents> listMetaImage(const fs::path& path, const ReadOptions& options) {
    auto image = describe(path, options);
    if (!image.isOk())
        return std::move(image).error();
    const auto bytes = openEncoded(image.value().parts, image.value().partBytes, image.value().how);
    if (!bytes.isOk())
        return bytes.error();
    VolumeContents contents;
    contents.format = "MetaImage";
    contents.fields.push_back(std::move(image.value().field));
    return contents;
}

} // namespace isoslider::io
