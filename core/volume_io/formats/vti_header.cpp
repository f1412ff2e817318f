#include "core/volume_io/formats/vti_header.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <optional>

#include <expat.h>

#include "core/volume_io/header_checks.h"

namespace isoslider::io {
namespace {

constexpr int kMaxDepth = 32;
constexpr int kMaxElements = 10000;

using Attributes = std::map<std::string, std::string, std::less<>>;

std::string_view valueOf(const Attributes& attributes, std::string_view key, std::string_view otherwise = {}) {
    const auto found = attributes.find(key);
    return found == attributes.end() ? otherwise : std::string_view(found->second);
}

/// Everything of interest in the XML, gathered by expat's callbacks.
struct Outline {
    Attributes file, image, pointData, appended;
    std::vector<Attributes> pieces, pointArrays, fieldArrays;
    int cellArrays = 0;
    std::vector<std::string> open; ///< names of the elements around the present place
    int elements = 0;
    std::optional<std::string> refusal;
    std::optional<std::uint64_t> appendedBegin; ///< where the bytes after <AppendedData ...> begin
    XML_Parser parser = nullptr;

    void stop(std::string why) {
        if (!refusal)
            refusal = std::move(why);
        XML_StopParser(parser, XML_FALSE);
    }
};

void XMLCALL onStart(void* data, const XML_Char* rawName, const XML_Char** rawAttributes) {
    auto& outline = *static_cast<Outline*>(data);
    const std::string name = rawName;
    Attributes attributes;
    for (; *rawAttributes != nullptr; rawAttributes += 2)
        attributes[rawAttributes[0]] = rawAttributes[1];
    const std::string parent = outline.open.empty() ? "" : outline.open.back();
    outline.open.push_back(name);
    if (outline.open.size() > kMaxDepth || ++outline.elements > kMaxElements)
        return outline.stop("more or deeper elements than any image file has");
    if (outline.open.size() == 1 && (name != "VTKFile" || valueOf(attributes, "type") != "ImageData"))
        return outline.stop("VTKFile: type ImageData expected");
    if (name == "VTKFile")
        outline.file = attributes;
    else if (name == "ImageData")
        outline.image = attributes;
    else if (name == "Piece")
        outline.pieces.push_back(attributes);
    else if (name == "PointData")
        outline.pointData = attributes;
    else if ((name == "DataArray" || name == "Array") && parent == "PointData")
        outline.pointArrays.push_back(attributes);
    else if ((name == "DataArray" || name == "Array") && parent == "FieldData")
        outline.fieldArrays.push_back(attributes);
    else if (name == "DataArray" && parent == "CellData")
        ++outline.cellArrays;
    else if (name == "AppendedData") {
        outline.appended = attributes;
        outline.appendedBegin = static_cast<std::uint64_t>(XML_GetCurrentByteIndex(outline.parser)) +
                                static_cast<std::uint64_t>(XML_GetCurrentByteCount(outline.parser));
        XML_StopParser(outline.parser, XML_FALSE); // what follows need not be XML
    }
}

void XMLCALL onEnd(void* data, const XML_Char*) {
    auto& outline = *static_cast<Outline*>(data);
    if (!outline.open.empty())
        outline.open.pop_back();
}

void XMLCALL onDoctype(void* data, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    static_cast<Outline*>(data)->stop("DOCTYPE: document types and entities are not accepted");
}

Status parseOutline(const RandomAccessFile& file, Outline& outline) {
    outline.parser = XML_ParserCreate(nullptr);
    if (outline.parser == nullptr)
        return makeError(ErrorCode::OutOfSpace, "no memory to read its XML", file.path());
    XML_SetUserData(outline.parser, &outline);
    XML_SetElementHandler(outline.parser, onStart, onEnd);
    XML_SetStartDoctypeDeclHandler(outline.parser, onDoctype);
    std::vector<std::byte> chunk(std::size_t{1} << 16);
    Status status;
    for (std::uint64_t at = 0; status.isOk() && !outline.refusal && !outline.appendedBegin;) {
        auto got = file.readAt(at, chunk);
        if (!got.isOk()) {
            status = std::move(got).error();
            break;
        }
        at += got.value();
        const bool isLast = at >= file.sizeBytes() || got.value() == 0;
        const auto outcome = XML_Parse(outline.parser, reinterpret_cast<const char*>(chunk.data()),
                                       static_cast<int>(got.value()), isLast);
        if (outcome == XML_STATUS_ERROR && !outline.refusal && !outline.appendedBegin)
            status = makeError(ErrorCode::InvalidArgument,
                               std::string("is not a well-formed VTK XML file: ") +
                                   XML_ErrorString(XML_GetErrorCode(outline.parser)),
                               file.path(), static_cast<std::uint64_t>(XML_GetCurrentByteIndex(outline.parser)));
        if (isLast)
            break;
    }
    XML_ParserFree(outline.parser);
    if (outline.refusal)
        return makeError(ErrorCode::InvalidArgument, *outline.refusal, file.path());
    return status;
}

struct TypeSize {
    std::string_view name;
    std::uint64_t sizeBytes;
};
constexpr TypeSize kTypes[] = {{"Int8", 1},  {"UInt8", 1},  {"Int16", 2}, {"UInt16", 2},  {"Int32", 4},
                               {"UInt32", 4}, {"Int64", 8}, {"UInt64", 8}, {"Float32", 4}, {"Float64", 8}};

Result<GridDims> readExtent(const Outline& outline, const std::filesystem::path& path) {
    std::vector<std::int64_t> extent;
    const std::string_view text = valueOf(outline.image, "WholeExtent");
    constexpr std::int64_t kBound = std::int64_t{1} << 30;
    if (!parseIntegers(text, extent) || extent.size() != 6 ||
        std::any_of(extent.begin(), extent.end(), [](auto e) { return e < -kBound || e > kBound; }))
        return refuseField("WholeExtent", "six whole numbers expected, found " + inQuotes(text), path);
    std::vector<std::int64_t> piece;
    if (outline.pieces.size() != 1 || !parseIntegers(valueOf(outline.pieces[0], "Extent"), piece) || piece != extent)
        return refuseField("Piece", "one with the whole extent expected", path);
    const std::int64_t sizes[] = {extent[1] - extent[0] + 1, extent[3] - extent[2] + 1, extent[5] - extent[4] + 1};
    return checkDims(sizes, "WholeExtent", path);
}

Result<const Attributes*> chooseArray(const Outline& outline, const std::string& field,
                                      const std::filesystem::path& path) {
    const auto& arrays = outline.pointArrays;
    if (arrays.empty() && outline.cellArrays > 0)
        return refuseField("PointData", "values belong to cells only; convert them to point data first", path);
    if (arrays.empty())
        return refuseField("PointData", "has no array", path);
    const auto named = [&](std::string_view name) {
        const auto found = std::find_if(arrays.begin(), arrays.end(),
                                        [&](const Attributes& a) { return valueOf(a, "Name") == name; });
        return found == arrays.end() ? nullptr : &*found;
    };
    const auto isScalar = [](const Attributes& a) { return valueOf(a, "NumberOfComponents", "1") == "1"; };
    const Attributes* chosen = named(field.empty() ? valueOf(outline.pointData, "Scalars") : std::string_view(field));
    if (chosen == nullptr && !field.empty())
        return refuseField("field", "the file has no point array named " + inQuotes(field), path);
    if (chosen == nullptr) {
        const auto first = std::find_if(arrays.begin(), arrays.end(), isScalar);
        chosen = first == arrays.end() ? &arrays[0] : &*first;
    }
    if (!isScalar(*chosen))
        return refuseField("NumberOfComponents", inQuotes(valueOf(*chosen, "Name")) + " has " +
                               std::string(valueOf(*chosen, "NumberOfComponents")) + "; only scalar volumes are read",
                           path);
    return chosen;
}

/// Checks that the file can hold what an array claims.
class RoomCheck {
public:
    RoomCheck(const RandomAccessFile& file, const Outline& outline, std::uint64_t expected)
        : file_(file), outline_(outline), expected_(expected) {
        isWide_ = valueOf(outline.file, "header_type", "UInt32") == "UInt64";
        isCompressed_ = !valueOf(outline.file, "compressor").empty();
        isBigEndian_ = valueOf(outline.file, "byte_order") == "BigEndian";
    }

    Status run(const Attributes& array, std::uint64_t points) const {
        const std::string_view format = valueOf(array, "format", "ascii");
        // Deflate packs at most 1032 to 1, LZ4 less; LZMA is given the benefit of the doubt.
        const std::uint64_t least = format == "ascii" ? points : isCompressed_ ? expected_ / 8000 : expected_;
        if (least > file_.sizeBytes())
            return makeError(ErrorCode::Corruption,
                             "data: the extent asks for " + std::to_string(expected_) + " bytes, the file has only " +
                                 std::to_string(file_.sizeBytes()),
                             file_.path());
        return format == "appended" ? checkAppended(array) : Status();
    }

private:
    Status checkAppended(const Attributes& array) const {
        const auto offset = parseInteger(valueOf(array, "offset"));
        auto begin = outline_.appendedBegin;
        if (!begin || !offset || *offset < 0)
            return refuseField("offset", "appended data has no usable place", file_.path());
        std::vector<std::byte> start(256); // blanks, then an underscore
        auto got = file_.readAt(*begin, start);
        if (!got.isOk())
            return std::move(got).error();
        const auto mark = std::find(start.begin(), start.begin() + static_cast<std::ptrdiff_t>(got.value()), std::byte{'_'});
        const std::uint64_t at = *begin + static_cast<std::uint64_t>(mark - start.begin()) + 1 +
                                 static_cast<std::uint64_t>(*offset);
        if (mark == start.begin() + static_cast<std::ptrdiff_t>(got.value()) || at >= file_.sizeBytes())
            return makeError(ErrorCode::Corruption, "offset: appended data lies beyond the end of the file",
                             file_.path(), at);
        return valueOf(outline_.appended, "encoding", "raw") == "raw" ? checkBlocks(at) : Status();
    }

    Result<std::uint64_t> headerNumber(std::uint64_t at) const {
        const std::size_t size = isWide_ ? 8 : 4;
        std::byte raw[8]{};
        ISO_TRY(file_.readExactlyAt(at, std::span(raw).first(size)));
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < size; ++i)
            value |= std::to_integer<std::uint64_t>(raw[i]) << 8 * (isBigEndian_ ? size - 1 - i : i);
        return value;
    }

    Error blockError(std::string problem, std::uint64_t at) const {
        return makeError(ErrorCode::Corruption, "data block: " + std::move(problem), file_.path(), at);
    }

    // Uncompressed: byte count, bytes. Compressed: number of blocks, their size, the last one's
    // size if it differs, the packed sizes, the blocks.
    Status checkBlocks(std::uint64_t at) const {
        const std::uint64_t width = isWide_ ? 8 : 4;
        const auto first = headerNumber(at);
        if (!first.isOk())
            return first.error();
        if (!isCompressed_) {
            if (first.value() != expected_ || expected_ > file_.sizeBytes() - at)
                return blockError(std::to_string(first.value()) + " bytes announced, " + std::to_string(expected_) +
                                      " expected, " + std::to_string(file_.sizeBytes() - at) + " left", at);
            return {};
        }
        const std::uint64_t blocks = first.value();
        const auto size = headerNumber(at + width), last = headerNumber(at + 2 * width);
        if (!size.isOk() || !last.isOk() || blocks == 0 || blocks > (file_.sizeBytes() - at) / width)
            return blockError(std::to_string(blocks) + " blocks cannot be in this file", at);
        const std::uint64_t whole = last.value() == 0 ? blocks : blocks - 1;
        if (size.value() > expected_ || last.value() > expected_ || whole * size.value() + last.value() != expected_)
            return blockError("the blocks do not unpack to the expected " + std::to_string(expected_) + " bytes", at);
        std::uint64_t end = at + (3 + blocks) * width;
        for (std::uint64_t i = 0; i < blocks; ++i) {
            const auto packed = headerNumber(at + (3 + i) * width);
            if (!packed.isOk())
                return packed.error();
            if (packed.value() > file_.sizeBytes() || (end += packed.value()) > file_.sizeBytes())
                return blockError("ends beyond the file", at);
        }
        return {};
    }

    const RandomAccessFile& file_;
    const Outline& outline_;
    std::uint64_t expected_;
    bool isWide_ = false;
    bool isCompressed_ = false;
    bool isBigEndian_ = false;
};

} // namespace

Result<VtiHeader> checkVtiHeader(const RandomAccessFile& file, const std::string& field) {
    Outline outline;
    ISO_TRY(parseOutline(file, outline));
    const auto dims = readExtent(outline, file.path());
    if (!dims.isOk())
        return dims.error();
    const auto array = chooseArray(outline, field, file.path());
    if (!array.isOk())
        return array.error();
    for (const Attributes& other : outline.fieldArrays) // VTK reads these whether wanted or not
        for (const char* key : {"NumberOfTuples", "NumberOfComponents"}) {
            const auto count = parseInteger(valueOf(other, key, "1"));
            if (!count || *count < 0 || *count > 65536)
                return refuseField(key, "of a field array is not usable", file.path());
        }
    VtiHeader header{dims.value(), std::string(valueOf(*array.value(), "Name")), false,
                     std::string(valueOf(*array.value(), "type"))};
    header.isFirstUnnamed = header.array.empty();
    const auto type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                   [&](const TypeSize& known) { return known.name == header.typeName; });
    if (type == std::end(kTypes))
        return refuseField("type", inQuotes(header.typeName) + " is not a known type of scalars", file.path());
    const auto points = static_cast<std::uint64_t>(pointCount(dims.value()));
    ISO_TRY(RoomCheck(file, outline, points * type->sizeBytes).run(*array.value(), points));
    return header;
}

} // namespace isoslider::io
