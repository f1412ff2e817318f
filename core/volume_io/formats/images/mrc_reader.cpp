#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/parsing/byte_stream.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/sources/sample_source.h"
#include "core/volume_io/volume_choice.h"

// MRC and CCP4 maps: a header of 1024 bytes, symmetry records or an extended header, and samples, columns
// fastest. Which axes of the cell columns, rows and sections run along is stated by the direction matrix:
// samples stay in the order of the file, so that they can be streamed.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kHeaderBytes = 1024;

struct Header {
    std::array<std::byte, kHeaderBytes> bytes{};
    bool isBigEndian = false;

    template <class T>
    T at(std::size_t offset) const {
        std::array<std::byte, sizeof(T)> raw;
        std::memcpy(raw.data(), bytes.data() + offset, sizeof(T));
        if (isBigEndian == (std::endian::native == std::endian::little))
            std::reverse(raw.begin(), raw.end());
        return std::bit_cast<T>(raw);
    }
    // Words of four bytes, from 1 on as the format's description counts them.
    std::int32_t word(std::size_t number) const { return at<std::int32_t>(4 * (number - 1)); }
    double real(std::size_t number) const { return at<float>(4 * (number - 1)); }
};

struct Mode {
    int mode;
    FileType type;
    int values = 1;
    const char* name = nullptr; ///< if fileTypeName will not do
};
constexpr Mode kModes[] = {{0, FileType::I8},
                           {1, FileType::I16},
                           {2, FileType::F32},
                           {3, FileType::I16, 2, "complex int16"},
                           {4, FileType::F32, 2, "complex64"},
                           {6, FileType::U16},
                           {12, FileType::F16},
                           {16, FileType::U8, 3}};

struct Map {
    Header header;
    Mode mode{};
    bool isPacked = false;
    std::uint64_t dataOffset = 0;
    std::uint64_t sampleBytes = 0;
    VolumeField field;
};

bool isPlausible(const Header& header) {
    for (std::size_t number = 1; number <= 3; ++number)
        if (header.word(number) < 1 || header.word(number) > kMaxDim)
            return false;
    return header.word(4) >= 0 && header.word(4) <= 127;
}

// The stamp is left out or wrong in many files; sizes that are possible in one order only decide first.
Result<Header> readHeader(const fs::path& path, bool isPacked) {
    auto text = isPacked ? inflateStart(path, kHeaderBytes) : [&]() -> Result<std::vector<std::byte>> {
        auto start = readStart(path, kHeaderBytes);
        if (!start.isOk())
            return std::move(start).error();
        const auto bytes = std::as_bytes(std::span(start.value()));
        return std::vector<std::byte>(bytes.begin(), bytes.end());
    }();
    if (!text.isOk())
        return std::move(text).error();
    if (text.value().size() < kHeaderBytes)
        return makeError(ErrorCode::InvalidArgument, "is not an MRC map: shorter than its header of 1024 bytes", path);
    Header header;
    std::copy(text.value().begin(), text.value().end(), header.bytes.begin());
    header.isBigEndian = header.bytes[212] == std::byte{0x11};
    if (!isPlausible(header)) {
        const bool stamped = header.isBigEndian;
        header.isBigEndian = !stamped;
        if (!isPlausible(header))
            header.isBigEndian = stamped;
    }
    return header;
}

Result<Mode> readMode(const Header& header, const fs::path& path) {
    const int mode = header.word(4);
    for (const Mode& known : kModes) {
        if (known.mode != mode)
            continue;
        // IMOD reports it where bytes have no sign.
        const bool isUnsigned = mode == 0 && header.word(39) == 1146047817 && (header.word(40) & 1) == 0;
        return isUnsigned ? Mode{0, FileType::U8} : known;
    }
    return refuseField("mode", std::to_string(mode) + " is not a type of samples that is read", path);
}

// Stacks of volumes have a space group from 401 on and mz sections in each.
Result<std::int64_t> readVolumeCount(const Header& header, const fs::path& path) {
    const std::int32_t sections = header.word(3), perVolume = header.word(10);
    if (header.word(23) < 401 || perVolume == sections)
        return std::int64_t{1};
    if (perVolume < 1 || sections % perVolume != 0)
        return refuseField("mz",
                           std::to_string(perVolume) + " does not divide the " + std::to_string(sections) +
                               " sections of a stack of volumes",
                           path);
    return std::int64_t{sections / perVolume};
}

Result<std::array<int, 3>> readAxes(const Header& header, const fs::path& path) {
    std::array<int, 3> axes{header.word(17), header.word(18), header.word(19)};
    if (axes == std::array{0, 0, 0}) // not filled in
        axes = {1, 2, 3};
    std::array<int, 3> sorted = axes;
    std::sort(sorted.begin(), sorted.end());
    if (sorted != std::array{1, 2, 3})
        return refuseField("mapc, mapr, maps",
                           std::to_string(axes[0]) + " " + std::to_string(axes[1]) + " " + std::to_string(axes[2]) +
                               " are not the axes 1 to 3 in some order",
                           path);
    return axes;
}

/// Lengths are known; else a spacing is assumed.
bool hasCell(const Header& header) {
    return header.real(11) > 0.0f && header.real(12) > 0.0f && header.real(13) > 0.0f;
}

/// Edges of the unit cell as columns, in angstrom: the first along x, the second in the plane of x and y.
Result<glm::dmat3> readCell(const Header& header, std::vector<std::string>& notes, const fs::path& path) {
    glm::dvec3 lengths(header.real(11), header.real(12), header.real(13));
    glm::dvec3 angles(header.real(14), header.real(15), header.real(16));
    for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(lengths[axis]) || lengths[axis] < 0.0 || !std::isfinite(angles[axis]))
            return refuseField("cell", "its lengths or angles are not positive numbers", path);
        if (lengths[axis] == 0.0) {
            lengths[axis] = header.word(8 + static_cast<std::size_t>(axis)) > 0
                                ? header.word(8 + static_cast<std::size_t>(axis))
                                : 1;
            notes.push_back("the cell has no length along " + std::string(1, static_cast<char>('x' + axis)) +
                            "; a spacing is assumed");
        }
    }
    if (angles == glm::dvec3(0.0))
        angles = glm::dvec3(90.0);
    if (angles == glm::dvec3(90.0)) // exactly, without the rounding of cosines
        return glm::dmat3(glm::dvec3(lengths.x, 0, 0), glm::dvec3(0, lengths.y, 0), glm::dvec3(0, 0, lengths.z));
    const glm::dvec3 cosines = glm::cos(glm::radians(angles));
    const double sine = std::sin(glm::radians(angles.z));
    const double y = (cosines.x - cosines.y * cosines.z) / sine;
    const double square = 1.0 - cosines.y * cosines.y - y * y;
    if (!(sine > 1e-6) || !(square > 1e-12))
        return refuseField("cell", "its angles do not span space", path);
    return glm::dmat3(glm::dvec3(lengths.x, 0, 0), lengths.y * glm::dvec3(cosines.z, sine, 0),
                      lengths.z * glm::dvec3(cosines.y, y, std::sqrt(square)));
}

Result<GridGeometry> readGeometry(const Map& map, std::vector<std::string>& notes, const fs::path& path) {
    const Header& header = map.header;
    const auto axes = readAxes(header, path);
    if (!axes.isOk())
        return axes.error();
    auto cell = readCell(header, notes, path);
    if (!cell.isOk())
        return std::move(cell).error();
    for (int axis = 0; axis < 3; ++axis) { // from edges of the cell to steps between samples
        std::int32_t intervals = header.word(8 + static_cast<std::size_t>(axis));
        if (intervals < 1) {
            const auto place = std::find(axes.value().begin(), axes.value().end(), axis + 1) - axes.value().begin();
            intervals = static_cast<std::int32_t>(map.field.dims[static_cast<std::size_t>(place)]);
            notes.push_back("the number of intervals along " + std::string(1, static_cast<char>('x' + axis)) +
                            " is missing; that of samples is taken");
        }
        cell.value()[axis] /= static_cast<double>(intervals);
    }
    GridGeometry geometry;
    geometry.dims = map.field.dims;
    glm::dvec3 start(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 step = cell.value()[axes.value()[static_cast<std::size_t>(axis)] - 1];
        geometry.spacing[axis] = glm::length(step);
        geometry.direction[axis] = step / geometry.spacing[axis];
        start += static_cast<double>(header.word(5 + static_cast<std::size_t>(axis))) * step;
    }
    // Electron microscopy writes an origin in angstrom, crystallography the number of the first sample.
    const glm::dvec3 origin(header.real(50), header.real(51), header.real(52));
    const bool hasOrigin = origin != glm::dvec3(0.0) && std::isfinite(origin.x + origin.y + origin.z);
    geometry.origin = hasOrigin ? origin : start;
    return geometry;
}

Result<Map> describe(const fs::path& path) {
    Map map;
    map.isPacked = lowerCase(path.filename().string()).ends_with(".gz");
    auto header = readHeader(path, map.isPacked);
    if (!header.isOk())
        return std::move(header).error();
    map.header = header.value();
    const std::array<std::int64_t, 3> sizes{map.header.word(1), map.header.word(2), map.header.word(3)};
    auto dims = checkDims(sizes, "nx, ny, nz", path);
    if (!dims.isOk())
        return std::move(dims).error();
    const auto mode = readMode(map.header, path);
    if (!mode.isOk())
        return mode.error();
    map.mode = mode.value();
    const std::int32_t extended = map.header.word(24);
    if (extended < 0)
        return refuseField("nsymbt", std::to_string(extended) + " is not a number of bytes", path);
    map.dataOffset = kHeaderBytes + static_cast<std::uint64_t>(extended);
    map.sampleBytes = static_cast<std::uint64_t>(pointCount(dims.value())) *
                      static_cast<std::uint64_t>(map.mode.values) * fileTypeSizeBytes(map.mode.type);
    const auto volumes = readVolumeCount(map.header, path);
    if (!volumes.isOk())
        return volumes.error();
    map.field.dims = dims.value();
    map.field.dims[2] /= volumes.value();
    map.field.frames = volumes.value();
    map.field.components = map.mode.values;
    if (map.mode.values == 2)
        map.field.componentNames = {"real", "imaginary"};
    else if (map.mode.values == 3)
        map.field.componentNames = {"red", "green", "blue"};
    map.field.typeName = map.mode.name != nullptr ? std::string_view(map.mode.name) : fileTypeName(map.mode.type);
    return map;
}

Result<std::unique_ptr<ByteStream>> openBytes(const Map& map, const fs::path& path, const ReadOptions& options) {
    if (map.isPacked)
        return openEncoded({{path, 0}}, map.sampleBytes,
                           {Encoding::Deflate, FileType::U8, map.dataOffset, options.allowsTrailing,
                            planeBytes(map.field, map.mode.type)});
    return openParts({{path, map.dataOffset}}, map.sampleBytes);
}

Status noteTrailing(const Map& map, const fs::path& path, std::vector<std::string>& notes) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    if (!map.isPacked && file.value()->sizeBytes() > map.dataOffset + map.sampleBytes)
        notes.push_back("the file is longer than the samples; the rest is ignored");
    return {};
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openMrc(const fs::path& path, const ReadOptions& options) {
    const auto described = describe(path);
    if (!described.isOk())
        return described.error();
    const Map& map = described.value();
    auto bytes = openBytes(map, path, options);
    if (!bytes.isOk())
        return std::move(bytes).error();
    const auto choice = chooseInOnlyField(map.field, options, path);
    if (!choice.isOk())
        return choice.error();
    VolumeInfo info;
    info.format = "MRC";
    const auto geometry = readGeometry(map, info.notes, path);
    if (!geometry.isOk())
        return geometry.error();
    info.geometry = geometry.value();
    if (hasCell(map.header))
        info.lengthUnit = "Å";
    ISO_TRY(checkGeometry(info.geometry, "cell", path));
    ISO_TRY(noteTrailing(map, path, info.notes));
    SampleLayout layout{map.mode.type,   map.header.isBigEndian,   std::nullopt,
                        map.mode.values, choice.value().component, 0};
    layout.firstValue = static_cast<std::uint64_t>(choice.value().frame * pointCount(map.field.dims)) *
                        static_cast<std::uint64_t>(map.mode.values);
    return makeSampleSource(std::move(info), layout, std::move(bytes).value(), path);
}

Result<VolumeContents> listMrc(const fs::path& path, const ReadOptions& options) {
    auto map = describe(path);
    if (!map.isOk())
        return std::move(map).error();
    const auto bytes = openBytes(map.value(), path, options);
    if (!bytes.isOk())
        return bytes.error();
    VolumeContents contents;
    contents.format = "MRC";
    contents.fields.push_back(std::move(map.value().field));
    return contents;
}

} // namespace isoslider::io
