#include "core/volume_io/formats/vtk/vtk_xml_outline.h"

#include <memory>

#include <expat.h>

#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

constexpr std::size_t kMaxDepth = 32;
constexpr int kMaxElements = 10000;
constexpr std::string_view kKinds[] = {"ImageData", "RectilinearGrid", "StructuredGrid", "UnstructuredGrid"};

/// What expat's callbacks gather.
struct Gathering {
    VtkXmlOutline outline;
    std::vector<std::string> open; ///< names of the elements around the present place
    int elements = 0;
    std::optional<std::string> refusal;
    XML_Parser parser = nullptr;

    void stop(std::string why) {
        if (!refusal)
            refusal = std::move(why);
        XML_StopParser(parser, XML_FALSE);
    }
};

bool isKnownKind(std::string_view kind) {
    for (const std::string_view known : kKinds)
        if (kind == known)
            return true;
    return false;
}

/// Where what follows the tag at hand begins.
std::uint64_t afterTag(XML_Parser parser) {
    return static_cast<std::uint64_t>(XML_GetCurrentByteIndex(parser)) +
           static_cast<std::uint64_t>(XML_GetCurrentByteCount(parser));
}

void keepArray(Gathering& gathered, const std::string& parent, XmlArray attributes) {
    VtkXmlOutline& outline = gathered.outline;
    attributes.contentBegin = afterTag(gathered.parser);
    if (parent == "PointData")
        outline.pointArrays.push_back(std::move(attributes));
    else if (parent == "Points" || parent == "Coordinates")
        outline.placeArrays.push_back(std::move(attributes));
    else if (parent == "Cells")
        outline.cellsArrays.push_back(std::move(attributes));
    else if (parent == "FieldData")
        outline.fieldArrays.push_back(std::move(attributes));
    else if (parent == "CellData")
        ++outline.cellArrays;
}

void XMLCALL onStart(void* data, const XML_Char* rawName, const XML_Char** rawAttributes) {
    auto& gathered = *static_cast<Gathering*>(data);
    VtkXmlOutline& outline = gathered.outline;
    const std::string name = rawName;
    XmlAttributes attributes;
    for (; *rawAttributes != nullptr; rawAttributes += 2)
        attributes[rawAttributes[0]] = rawAttributes[1];
    const std::string parent = gathered.open.empty() ? "" : gathered.open.back();
    gathered.open.push_back(name);
    if (gathered.open.size() > kMaxDepth || ++gathered.elements > kMaxElements)
        return gathered.stop("more or deeper elements than any image file has");
    if (gathered.open.size() == 1 && (name != "VTKFile" || !isKnownKind(xmlValue(attributes, "type"))))
        return gathered.stop("VTKFile: type ImageData, RectilinearGrid, StructuredGrid or UnstructuredGrid expected, "
                             "found " +
                             inQuotes(xmlValue(attributes, "type")));
    if (name == "VTKFile") {
        outline.file = attributes;
    } else if (parent == "VTKFile" && isKnownKind(name)) {
        outline.grid = attributes;
    } else if (name == "Piece") {
        outline.pieces.push_back(attributes);
    } else if (name == "PointData") {
        outline.pointData = attributes;
    } else if (name == "DataArray" || name == "Array") {
        keepArray(gathered, parent, {std::move(attributes)});
    } else if (name == "AppendedData") {
        outline.appended = attributes;
        outline.appendedBegin = afterTag(gathered.parser);
        XML_StopParser(gathered.parser, XML_FALSE); // what follows need not be XML
    }
}

void XMLCALL onEnd(void* data, const XML_Char*) {
    auto& gathered = *static_cast<Gathering*>(data);
    if (!gathered.open.empty())
        gathered.open.pop_back();
}

void XMLCALL onDoctype(void* data, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    static_cast<Gathering*>(data)->stop("DOCTYPE: document types and entities are not accepted");
}

} // namespace

std::string_view xmlValue(const XmlAttributes& attributes, std::string_view key, std::string_view otherwise) {
    const auto found = attributes.find(key);
    return found == attributes.end() ? otherwise : std::string_view(found->second);
}

Result<VtkXmlOutline> readVtkXmlOutline(const RandomAccessFile& file) {
    const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                              XML_ParserFree);
    if (parser == nullptr)
        return makeError(ErrorCode::OutOfSpace, "no memory to read its XML", file.path());
    Gathering gathered;
    gathered.parser = parser.get();
    XML_SetUserData(parser.get(), &gathered);
    XML_SetElementHandler(parser.get(), onStart, onEnd);
    XML_SetStartDoctypeDeclHandler(parser.get(), onDoctype);
    std::vector<std::byte> chunk(std::size_t{1} << 16);
    for (std::uint64_t at = 0; !gathered.refusal && !gathered.outline.appendedBegin;) {
        const auto got = file.readAt(at, chunk);
        if (!got.isOk())
            return got.error();
        at += got.value();
        const bool isLast = at >= file.sizeBytes() || got.value() == 0;
        const auto outcome =
            XML_Parse(parser.get(), reinterpret_cast<const char*>(chunk.data()), static_cast<int>(got.value()), isLast);
        if (outcome == XML_STATUS_ERROR && !gathered.refusal && !gathered.outline.appendedBegin)
            return makeError(ErrorCode::InvalidArgument,
                             std::string("is not a well-formed VTK XML file: ") +
                                 XML_ErrorString(XML_GetErrorCode(parser.get())),
                             file.path(), static_cast<std::uint64_t>(XML_GetCurrentByteIndex(parser.get())));
        if (isLast)
            break;
    }
    if (gathered.refusal)
        return makeError(ErrorCode::InvalidArgument, *gathered.refusal, file.path());
    return std::move(gathered.outline);
}

} // namespace isoslider::io
