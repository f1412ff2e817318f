#include "ui/model/opening/raw_guess.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <regex>
#include <string>

namespace isoslider::model {
namespace {

struct TypeWord {
    const char* word;
    ScalarType type;
};
// Longer words first: "uint8" holds "int8".
constexpr std::array<TypeWord, 19> kTypeWords{{{"uint16", ScalarType::U16},
                                               {"float64", ScalarType::F64},
                                               {"float32", ScalarType::F32},
                                               {"ushort", ScalarType::U16},
                                               {"uchar", ScalarType::U8},
                                               {"uint8", ScalarType::U8},
                                               {"int16", ScalarType::I16},
                                               {"int32", ScalarType::I32},
                                               {"int8", ScalarType::I8},
                                               {"double", ScalarType::F64},
                                               {"float", ScalarType::F32},
                                               {"short", ScalarType::I16},
                                               {"f32", ScalarType::F32},
                                               {"f64", ScalarType::F64},
                                               {"u16", ScalarType::U16},
                                               {"i16", ScalarType::I16},
                                               {"i32", ScalarType::I32},
                                               {"u8", ScalarType::U8},
                                               {"i8", ScalarType::I8}}};
/// Without a word for it, types are tried in the order of how often they are met.
constexpr std::array<ScalarType, 4> kUsualTypes{ScalarType::U8, ScalarType::U16, ScalarType::F32, ScalarType::F64};

std::optional<ScalarType> typeInName(const std::string& name) {
    for (const auto& [word, type] : kTypeWords)
        if (name.find(word) != std::string::npos)
            return type;
    return std::nullopt;
}

/// A word of its own: "be" and "le" also stand in the middle of others.
std::optional<bool> byteOrderInName(const std::string& name) {
    static const std::regex big("(^|[^a-z])(be|bigendian|big_endian|msb)([^a-z]|$)");
    static const std::regex little("(^|[^a-z])(le|littleendian|little_endian|lsb)([^a-z]|$)");
    if (std::regex_search(name, big))
        return true;
    return std::regex_search(name, little) ? std::optional(false) : std::nullopt;
}

GridDims dimsInName(const std::string& name) {
    static const std::regex pattern("([0-9]{1,6})[x_]([0-9]{1,6})[x_]([0-9]{1,6})");
    std::smatch match;
    if (!std::regex_search(name, match, pattern))
        return {0, 0, 0};
    return {std::stoll(match[1]), std::stoll(match[2]), std::stoll(match[3])};
}

bool fits(const GridDims& dims, ScalarType type, std::uint64_t bytes) {
    return std::all_of(dims.begin(), dims.end(), [](auto dim) { return dim >= 2 && dim <= kMaxDim; }) &&
           static_cast<std::uint64_t>(pointCount(dims)) * scalarTypeSizeBytes(type) == bytes;
}

/// A cube, or square slices of a usual size, holding exactly these bytes.
GridDims dimsOfSize(ScalarType type, std::uint64_t bytes) {
    const auto points = static_cast<double>(bytes) / static_cast<double>(scalarTypeSizeBytes(type));
    const auto side = static_cast<std::int64_t>(std::llround(std::cbrt(points)));
    if (fits({side, side, side}, type, bytes))
        return {side, side, side};
    for (const std::int64_t slice : {512, 256, 1024, 128, 64}) {
        const auto depth = static_cast<std::int64_t>(points) / (slice * slice);
        if (depth >= 8 && depth <= 4 * slice && fits({slice, slice, depth}, type, bytes))
            return {slice, slice, depth};
    }
    return {0, 0, 0};
}

} // namespace

bool isHeaderlessSuffix(const std::filesystem::path& path) {
    auto suffix = path.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return suffix == ".raw" || suffix == ".dat";
}

std::uint64_t layoutBytes(const io::RawLayout& layout) {
    return layout.skipBytes + static_cast<std::uint64_t>(pointCount(layout.dims)) * scalarTypeSizeBytes(layout.type);
}

NamedLayout layoutInName(std::string_view fileName) {
    std::string name(fileName);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return {dimsInName(name), typeInName(name), byteOrderInName(name)};
}

io::RawLayout guessRawLayout(std::string_view fileName, std::uint64_t fileBytes) {
    const auto [dims, named, isBigEndian] = layoutInName(fileName);
    io::RawLayout layout;
    layout.isBigEndian = isBigEndian.value_or(false);
    layout.type = named.value_or(ScalarType::U8);
    if (named && dims[0] > 0) {
        layout.dims = dims;
        return layout;
    }
    for (const ScalarType type : kUsualTypes) {
        const ScalarType tried = named.value_or(type);
        const GridDims found = dims[0] > 0 && fits(dims, tried, fileBytes) ? dims : dimsOfSize(tried, fileBytes);
        if (found[0] > 0 && (dims[0] == 0 || found == dims)) {
            layout.dims = found;
            layout.type = tried;
            return layout;
        }
    }
    layout.dims = dims;
    return layout;
}

} // namespace isoslider::model
