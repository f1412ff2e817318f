#include "core/volume_io/formats/vtk_xml_header.h"

#include <algorithm>

#include "core/volume_io/header_checks.h"

namespace isoslider::io {
namespace {

constexpr std::int64_t kMaxComponents = 1000;

struct TypeSize {
    std::string_view name;
    std::uint64_t sizeBytes;
    const char* listed; ///< as VolumeField says it
};
constexpr TypeSize kTypes[] = {{"Int8", 1, "int8"},     {"UInt8", 1, "uint8"},   {"Int16", 2, "int16"},
                               {"UInt16", 2, "uint16"}, {"Int32", 4, "int32"},   {"UInt32", 4, "uint32"},
                               {"Int64", 8, "int64"},   {"UInt64", 8, "uint64"}, {"Float32", 4, "float32"},
                               {"Float64", 8, "float64"}};

const TypeSize* typeOf(const XmlAttributes& array) {
    const auto* found = std::find_if(std::begin(kTypes), std::end(kTypes), [&](const TypeSize& known) {
        return known.name == xmlValue(array, "type");
    });
    return found == std::end(kTypes) ? nullptr : found;
}

/// 0 if it is none.
std::int64_t componentsOf(const XmlAttributes& array) {
    const auto count = parseInteger(xmlValue(array, "NumberOfComponents", "1"));
    return count && *count >= 1 && *count <= kMaxComponents ? *count : 0;
}

Result<GridDims> readExtent(const VtkXmlOutline& outline, const std::filesystem::path& path) {
    std::vector<std::int64_t> extent;
    const std::string_view text = xmlValue(outline.grid, "WholeExtent");
    constexpr std::int64_t kBound = std::int64_t{1} << 30;
    if (!parseIntegers(text, extent) || extent.size() != 6 ||
        std::any_of(extent.begin(), extent.end(), [](auto e) { return e < -kBound || e > kBound; }))
        return refuseField("WholeExtent", "six whole numbers expected, found " + inQuotes(text), path);
    std::vector<std::int64_t> piece;
    if (outline.pieces.size() != 1 || !parseIntegers(xmlValue(outline.pieces[0], "Extent"), piece) || piece != extent)
        return refuseField("Piece", "one with the whole extent expected", path);
    const std::int64_t sizes[] = {extent[1] - extent[0] + 1, extent[3] - extent[2] + 1, extent[5] - extent[4] + 1};
    return checkDims(sizes, "WholeExtent", path);
}

/// Of an unstructured grid: a list of points. Its cells are counted against the file as its points are.
Result<GridDims> readCount(const VtkXmlOutline& outline, const RandomAccessFile& file) {
    if (outline.pieces.size() != 1)
        return refuseField("Piece", "one expected, found " + std::to_string(outline.pieces.size()), file.path());
    const auto points = parseInteger(xmlValue(outline.pieces[0], "NumberOfPoints"));
    const auto cells = parseInteger(xmlValue(outline.pieces[0], "NumberOfCells"));
    // Each cell has a type and an offset; packed, both may take little room, but not none.
    const auto most = static_cast<std::int64_t>(std::min<std::uint64_t>(file.sizeBytes(), 1u << 30) * 1000);
    if (!points || *points < 1 || *points > kMaxPoints)
        return refuseField("NumberOfPoints", inQuotes(xmlValue(outline.pieces[0], "NumberOfPoints")) +
                                                 " is not a number of points", file.path());
    if (!cells || *cells < 1 || *cells > most)
        return refuseField("NumberOfCells", inQuotes(xmlValue(outline.pieces[0], "NumberOfCells")) +
                                                " is not a number of cells that this file can hold", file.path());
    return GridDims{*points, 1, 1};
}

VtkKind kindOf(const VtkXmlOutline& outline) {
    const std::string_view type = xmlValue(outline.file, "type");
    return type == "RectilinearGrid"    ? VtkKind::Rectilinear
           : type == "StructuredGrid"   ? VtkKind::Structured
           : type == "UnstructuredGrid" ? VtkKind::Unstructured
                                        : VtkKind::Image;
}

Status checkArrays(const VtkXmlOutline& outline, const std::filesystem::path& path) {
    if (outline.pointArrays.empty())
        return refuseField("PointData", outline.cellArrays > 0
                                            ? "values belong to cells only; convert them to point data first"
                                            : "has no array", path);
    for (const XmlAttributes& other : outline.fieldArrays) // VTK reads these whether wanted or not
        for (const char* key : {"NumberOfTuples", "NumberOfComponents"}) {
            const auto count = parseInteger(xmlValue(other, key, "1"));
            if (!count || *count < 0 || *count > 65536)
                return refuseField(key, "of a field array is not usable", path);
        }
    return {};
}

/// Checks that the file can hold what an array claims.
class RoomCheck {
public:
    /// `expected` bytes in `values` numbers.
    RoomCheck(const RandomAccessFile& file, const VtkXmlOutline& outline, std::uint64_t values, std::uint64_t expected)
        : file_(file), outline_(outline), values_(values), expected_(expected) {
        isWide_ = xmlValue(outline.file, "header_type", "UInt32") == "UInt64";
        isCompressed_ = !xmlValue(outline.file, "compressor").empty();
        isBigEndian_ = xmlValue(outline.file, "byte_order") == "BigEndian";
    }

    Status run(const XmlAttributes& array) const {
        const std::string_view format = xmlValue(array, "format", "ascii");
        // Deflate packs at most 1032 to 1, LZ4 less; LZMA is given the benefit of the doubt.
        const std::uint64_t least = format == "ascii" ? values_ : isCompressed_ ? expected_ / 8000 : expected_;
        if (least > file_.sizeBytes())
            return makeError(ErrorCode::Corruption,
                             "data: the extent asks for " + std::to_string(expected_) + " bytes, the file has only " +
                                 std::to_string(file_.sizeBytes()),
                             file_.path());
        return format == "appended" ? checkAppended(array) : Status();
    }

private:
    Status checkAppended(const XmlAttributes& array) const {
        const auto offset = parseInteger(xmlValue(array, "offset"));
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
        return xmlValue(outline_.appended, "encoding", "raw") == "raw" ? checkBlocks(at) : Status();
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
    const VtkXmlOutline& outline_;
    std::uint64_t values_, expected_;
    bool isWide_ = false;
    bool isCompressed_ = false;
    bool isBigEndian_ = false;
};

} // namespace

Result<VtkXmlHeader> readVtkXmlHeader(const RandomAccessFile& file) {
    auto outline = readVtkXmlOutline(file);
    if (!outline.isOk())
        return std::move(outline).error();
    VtkXmlHeader header;
    header.outline = std::move(outline).value();
    header.kind = kindOf(header.outline);
    const auto dims = header.kind == VtkKind::Unstructured ? readCount(header.outline, file)
                                                           : readExtent(header.outline, file.path());
    if (!dims.isOk())
        return dims.error();
    header.dims = dims.value();
    header.points = static_cast<std::uint64_t>(pointCount(header.dims));
    ISO_TRY(checkArrays(header.outline, file.path()));
    return header;
}

VolumeContents contentsOf(const VtkXmlHeader& header) {
    VolumeContents contents;
    contents.format = formatName(header.kind);
    contents.isPreferredChosen = true;
    const auto& arrays = header.outline.pointArrays;
    for (const XmlAttributes& array : arrays) {
        VolumeField field;
        field.name = xmlValue(array, "Name");
        field.dims = header.dims;
        field.isResampled = header.kind == VtkKind::Structured || header.kind == VtkKind::Unstructured;
        const TypeSize* type = typeOf(array);
        field.typeName = type == nullptr ? "" : type->listed;
        field.components = static_cast<int>(componentsOf(array));
        if (type == nullptr)
            field.problem = "type: " + inQuotes(xmlValue(array, "type")) + " is not a known type of scalars";
        else if (field.components == 0)
            field.problem = "NumberOfComponents: " + inQuotes(xmlValue(array, "NumberOfComponents")) +
                            " is not a number of components";
        for (int c = 0; c < field.components && array.contains("ComponentName0"); ++c)
            field.componentNames.emplace_back(xmlValue(array, "ComponentName" + std::to_string(c)));
        contents.fields.push_back(std::move(field));
    }
    const auto prefer = [&](const auto& isWanted) {
        const auto found = std::find_if(contents.fields.begin(), contents.fields.end(), isWanted);
        contents.preferred = static_cast<std::size_t>(found - contents.fields.begin());
        return found != contents.fields.end();
    };
    const std::string_view active = xmlValue(header.outline.pointData, "Scalars");
    if (!(prefer([&](const VolumeField& field) { return !active.empty() && field.name == active; }) ||
          prefer([](const VolumeField& field) { return field.components == 1 && field.problem.empty(); }) ||
          prefer([](const VolumeField& field) { return field.problem.empty(); })))
        contents.preferred = 0;
    return contents;
}

Status checkVtkXmlRoom(const RandomAccessFile& file, const VtkXmlHeader& header, std::size_t array) {
    std::vector<const XmlAttributes*> needed{&header.outline.pointArrays[array]};
    std::vector<std::uint64_t> tuples{header.points};
    for (std::size_t i = 0; i < header.outline.placeArrays.size(); ++i) {
        needed.push_back(&header.outline.placeArrays[i]);
        tuples.push_back(header.kind == VtkKind::Rectilinear ? static_cast<std::uint64_t>(header.dims[std::min<std::size_t>(i, 2)])
                                                             : header.points);
    }
    for (std::size_t i = 0; i < needed.size(); ++i) {
        const TypeSize* type = typeOf(*needed[i]);
        const auto components = static_cast<std::uint64_t>(componentsOf(*needed[i]));
        if (type == nullptr || components == 0)
            return refuseField(type == nullptr ? "type" : "NumberOfComponents",
                               "of the array " + inQuotes(xmlValue(*needed[i], "Name")) + " is not usable", file.path());
        const std::uint64_t values = tuples[i] * components;
        ISO_TRY(RoomCheck(file, header.outline, values, values * type->sizeBytes).run(*needed[i]));
    }
    return {};
}

} // namespace isoslider::io
