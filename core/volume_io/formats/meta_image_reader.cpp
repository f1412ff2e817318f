#include <algorithm>
#include <cmath>
#include <map>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/header_checks.h"
#include "core/volume_io/formats/itk_header.h"
#include "core/volume_io/sample_source.h"

// The header is read here first, strictly: MetaIO copies lists of any length into arrays of ten.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

using Fields = std::map<std::string, std::string, std::less<>>;

struct Header {
    Fields fields;
    std::uint64_t sizeBytes = 0; ///< where local data begins
};

struct TypeName {
    std::string_view name;
    FileType type;
};
constexpr TypeName kTypes[] = {
    {"MET_UCHAR", FileType::U8},      {"MET_CHAR", FileType::I8},        {"MET_USHORT", FileType::U16},
    {"MET_SHORT", FileType::I16},     {"MET_UINT", FileType::U32},       {"MET_INT", FileType::I32},
    {"MET_ULONG_LONG", FileType::U64}, {"MET_LONG_LONG", FileType::I64}, {"MET_FLOAT", FileType::F32},
    {"MET_DOUBLE", FileType::F64}};

// Lists of which MetaIO wants NDims (or NDims squared) numbers.
constexpr std::string_view kPerAxis[] = {"DimSize", "ElementSpacing", "ElementSize", "Offset", "Origin", "Position",
                                         "CenterOfRotation"};
constexpr std::string_view kPerAxisPair[] = {"TransformMatrix", "Rotation", "Orientation"};

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

Result<GridDims> checkNumbers(const Fields& fields, const fs::path& path) {
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
    std::vector<std::int64_t> sizes;
    if (!parseIntegers(valueOr(fields, "DimSize", ""), sizes) || sizes.empty())
        return refuseField("DimSize", "whole numbers expected", path);
    return checkDims(sizes, "DimSize", path);
}

Result<SampleLayout> sampleLayout(const Fields& fields, const fs::path& path) {
    const std::string_view channels = valueOr(fields, "ElementNumberOfChannels", "1");
    if (parseInteger(channels) != 1)
        return refuseField("ElementNumberOfChannels", inQuotes(channels) + "; only scalar volumes are read", path);
    if (!isTrue(fields, "BinaryData") && fields.contains("BinaryData"))
        return refuseField("BinaryData", "samples written as text are not read", path);
    const std::string_view name = valueOr(fields, "ElementType", "");
    for (const TypeName& known : kTypes)
        if (known.name == name)
            return SampleLayout{known.type, isTrue(fields, "BinaryDataByteOrderMSB") || isTrue(fields, "ElementByteOrderMSB"),
                                std::nullopt};
    return refuseField("ElementType", inQuotes(name) + " is not a known type of scalars", path);
}

struct DataPlace {
    fs::path path;
    std::uint64_t offset = 0;
    std::uint64_t sizeBytes = 0; ///< of the file
};

Result<DataPlace> findData(const Header& header, std::uint64_t sampleBytes, bool isCompressed, const fs::path& path) {
    const std::string_view name = valueOr(header.fields, "ElementDataFile", "");
    DataPlace place{path, header.sizeBytes, 0};
    if (name != "LOCAL" && name != "Local" && name != "local") {
        if (name.empty() || name.starts_with("LIST") || name.find('%') != std::string_view::npos || words(name).size() > 1)
            return refuseField("ElementDataFile", inQuotes(name) + "; one data file or LOCAL expected", path);
        auto file = resolveDataFile(path, name, "ElementDataFile");
        if (!file.isOk())
            return std::move(file).error();
        place = {std::move(file).value(), 0, 0};
    }
    auto file = defaultFileSystem().openForReading(place.path);
    if (!file.isOk())
        return std::move(file).error();
    place.sizeBytes = file.value()->sizeBytes();
    const auto skipped = parseInteger(valueOr(header.fields, "HeaderSize", "0"));
    if (!skipped || *skipped < -1)
        return refuseField("HeaderSize", inQuotes(valueOr(header.fields, "HeaderSize", "")) +
                                             " is neither a size nor -1", path);
    if (*skipped == -1 && isCompressed)
        return refuseField("HeaderSize", "-1 has no meaning for compressed data", path);
    if (*skipped == -1) // the samples end the file
        place.offset = place.sizeBytes >= sampleBytes ? place.sizeBytes - sampleBytes : 0;
    else if (*skipped > 0)
        place.offset = static_cast<std::uint64_t>(*skipped);
    return place;
}

Status checkCompressedSize(const Fields& fields, const DataPlace& place, const fs::path& path) {
    const std::string_view text = valueOr(fields, "CompressedDataSize", "0");
    const auto size = parseInteger(text); // absent or 0: up to the end of the file
    const std::uint64_t available = place.sizeBytes > place.offset ? place.sizeBytes - place.offset : 0;
    if (!size || *size < 0)
        return refuseField("CompressedDataSize", inQuotes(text) + " is not a size", path);
    if (static_cast<std::uint64_t>(*size) > available)
        return makeError(ErrorCode::Corruption, "CompressedDataSize: " + std::string(text) + ", but the file has only " +
                                                    std::to_string(available) + " bytes of data", path);
    return {};
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openMetaImage(const fs::path& path, const ReadOptions& /*options*/) {
    const auto header = readHeader(path);
    if (!header.isOk())
        return header.error();
    const Fields& fields = header.value().fields;
    const auto dims = checkNumbers(fields, path);
    if (!dims.isOk())
        return dims.error();
    const auto layout = sampleLayout(fields, path);
    if (!layout.isOk())
        return layout.error();
    const std::uint64_t sampleBytes =
        static_cast<std::uint64_t>(pointCount(dims.value())) * fileTypeSizeBytes(layout.value().type);
    const bool isCompressed = isTrue(fields, "CompressedData");
    const auto place = findData(header.value(), sampleBytes, isCompressed, path);
    if (!place.isOk())
        return place.error();
    if (isCompressed)
        ISO_TRY(checkCompressedSize(fields, place.value(), path));
    auto bytes = isCompressed ? openDeflated(place.value().path, place.value().offset, 0, sampleBytes)
                              : openParts({{place.value().path, place.value().offset}}, sampleBytes);
    if (!bytes.isOk())
        return std::move(bytes).error();

    auto geometry = readItkGeometry(path, ItkFormat::MetaImage, dims.value());
    if (!geometry.isOk())
        return std::move(geometry).error();
    ISO_TRY(checkGeometry(geometry.value(), "ElementSpacing, Offset, TransformMatrix", path));
    VolumeInfo info;
    info.format = "MetaImage";
    info.geometry = geometry.value();
    if (!isCompressed && place.value().sizeBytes > place.value().offset + sampleBytes)
        info.notes.push_back("the data file is longer than the samples; the rest is ignored");
    return makeSampleSource(std::move(info), layout.value(), std::move(bytes).value(), path);
}

} // namespace isoslider::io
