#include "core/volume_io/formats/vtk/vtk_xml_header.h"

#include <algorithm>
#include <optional>

#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

constexpr std::int64_t kMaxComponents = 1000;

struct TypeSize {
    std::string_view name;
    std::uint64_t sizeBytes;
    const char* listed; ///< as VolumeField states it
};
constexpr TypeSize kTypes[] = {{"Int8", 1, "int8"},      {"UInt8", 1, "uint8"},   {"Int16", 2, "int16"},
                               {"UInt16", 2, "uint16"},  {"Int32", 4, "int32"},   {"UInt32", 4, "uint32"},
                               {"Int64", 8, "int64"},    {"UInt64", 8, "uint64"}, {"Float32", 4, "float32"},
                               {"Float64", 8, "float64"}};

const TypeSize* typeOf(const XmlAttributes& array) {
    const auto* found = std::find_if(std::begin(kTypes), std::end(kTypes),
                                     [&](const TypeSize& known) { return known.name == xmlValue(array, "type"); });
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
        return refuseField("NumberOfPoints",
                           inQuotes(xmlValue(outline.pieces[0], "NumberOfPoints")) + " is not a number of points",
                           file.path());
    if (!cells || *cells < 1 || *cells > most)
        return refuseField("NumberOfCells",
                           inQuotes(xmlValue(outline.pieces[0], "NumberOfCells")) +
                               " is not a number of cells that this file can hold",
                           file.path());
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
        return refuseField("PointData",
                           outline.cellArrays > 0 ? "values belong to cells only; convert them to point data first"
                                                  : "has no array",
                           path);
    for (const XmlAttributes& other : outline.fieldArrays) // VTK reads these whether wanted or not
        for (const char* key : {"NumberOfTuples", "NumberOfComponents"}) {
            const auto count = parseInteger(xmlValue(other, key, "1"));
            if (!count || *count < 0 || *count > 65536)
                return refuseField(key, "of a field array is not usable", path);
        }
    return {};
}

constexpr std::uint64_t kMaxPacking = 8000; ///< deflate packs at most 1032 to 1, LZ4 less; LZMA is given the benefit
constexpr std::uint64_t kMaxBlockBytes = std::uint64_t{1} << 28;

int base64Value(char c) {
    constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const auto at = kLetters.find(c);
    return at == std::string_view::npos ? -1 : static_cast<int>(at);
}

/// The numbers that head the data of an array, raw or in base64.
class BlockHeading {
public:
    BlockHeading(const RandomAccessFile& file, std::uint64_t begin, bool isText, std::uint64_t width, bool isBigEndian)
        : file_(file), begin_(begin), isText_(isText), width_(width), isBigEndian_(isBigEndian) {}

    /// Errors: Corruption (the file ends first, or it is no base64).
    Result<std::uint64_t> number(std::uint64_t index) {
        const std::uint64_t end = (index + 1) * width_;
        if (end > bytes_.size())
            ISO_TRY(isText_ ? decode(end) : fetch(end));
        std::uint64_t value = 0;
        for (std::uint64_t i = 0; i < width_; ++i)
            value |= std::to_integer<std::uint64_t>(bytes_[end - width_ + i])
                     << 8 * (isBigEndian_ ? width_ - 1 - i : i);
        return value;
    }

private:
    static constexpr std::uint64_t kStep = std::uint64_t{1} << 16;

    Status fetch(std::uint64_t end) {
        const std::uint64_t begin = bytes_.size();
        const std::uint64_t left = file_.sizeBytes() - std::min(file_.sizeBytes(), begin_ + begin);
        bytes_.resize(std::max(end, begin + std::min(kStep, left)));
        return file_.readExactlyAt(begin_ + begin, std::span(bytes_).subspan(begin));
    }

    Status decode(std::uint64_t end) {
        std::vector<std::byte> text(kStep);
        while (bytes_.size() < end) {
            const auto got = file_.readAt(begin_ + consumed_, text);
            if (!got.isOk())
                return got.error();
            for (std::size_t i = 0; i < got.value(); ++i, ++consumed_) {
                const char c = static_cast<char>(text[i]);
                if (c == ' ' || c == '\n' || c == '\t' || c == '\r')
                    continue;
                const int value = c == '=' ? 0 : base64Value(c); // a heading of packed data is encoded alone
                if (value < 0)
                    return makeError(ErrorCode::Corruption, "data: its heading is no base64", file_.path(),
                                     begin_ + consumed_);
                bits_ = bits_ << 6 | static_cast<unsigned>(value);
                if (++letters_ % 4 == 0)
                    for (int shift = 16; shift >= 0; shift -= 8)
                        bytes_.push_back(static_cast<std::byte>(bits_ >> shift & 0xff));
                if (bytes_.size() >= end) {
                    ++consumed_;
                    return {};
                }
            }
            if (got.value() == 0)
                break;
        }
        if (bytes_.size() < end)
            return makeError(ErrorCode::Corruption, "data: the file ends in its heading", file_.path(), begin_);
        return {};
    }

    const RandomAccessFile& file_;
    std::uint64_t begin_;
    bool isText_;
    std::uint64_t width_;
    bool isBigEndian_;
    std::vector<std::byte> bytes_;
    std::uint64_t consumed_ = 0, letters_ = 0;
    unsigned bits_ = 0;
};

/// Checks that the file can hold what an array claims.
class RoomCheck {
public:
    /// Of `values` numbers of `size` bytes; none: as many as there are.
    RoomCheck(const RandomAccessFile& file, const VtkXmlOutline& outline, std::optional<std::uint64_t> values,
              std::uint64_t size)
        : file_(file), outline_(outline), values_(values), expected_(values.value_or(0) * size) {
        width_ = xmlValue(outline.file, "header_type", "UInt32") == "UInt64" ? 8 : 4;
        isPacked_ = !xmlValue(outline.file, "compressor").empty();
        isBigEndian_ = xmlValue(outline.file, "byte_order") == "BigEndian";
    }

    Status run(const XmlArray& array) const {
        const std::string_view format = xmlValue(array, "format", "ascii");
        const std::uint64_t least = format == "ascii" ? values_.value_or(0)
                                    : isPacked_       ? expected_ / kMaxPacking
                                                      : expected_;
        if (least > file_.sizeBytes())
            return makeError(ErrorCode::Corruption,
                             "data: the extent asks for " + std::to_string(expected_) + " bytes, the file has only " +
                                 std::to_string(file_.sizeBytes()),
                             file_.path());
        if (format == "ascii")
            return {};
        const auto place = placeOfData(file_, outline_, array);
        return place.isOk() ? checkBlocks(place.value().begin, place.value().isText) : Status(place.error());
    }

private:
    Error blockError(std::string problem, std::uint64_t at) const {
        return makeError(ErrorCode::Corruption, "data block: " + std::move(problem), file_.path(), at);
    }

    Status checkBlocks(std::uint64_t at, bool isText) const {
        BlockHeading heading(file_, at, isText, width_, isBigEndian_);
        // What is left of the file, as raw bytes.
        const std::uint64_t left = (file_.sizeBytes() - std::min(at, file_.sizeBytes())) * (isText ? 3 : 4) / 4;
        return isPacked_ ? checkPacked(heading, at, left) : checkPlain(heading, at, left);
    }

    // Byte count, bytes.
    Status checkPlain(BlockHeading& heading, std::uint64_t at, std::uint64_t left) const {
        const auto bytes = heading.number(0);
        if (!bytes.isOk())
            return bytes.error();
        if ((values_ ? bytes.value() != expected_ : bytes.value() == 0) || bytes.value() > left)
            return blockError(std::to_string(bytes.value()) + " bytes announced, " +
                                  (values_ ? std::to_string(expected_) + " expected, " : "") + std::to_string(left) +
                                  " left",
                              at);
        return {};
    }

    // Number of blocks, their size, the last one's size if it differs, the packed sizes, the blocks.
    Status checkPacked(BlockHeading& heading, std::uint64_t at, std::uint64_t left) const {
        const auto first = heading.number(0), size = heading.number(1), last = heading.number(2);
        if (!first.isOk() || !size.isOk() || !last.isOk())
            return !first.isOk() ? first.error() : !size.isOk() ? size.error() : last.error();
        const std::uint64_t blocks = first.value();
        if ((blocks == 0 && (expected_ > 0 || !values_)) || blocks > left / width_)
            return blockError(std::to_string(blocks) + " blocks cannot be in this file", at);
        if (blocks > 0 && (size.value() == 0 || size.value() > kMaxBlockBytes || last.value() > size.value()))
            return blockError("of " + std::to_string(size.value()) + " bytes, the last one of " +
                                  std::to_string(last.value()),
                              at); // VTK divides by the size
        const std::uint64_t whole = last.value() == 0 || blocks == 0 ? blocks : blocks - 1;
        const std::uint64_t total = whole * size.value() + last.value();
        if (values_ ? total != expected_ : total == 0 || total / kMaxPacking > left)
            return blockError("the blocks unpack to " + std::to_string(total) + " bytes" +
                                  (values_ ? ", expected are " + std::to_string(expected_) : ""),
                              at);
        std::uint64_t packedBytes = (3 + blocks) * width_;
        for (std::uint64_t i = 0; i < blocks; ++i) {
            const auto packed = heading.number(3 + i);
            if (!packed.isOk())
                return packed.error();
            if (packed.value() > left || (packedBytes += packed.value()) > left)
                return blockError("ends beyond the file", at);
        }
        return {};
    }

    const RandomAccessFile& file_;
    const VtkXmlOutline& outline_;
    std::optional<std::uint64_t> values_;
    std::uint64_t expected_;
    std::uint64_t width_ = 4;
    bool isPacked_ = false;
    bool isBigEndian_ = false;
};

} // namespace

Result<VtkXmlPlace> placeOfData(const RandomAccessFile& file, const VtkXmlOutline& outline, const XmlArray& array) {
    const std::string_view format = xmlValue(array, "format", "ascii");
    if (format == "binary")
        return VtkXmlPlace{array.contentBegin, true};
    if (format != "appended")
        return refuseField("format", inQuotes(format) + " is not ascii, binary or appended", file.path());
    const auto offset = parseInteger(xmlValue(array, "offset"));
    const auto begin = outline.appendedBegin;
    if (!begin || !offset || *offset < 0)
        return refuseField("offset", "appended data has no usable place", file.path());
    std::vector<std::byte> start(256); // blanks, then an underscore: what VTK makes of anything else is its own
    auto got = file.readAt(*begin, start);
    if (!got.isOk())
        return std::move(got).error();
    const auto end = start.begin() + static_cast<std::ptrdiff_t>(got.value());
    const auto mark = std::find_if(start.begin(), end, [](std::byte b) {
        const char c = static_cast<char>(b);
        return c != ' ' && c != '\n' && c != '\t' && c != '\r';
    });
    const std::uint64_t at =
        *begin + static_cast<std::uint64_t>(mark - start.begin()) + 1 + static_cast<std::uint64_t>(*offset);
    if (mark == end || *mark != std::byte{'_'} || at >= file.sizeBytes())
        return makeError(ErrorCode::Corruption, "offset: appended data lies beyond the end of the file", file.path(),
                         at);
    const std::string_view encoding = xmlValue(outline.appended, "encoding");
    if (encoding != "raw" && encoding != "base64")
        return refuseField("encoding", inQuotes(encoding) + " is not raw or base64", file.path());
    return VtkXmlPlace{at, encoding == "base64"};
}

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
        const std::int64_t components = componentsOf(array);
        field.components = static_cast<int>(std::max<std::int64_t>(components, 1));
        if (type == nullptr)
            field.problem = "type: " + inQuotes(xmlValue(array, "type")) + " is not a known type of scalars";
        else if (components == 0)
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
    const VtkXmlOutline& outline = header.outline;
    const auto check = [&](const XmlArray& needed, std::optional<std::uint64_t> tuples) -> Status {
        const TypeSize* type = typeOf(needed);
        const auto components = static_cast<std::uint64_t>(componentsOf(needed));
        if (type == nullptr || components == 0)
            return refuseField(type == nullptr ? "type" : "NumberOfComponents",
                               "of the array " + inQuotes(xmlValue(needed, "Name")) + " is not usable", file.path());
        if (tuples)
            *tuples *= components;
        return RoomCheck(file, outline, tuples, type->sizeBytes).run(needed);
    };
    ISO_TRY(check(outline.pointArrays[array], header.points));
    for (std::size_t i = 0; i < outline.placeArrays.size(); ++i)
        ISO_TRY(check(outline.placeArrays[i], header.kind == VtkKind::Rectilinear
                                                  ? static_cast<std::uint64_t>(header.dims[std::min<std::size_t>(i, 2)])
                                                  : header.points));
    for (const XmlArray& cells : outline.cellsArrays) {
        const std::string_view name = xmlValue(cells, "Name");
        const bool isOnePerCell = name == "offsets" || name == "types";
        const auto count = parseInteger(xmlValue(outline.pieces[0], "NumberOfCells"));
        ISO_TRY(check(cells, isOnePerCell && count ? std::optional(static_cast<std::uint64_t>(*count)) : std::nullopt));
    }
    return {};
}

} // namespace isoslider::io
