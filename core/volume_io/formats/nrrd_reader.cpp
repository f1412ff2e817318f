#include <cmath>
#include <map>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/header_checks.h"
#include "core/volume_io/formats/itk_header.h"
#include "core/volume_io/sample_source.h"

// As with MetaImage, extents, files and sizes are settled here before ITK sees the header.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxDataFiles = 65536;

struct Header {
    std::map<std::string, std::string, std::less<>> fields;
    std::vector<std::string> dataFiles; ///< after "data file: LIST"
    bool isDetached = false;
    std::uint64_t sizeBytes = 0; ///< where attached data begins

    std::string_view operator[](std::string_view key) const {
        const auto found = fields.find(key);
        return found == fields.end() ? std::string_view() : std::string_view(found->second);
    }
};

struct TypeName {
    std::string_view name;
    FileType type;
};
constexpr TypeName kTypes[] = {
    {"signed char", FileType::I8}, {"int8", FileType::I8}, {"int8_t", FileType::I8},
    {"uchar", FileType::U8}, {"unsigned char", FileType::U8}, {"uint8", FileType::U8}, {"uint8_t", FileType::U8},
    {"short", FileType::I16}, {"short int", FileType::I16}, {"signed short", FileType::I16},
    {"signed short int", FileType::I16}, {"int16", FileType::I16}, {"int16_t", FileType::I16},
    {"ushort", FileType::U16}, {"unsigned short", FileType::U16}, {"unsigned short int", FileType::U16},
    {"uint16", FileType::U16}, {"uint16_t", FileType::U16},
    {"int", FileType::I32}, {"signed int", FileType::I32}, {"int32", FileType::I32}, {"int32_t", FileType::I32},
    {"uint", FileType::U32}, {"unsigned int", FileType::U32}, {"uint32", FileType::U32}, {"uint32_t", FileType::U32},
    {"longlong", FileType::I64}, {"long long", FileType::I64}, {"long long int", FileType::I64},
    {"signed long long", FileType::I64}, {"signed long long int", FileType::I64},
    {"int64", FileType::I64}, {"int64_t", FileType::I64},
    {"ulonglong", FileType::U64}, {"unsigned long long", FileType::U64}, {"unsigned long long int", FileType::U64},
    {"uint64", FileType::U64}, {"uint64_t", FileType::U64},
    {"float", FileType::F32}, {"double", FileType::F64}};

// Spellings with and without the blank are the same field.
std::string fieldName(std::string_view text) {
    std::string name = lowerCase(trimmed(text));
    if (name == "datafile")
        return "data file";
    if (name == "lineskip")
        return "line skip";
    if (name == "byteskip")
        return "byte skip";
    return name;
}

Status addField(Header& header, std::string_view line, const fs::path& path) {
    const auto colon = line.find(':');
    if (colon == std::string_view::npos)
        return makeError(ErrorCode::InvalidArgument, "is not NRRD: a line 'field: value' was expected, found " +
                                                         inQuotes(line), path);
    if (line.substr(colon).starts_with(":=")) // a note of the writer's own
        return {};
    const std::string name = fieldName(line.substr(0, colon));
    if (!header.fields.emplace(name, trimmed(line.substr(colon + 1))).second)
        return refuseField(name, "is given twice", path);
    return {};
}

Result<Header> readHeader(const fs::path& path) {
    auto text = readStart(path);
    if (!text.isOk())
        return std::move(text).error();
    std::string_view rest = text.value();
    if (rest.starts_with("\xef\xbb\xbf")) // byte order mark of an editor
        rest.remove_prefix(3);
    Header header;
    header.isDetached = true; // until a blank line says otherwise
    bool isList = false;
    for (std::size_t number = 0; !rest.empty(); ++number) {
        const auto lineEnd = rest.find('\n');
        const std::string_view line = trimmed(rest.substr(0, lineEnd));
        if (rest.substr(0, lineEnd).size() > kMaxHeaderLine)
            return makeError(ErrorCode::InvalidArgument, "is not NRRD: line " + std::to_string(number + 1) +
                                                             " of its header is too long", path);
        rest.remove_prefix(lineEnd == std::string_view::npos ? rest.size() : lineEnd + 1);
        if (number == 0) {
            if (line.size() != 8 || !line.starts_with("NRRD000") || line[7] < '1' || line[7] > '5')
                return makeError(ErrorCode::InvalidArgument, "is not NRRD: NRRD0001 to NRRD0005 expected, found " +
                                                                 inQuotes(line.substr(0, 12)), path);
        } else if (isList) {
            if (!line.empty())
                header.dataFiles.emplace_back(line);
            if (header.dataFiles.size() > kMaxDataFiles)
                return refuseField("data file", "the list names more than 65536 files", path);
        } else if (line.empty()) {
            header.isDetached = false;
            header.sizeBytes = text.value().size() - rest.size();
            return header;
        } else if (!line.starts_with('#')) {
            ISO_TRY(addField(header, line, path));
            isList = header["data file"].starts_with("LIST");
        }
    }
    if (text.value().size() == kMaxHeaderBytes)
        return makeError(ErrorCode::InvalidArgument, "is not NRRD: no end of its header in the first MiB", path);
    return header;
}

Result<GridDims> readDims(const Header& header, const fs::path& path) {
    const auto dimension = parseInteger(header["dimension"]);
    if (!dimension || *dimension < 1 || *dimension > 16)
        return refuseField("dimension", inQuotes(header["dimension"]) + " is not a number from 1 to 16", path);
    std::vector<std::int64_t> sizes;
    if (!parseIntegers(header["sizes"], sizes) || sizes.size() != static_cast<std::size_t>(*dimension))
        return refuseField("sizes", std::to_string(*dimension) + " whole numbers expected, found " +
                                        inQuotes(header["sizes"]), path);
    if (header["space directions"].find("none") != std::string_view::npos)
        return refuseField("space directions", "an axis without direction holds components; only scalar volumes are read",
                           path);
    std::vector<double> spacings;
    if (!header["spacings"].empty() && !parseReals(header["spacings"], spacings))
        return refuseField("spacings", "numbers expected, found " + inQuotes(header["spacings"]), path);
    for (std::size_t axis = 0; axis < std::min<std::size_t>(spacings.size(), 3); ++axis)
        if (!std::isfinite(spacings[axis]) || !(spacings[axis] > 0.0)) // ITK would silently put 1
            return refuseField("spacings", inQuotes(header["spacings"]) + " are not positive numbers", path);
    return checkDims(sizes, "sizes", path);
}

Result<SampleLayout> sampleLayout(const Header& header, const fs::path& path) {
    for (const TypeName& known : kTypes) {
        if (known.name != lowerCase(header["type"]))
            continue;
        const std::string endian = lowerCase(header["endian"]);
        if (endian != "little" && endian != "big" && (!endian.empty() || fileTypeSizeBytes(known.type) > 1))
            return refuseField("endian", "little or big expected, found " + inQuotes(endian), path);
        return SampleLayout{known.type, endian == "big", std::nullopt};
    }
    return refuseField("type", inQuotes(header["type"]) + " is not a known type of scalars", path);
}

// "name%03d.raw MIN MAX STEP [SUBDIM]": the one conversion is written out here, never by printf.
Result<std::vector<std::string>> expandPattern(std::string_view value, const fs::path& path) {
    const auto parts = words(value);
    if (parts.size() != 4 && parts.size() != 5)
        return refuseField("data file", "a pattern takes first, last and step, found " + inQuotes(value), path);
    const std::string_view pattern = parts[0];
    const auto percent = pattern.find('%');
    const auto conversion = pattern.find('d', percent);
    const std::string_view width =
        percent == std::string_view::npos || conversion == std::string_view::npos
            ? std::string_view("bad")
            : pattern.substr(percent + 1, conversion - percent - 1);
    const auto digits = width.empty() ? std::optional<std::int64_t>(0) : parseInteger(width);
    const auto first = parseInteger(parts[1]), last = parseInteger(parts[2]), step = parseInteger(parts[3]);
    if (!digits || *digits < 0 || *digits > 20 || pattern.find('%', percent + 1) != std::string_view::npos)
        return refuseField("data file", inQuotes(pattern) + " is not a pattern with one %d", path);
    constexpr std::int64_t kBound = std::int64_t{1} << 40;
    if (!first || !last || !step || *step == 0 || std::abs(*first) > kBound || std::abs(*last) > kBound ||
        (*last - *first) / *step < 0 || (*last - *first) / *step >= static_cast<std::int64_t>(kMaxDataFiles))
        return refuseField("data file", "the range " + inQuotes(value.substr(pattern.size())) + " is not usable", path);
    std::vector<std::string> names;
    for (std::int64_t i = 0; i <= (*last - *first) / *step; ++i) {
        std::string number = std::to_string(*first + i * *step);
        if (!width.empty() && width[0] == '0' && number.size() < static_cast<std::size_t>(*digits))
            number.insert(0, static_cast<std::size_t>(*digits) - number.size(), '0');
        names.push_back(std::string(pattern.substr(0, percent)) + number + std::string(pattern.substr(conversion + 1)));
    }
    return names;
}

Result<std::vector<FilePart>> findParts(const Header& header, const fs::path& path) {
    const std::string_view value = header["data file"];
    if (value.empty() && header.isDetached)
        return refuseField("data file", "missing, and no samples follow the header", path);
    if (value.empty())
        return std::vector<FilePart>{{path, header.sizeBytes}};
    std::vector<std::string> names = header.dataFiles;
    if (!value.starts_with("LIST")) {
        names = {std::string(value)};
        if (value.find('%') != std::string_view::npos) {
            auto expanded = expandPattern(value, path);
            if (!expanded.isOk())
                return std::move(expanded).error();
            names = std::move(expanded).value();
        }
    }
    if (names.empty())
        return refuseField("data file", "the list is empty", path);
    std::vector<FilePart> parts;
    for (const std::string& name : names) {
        auto file = resolveDataFile(path, name, "data file");
        if (!file.isOk())
            return std::move(file).error();
        parts.push_back({std::move(file).value(), 0});
    }
    return parts;
}

Status skipLines(FilePart& part, std::int64_t lines, const fs::path& path) {
    if (lines == 0)
        return {};
    auto file = defaultFileSystem().openForReading(part.path);
    if (!file.isOk())
        return std::move(file).error();
    std::vector<std::byte> buffer(std::size_t{1} << 16);
    for (std::uint64_t at = part.offset;;) {
        auto got = file.value()->readAt(at, buffer);
        if (!got.isOk())
            return std::move(got).error();
        if (got.value() == 0)
            return refuseField("line skip", "the data file has fewer lines", path);
        for (std::size_t i = 0; i < got.value(); ++i)
            if (buffer[i] == std::byte{'\n'} && --lines == 0) {
                part.offset = at + i + 1;
                return {};
            }
        at += got.value();
    }
}

// Moves each part's offset behind what `line skip` and `byte skip` leave out; returns skipped bytes
// that are inside a compressed stream.
Result<std::uint64_t> applySkips(const Header& header, std::vector<FilePart>& parts, std::uint64_t partBytes,
                                 bool isCompressed, const fs::path& path) {
    const auto number = [&](std::string_view key) {
        return header[key].empty() ? std::optional<std::int64_t>(0) : parseInteger(header[key]);
    };
    const auto lines = number("line skip"), bytes = number("byte skip");
    if (!lines || *lines < 0)
        return refuseField("line skip", inQuotes(header["line skip"]) + " is not a number of lines", path);
    if (!bytes || *bytes < -1 || (*bytes == -1 && isCompressed))
        return refuseField("byte skip", inQuotes(header["byte skip"]) + " is not a number of bytes", path);
    for (FilePart& part : parts) {
        ISO_TRY(skipLines(part, *lines, path));
        auto file = defaultFileSystem().openForReading(part.path);
        if (!file.isOk())
            return std::move(file).error();
        const std::uint64_t size = file.value()->sizeBytes();
        if (*bytes == -1)
            part.offset = size >= partBytes ? size - partBytes : 0;
        else if (!isCompressed)
            part.offset += static_cast<std::uint64_t>(*bytes);
        if (part.offset > size)
            return refuseField("byte skip", "leads beyond the end of the data", path);
    }
    return isCompressed ? static_cast<std::uint64_t>(*bytes) : std::uint64_t{0};
}

Result<std::unique_ptr<ByteStream>> openBytes(const Header& header, std::uint64_t sampleBytes, const fs::path& path) {
    const std::string encoding = lowerCase(header["encoding"]);
    const bool isCompressed = encoding == "gzip" || encoding == "gz";
    if (!isCompressed && encoding != "raw")
        return refuseField("encoding", inQuotes(encoding) + " is not read; raw and gzip are", path);
    auto parts = findParts(header, path);
    if (!parts.isOk())
        return std::move(parts).error();
    const std::size_t count = parts.value().size();
    if (isCompressed && count > 1)
        return refuseField("encoding", "gzip with several data files is not read", path);
    if (sampleBytes % count != 0)
        return refuseField("data file", std::to_string(count) + " files do not divide the samples evenly", path);
    auto skip = applySkips(header, parts.value(), sampleBytes / count, isCompressed, path);
    if (!skip.isOk())
        return std::move(skip).error();
    if (isCompressed)
        return openDeflated(parts.value()[0].path, parts.value()[0].offset, skip.value(), sampleBytes);
    return openParts(std::move(parts).value(), sampleBytes / count);
}

// Only what bears on geometry, in the order ITK's parser needs, without the byte order marks,
// carriage returns and trailing blanks that it stumbles over.
std::string headerForItk(const Header& header) {
    std::string text = "NRRD0005\nencoding: raw\nendian: little\n";
    const auto add = [&](std::string_view key) {
        if (!header[key].empty())
            text += std::string(key) + ": " + std::string(header[key]) + "\n";
    };
    for (const char* key : {"type", "dimension", "space", "space dimension", "sizes", "space directions",
                            "space origin", "spacings", "axis mins", "axismins", "centers", "centerings", "kinds",
                            "thicknesses"})
        add(key);
    return text + "\n";
}

Result<GridGeometry> readGeometry(const Header& header, const GridDims& dims, VolumeInfo& info, const fs::path& path) {
    std::vector<double> spacings;
    parseReals(header["spacings"], spacings);
    const bool hasSpace = !header["space"].empty() || !header["space dimension"].empty();
    if (!hasSpace || spacings.size() < 3 || !header["space directions"].empty())
        return readItkGeometryOfText(headerForItk(header), ItkFormat::Nrrd, dims, path);
    // A space without directions, only scalar spacings: well-formed, but ITK refuses it.
    info.notes.push_back("names a space but no directions in it; the axes are taken as they are");
    GridGeometry geometry;
    geometry.dims = dims;
    geometry.spacing = {spacings[0], spacings[1], spacings[2]};
    return geometry;
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openNrrd(const fs::path& path, const ReadOptions& /*options*/) {
    const auto header = readHeader(path);
    if (!header.isOk())
        return header.error();
    const auto dims = readDims(header.value(), path);
    if (!dims.isOk())
        return dims.error();
    const auto layout = sampleLayout(header.value(), path);
    if (!layout.isOk())
        return layout.error();
    const std::uint64_t sampleBytes =
        static_cast<std::uint64_t>(pointCount(dims.value())) * fileTypeSizeBytes(layout.value().type);
    auto bytes = openBytes(header.value(), sampleBytes, path);
    if (!bytes.isOk())
        return std::move(bytes).error();
    VolumeInfo info;
    info.format = "NRRD";
    auto geometry = readGeometry(header.value(), dims.value(), info, path);
    if (!geometry.isOk())
        return std::move(geometry).error();
    ISO_TRY(checkGeometry(geometry.value(), "spacings or space directions", path));
    info.geometry = geometry.value();
    return makeSampleSource(std::move(info), layout.value(), std::move(bytes).value(), path);
}

} // namespace isoslider::io
