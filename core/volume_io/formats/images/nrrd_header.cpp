#include "core/volume_io/formats/images/nrrd_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/grid/length_unit.h"
#include "core/volume_io/formats/data_files.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

struct TypeName {
    std::string_view name;
    FileType type;
};
constexpr TypeName kTypes[] = {{"signed char", FileType::I8},
                               {"int8", FileType::I8},
                               {"int8_t", FileType::I8},
                               {"uchar", FileType::U8},
                               {"unsigned char", FileType::U8},
                               {"uint8", FileType::U8},
                               {"uint8_t", FileType::U8},
                               {"short", FileType::I16},
                               {"short int", FileType::I16},
                               {"signed short", FileType::I16},
                               {"signed short int", FileType::I16},
                               {"int16", FileType::I16},
                               {"int16_t", FileType::I16},
                               {"ushort", FileType::U16},
                               {"unsigned short", FileType::U16},
                               {"unsigned short int", FileType::U16},
                               {"uint16", FileType::U16},
                               {"uint16_t", FileType::U16},
                               {"int", FileType::I32},
                               {"signed int", FileType::I32},
                               {"int32", FileType::I32},
                               {"int32_t", FileType::I32},
                               {"uint", FileType::U32},
                               {"unsigned int", FileType::U32},
                               {"uint32", FileType::U32},
                               {"uint32_t", FileType::U32},
                               {"longlong", FileType::I64},
                               {"long long", FileType::I64},
                               {"long long int", FileType::I64},
                               {"signed long long", FileType::I64},
                               {"signed long long int", FileType::I64},
                               {"int64", FileType::I64},
                               {"int64_t", FileType::I64},
                               {"ulonglong", FileType::U64},
                               {"unsigned long long", FileType::U64},
                               {"unsigned long long int", FileType::U64},
                               {"uint64", FileType::U64},
                               {"uint64_t", FileType::U64},
                               {"float", FileType::F32},
                               {"double", FileType::F64}};

/// A kind of axis that holds several values of one place, and their names if their number is that.
struct ComponentKind {
    std::string_view kind;
    std::vector<std::string> names = {};
};
const std::vector<ComponentKind>& componentKinds() {
    static const std::vector<ComponentKind> kinds = {
        {"complex", {"real", "imaginary"}},
        {"rgb-color", {"red", "green", "blue"}},
        {"3-color", {"red", "green", "blue"}},
        {"rgba-color", {"red", "green", "blue", "alpha"}},
        {"4-color", {"red", "green", "blue", "alpha"}},
        {"hsv-color", {"hue", "saturation", "value"}},
        {"xyz-color", {"X", "Y", "Z"}},
        {"vector", {"x", "y", "z"}},
        {"covariant-vector", {"x", "y", "z"}},
        {"normal", {"x", "y", "z"}},
        {"point", {"x", "y", "z"}},
        {"2-vector", {"x", "y"}},
        {"3-vector", {"x", "y", "z"}},
        {"3-gradient", {"x", "y", "z"}},
        {"3-normal", {"x", "y", "z"}},
        {"4-vector"},
        {"quaternion", {"w", "x", "y", "z"}},
        {"2d-symmetric-matrix", {"xx", "xy", "yy"}},
        {"2d-masked-symmetric-matrix", {"mask", "xx", "xy", "yy"}},
        {"2d-matrix", {"xx", "xy", "yx", "yy"}},
        {"2d-masked-matrix", {"mask", "xx", "xy", "yx", "yy"}},
        {"3d-symmetric-matrix", {"xx", "xy", "xz", "yy", "yz", "zz"}},
        {"3d-masked-symmetric-matrix", {"mask", "xx", "xy", "xz", "yy", "yz", "zz"}},
        {"3d-matrix", {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"}},
        {"3d-masked-matrix"},
        {"scalar"},
        {"stub"}};
    return kinds;
}
const ComponentKind* findComponentKind(std::string_view kind) {
    const auto& kinds = componentKinds();
    const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const ComponentKind& k) { return k.kind == kind; });
    return found == kinds.end() ? nullptr : &*found;
}

// Spellings with and without the blank are the same field.
std::string fieldName(std::string_view text) {
    std::string name = lowerCase(trimmed(text));
    constexpr std::pair<std::string_view, std::string_view> kSpellings[] = {
        {"datafile", "data file"}, {"lineskip", "line skip"}, {"byteskip", "byte skip"},
        {"axismins", "axis mins"}, {"axismaxs", "axis maxs"}, {"centerings", "centers"}};
    for (const auto& [other, ours] : kSpellings)
        if (name == other)
            name = ours;
    return name;
}

Status addField(NrrdHeader& header, std::string_view line, const fs::path& path) {
    const auto colon = line.find(':');
    if (colon == std::string_view::npos)
        return makeError(ErrorCode::InvalidArgument,
                         "is not NRRD: a line 'field: value' was expected, found " + inQuotes(line), path);
    if (line.substr(colon).starts_with(":=")) // a note of the writer's own
        return {};
    const std::string name = fieldName(line.substr(0, colon));
    if (!header.fields.emplace(name, trimmed(line.substr(colon + 1))).second)
        return refuseField(name, "is given twice", path);
    return {};
}

Result<NrrdHeader> readFields(const fs::path& path) {
    auto text = readStart(path);
    if (!text.isOk())
        return std::move(text).error();
    std::string_view rest = text.value();
    if (rest.starts_with("\xef\xbb\xbf")) // byte order mark of an editor
        rest.remove_prefix(3);
    NrrdHeader header;
    header.isDetached = true; // until a blank line states otherwise
    bool isList = false;
    for (std::size_t number = 0; !rest.empty(); ++number) {
        const auto lineEnd = rest.find('\n');
        const std::string_view line = trimmed(rest.substr(0, lineEnd));
        if (rest.substr(0, lineEnd).size() > kMaxHeaderLine)
            return makeError(ErrorCode::InvalidArgument,
                             "is not NRRD: line " + std::to_string(number + 1) + " of its header is too long", path);
        rest.remove_prefix(lineEnd == std::string_view::npos ? rest.size() : lineEnd + 1);
        if (number == 0) {
            if (line.size() != 8 || !line.starts_with("NRRD000") || line[7] < '1' || line[7] > '5')
                return makeError(ErrorCode::InvalidArgument,
                                 "is not NRRD: NRRD0001 to NRRD0005 expected, found " + inQuotes(line.substr(0, 12)),
                                 path);
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

// "(1,0,0) (0, 2, 0) none" as three words.
std::vector<std::string> directionsOf(std::string_view text) {
    std::vector<std::string> out;
    while (!(text = trimmed(text)).empty()) {
        const auto end = text.front() == '(' ? text.find(')') : text.find_first_of(" \t(", 1);
        const auto size = end == std::string_view::npos ? text.size() : text.front() == '(' ? end + 1 : end;
        std::string word(text.substr(0, size));
        word.erase(std::remove_if(word.begin(), word.end(), [](char c) { return c == ' ' || c == '\t'; }), word.end());
        out.push_back(std::move(word));
        text.remove_prefix(size);
    }
    return out;
}

std::vector<std::string> wordsOf(std::string_view text) {
    std::vector<std::string> out;
    for (const std::string_view word : words(text))
        out.emplace_back(word);
    return out;
}

/// What stands between quotes.
std::vector<std::string> quotedOf(std::string_view text) {
    std::vector<std::string> out;
    for (auto begin = text.find('"'); begin != std::string_view::npos; begin = text.find('"')) {
        const auto end = text.find('"', begin + 1);
        if (end == std::string_view::npos)
            break;
        out.emplace_back(text.substr(begin + 1, end - begin - 1));
        text.remove_prefix(end + 1);
    }
    return out;
}

// A unit is of no weight for the samples: where the count is wrong, there is none.
void readUnits(NrrdHeader& header) {
    const auto units = quotedOf(header["units"]);
    for (std::size_t i = 0; units.size() == header.axes.size() && i < units.size(); ++i)
        header.axes[i].unit = units[i];
}

// Between the first and the last sample, or, of cells, between their outer borders. Only where no spacing is given.
void spaceByExtent(NrrdAxis& axis) {
    const auto low = parseReal(axis.minimum), high = parseReal(axis.maximum);
    const bool isCell = axis.center == "cell";
    const std::int64_t steps = isCell ? axis.size : axis.size - 1;
    if (!axis.spacing.empty() || axis.direction || !low || !high || steps < 1)
        return;
    const double spacing = (*high - *low) / static_cast<double>(steps);
    if (!std::isfinite(spacing) || !(spacing > 0.0))
        return;
    if (axis.center.empty() || axis.center == "none" || axis.center == "???")
        axis.center = "node"; // as teem takes it, and spacing is computed here
    std::array<char, 32> digits{};
    axis.spacing = {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), spacing).ptr};
}

Status readDirections(NrrdHeader& header, const fs::path& path) {
    const std::vector<std::string> vectors = directionsOf(header["space directions"]);
    if (!vectors.empty() && vectors.size() != header.axes.size())
        return refuseField("space directions",
                           std::to_string(header.axes.size()) + " values expected, found " +
                               inQuotes(header["space directions"]),
                           path);
    std::size_t length = 0; // of the first one
    for (std::size_t i = 0; i < vectors.size(); ++i) {
        auto vector = vectors[i] == "none" ? std::vector<double>() : parseNrrdVector(vectors[i]);
        if (vector && std::ranges::all_of(*vector, [](double number) { return std::isnan(number); }))
            vector->clear(); // another way to write "none"
        if (vector && length == 0)
            length = vector->size();
        const bool isWhole = vector && (vector->empty() || vector->size() == length) &&
                             std::ranges::all_of(*vector, [](double number) { return std::isfinite(number); });
        if (!isWhole)
            return refuseField("space directions",
                               "vectors of finite numbers, all of one length, expected; found " + inQuotes(vectors[i]),
                               path);
        header.axes[i].direction = std::move(vector);
    }
    return {};
}

Status readAxes(NrrdHeader& header, const fs::path& path) {
    const auto dimension = parseInteger(header["dimension"]);
    if (!dimension || *dimension < 1 || *dimension > 16)
        return refuseField("dimension", inQuotes(header["dimension"]) + " is not a number from 1 to 16", path);
    std::vector<std::int64_t> sizes;
    const auto count = static_cast<std::size_t>(*dimension);
    if (!parseIntegers(header["sizes"], sizes) || sizes.size() != count)
        return refuseField("sizes",
                           std::to_string(count) + " whole numbers expected, found " + inQuotes(header["sizes"]), path);
    ISO_TRY(checkExtents(sizes, "sizes", path));
    for (const std::int64_t size : sizes)
        header.axes.emplace_back().size = size;
    const auto fill = [&](std::string_view field, const std::vector<std::string>& values,
                          std::string NrrdAxis::*member) -> Status {
        if (!values.empty() && values.size() != count)
            return refuseField(field, std::to_string(count) + " values expected, found " + inQuotes(header[field]),
                               path);
        for (std::size_t i = 0; i < values.size(); ++i)
            header.axes[i].*member = values[i];
        return {};
    };
    ISO_TRY(fill("kinds", wordsOf(lowerCase(header["kinds"])), &NrrdAxis::kind));
    ISO_TRY(readDirections(header, path));
    ISO_TRY(fill("spacings", wordsOf(lowerCase(header["spacings"])), &NrrdAxis::spacing));
    ISO_TRY(fill("centers", wordsOf(lowerCase(header["centers"])), &NrrdAxis::center));
    ISO_TRY(fill("axis mins", wordsOf(lowerCase(header["axis mins"])), &NrrdAxis::minimum));
    ISO_TRY(fill("axis maxs", wordsOf(lowerCase(header["axis maxs"])), &NrrdAxis::maximum));
    for (NrrdAxis& axis : header.axes)
        spaceByExtent(axis);
    readUnits(header);
    return {};
}

// A space with time has a fourth number in its vectors: the axis along it is no axis of space.
Status splitTime(NrrdHeader& header, const fs::path& path) {
    std::string space = lowerCase(header["space"]);
    const bool isShort = space == "rast" || space == "last" || space == "lpst";
    if (!isShort && !space.ends_with("-time"))
        return {};
    header.fields["space"] = space.substr(0, space.size() - (isShort ? 1 : 5));
    for (NrrdAxis& axis : header.axes) {
        if (!axis.direction || axis.direction->empty())
            continue;
        if (axis.direction->size() != 4)
            return refuseField("space directions",
                               "four numbers expected, found " + std::to_string(axis.direction->size()), path);
        axis.direction->pop_back();
        if (*axis.direction == std::vector<double>(3, 0.0)) {
            axis.direction->clear();
            axis.kind = "time";
        }
    }
    std::string& origin = header.fields["space origin"];
    if (const auto last = origin.find_last_of(','); last != std::string::npos)
        origin = origin.substr(0, last) + ")";
    return {};
}

bool isSpace(const NrrdAxis& axis, std::size_t dimension) {
    if ((axis.direction && axis.direction->empty()) || axis.kind == "time" || axis.kind == "list" ||
        findComponentKind(axis.kind) != nullptr)
        return false;
    return dimension <= 3 || axis.direction || axis.spacing != "nan"; // no distance: no space
}

Status assignRoles(NrrdHeader& header, const fs::path& path) {
    int spaces = 0;
    // What is no space, and whose kind does not decide, is a series if it is the slowest axis, as writers have
    // it.
    for (std::size_t i = 0; i < header.axes.size(); ++i) {
        NrrdAxis& axis = header.axes[i];
        if (isSpace(axis, header.axes.size()))
            axis.role = ++spaces <= 3 ? NrrdRole::Space : NrrdRole::Frame;
        else if (axis.kind != "time" && (findComponentKind(axis.kind) != nullptr || i + 1 < header.axes.size()))
            axis.role = NrrdRole::Component;
        else
            axis.role = NrrdRole::Frame;
    }
    if (spaces == 0)
        return refuseField("kinds", "none of the axes is one of space", path);
    for (const NrrdRole role : {NrrdRole::Component, NrrdRole::Frame})
        if (std::count_if(header.axes.begin(), header.axes.end(),
                          [&](const NrrdAxis& axis) { return axis.role == role && axis.size > 1; }) > 1)
            return refuseField("sizes",
                               std::string("several axes of ") + (role == NrrdRole::Frame ? "frames" : "components") +
                                   " are not read; save one volume of it",
                               path);
    return {};
}

Status checkSpacings(const NrrdHeader& header, const fs::path& path) {
    for (const NrrdAxis& axis : header.axes) {
        if (axis.role != NrrdRole::Space || axis.spacing.empty())
            continue;
        const auto spacing = parseReal(axis.spacing);
        if (!spacing || !std::isfinite(*spacing) || !(*spacing > 0.0))
            return refuseField("spacings", inQuotes(header["spacings"]) + " are not positive numbers", path);
    }
    return {};
}

Status readType(NrrdHeader& header, const fs::path& path) {
    const std::string name = lowerCase(header["type"]);
    const auto known =
        std::find_if(std::begin(kTypes), std::end(kTypes), [&](const TypeName& type) { return type.name == name; });
    if (known == std::end(kTypes))
        return refuseField("type", inQuotes(header["type"]) + " is not a known type of scalars", path);
    header.type = known->type;
    const std::string endian = lowerCase(header["endian"]);
    const bool needsEndian = fileTypeSizeBytes(header.type) > 1 && !header.isText();
    if (endian != "little" && endian != "big" && (!endian.empty() || needsEndian))
        return refuseField("endian", "little or big expected, found " + inQuotes(endian), path);
    header.isBigEndian = endian == "big";
    return {};
}

} // namespace

GridDims NrrdHeader::dims() const {
    GridDims dims{1, 1, 1};
    std::size_t next = 0;
    for (const NrrdAxis& axis : axes)
        if (axis.role == NrrdRole::Space)
            dims[next++] = axis.size;
    return dims;
}

std::int64_t NrrdHeader::extent(NrrdRole role) const {
    std::int64_t product = 1;
    for (const NrrdAxis& axis : axes)
        if (axis.role == role)
            product *= axis.size;
    return product;
}

std::vector<std::string> NrrdHeader::componentNames() const {
    for (const NrrdAxis& axis : axes) {
        const ComponentKind* kind = findComponentKind(axis.kind);
        if (axis.role == NrrdRole::Component && axis.size > 1 && kind != nullptr &&
            kind->names.size() == static_cast<std::size_t>(axis.size))
            return kind->names;
    }
    return {};
}

bool NrrdHeader::isText() const {
    const std::string encoding = lowerCase((*this)["encoding"]);
    return encoding == "ascii" || encoding == "text" || encoding == "txt";
}

Result<NrrdHeader> readNrrdHeader(const fs::path& path) {
    auto read = readFields(path);
    if (!read.isOk())
        return read;
    NrrdHeader& header = read.value();
    ISO_TRY(readAxes(header, path));
    ISO_TRY(splitTime(header, path));
    ISO_TRY(assignRoles(header, path));
    ISO_TRY(checkSpacings(header, path));
    ISO_TRY(readType(header, path));
    return read;
}

std::string lengthUnitOf(const NrrdHeader& header) {
    std::vector<std::string> units = quotedOf(header["space units"]);
    if (units.empty()) {
        for (const NrrdAxis& axis : header.axes)
            if (axis.role == NrrdRole::Space)
                units.push_back(axis.unit);
    } else if (units.size() > 3) {
        units.resize(3); // that of time
    }
    const bool isOne = !units.empty() && std::equal(units.begin() + 1, units.end(), units.begin());
    return isOne ? isoslider::lengthUnitOf(units[0]) : std::string();
}

std::optional<std::vector<double>> parseNrrdVector(std::string_view text) {
    if (text.size() < 2 || !text.starts_with('(') || !text.ends_with(')'))
        return std::nullopt;
    std::string inner(text.substr(1, text.size() - 2));
    std::ranges::replace(inner, ',', ' ');
    std::vector<double> numbers;
    if (!parseReals(inner, numbers) || numbers.empty())
        return std::nullopt;
    return numbers;
}

} // namespace isoslider::io
