#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <string_view>

#include "core/base/file_system.h"
#include "core/mesh/mesh_import.h"

// OpenMesh reads STL too, but drops triangles whose corners coincide: a check has to see them.

namespace isoslider::mesh {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50; // normal, three corners, 16 bits of attributes
constexpr std::uint64_t kMaxTextBytes = std::uint64_t{4} << 30;

std::uint32_t littleEndian32(const std::byte* bytes) {
    std::uint32_t value = 0;
    for (int i = 3; i >= 0; --i)
        value = value << 8 | std::to_integer<std::uint32_t>(bytes[i]);
    return value;
}

Status addTriangle(TriangleSoup& soup, const std::array<glm::dvec3, 3>& corners,
                   const std::filesystem::path& path) {
    if (soup.positions.size() > std::numeric_limits<std::uint32_t>::max() - 3)
        return makeError(ErrorCode::InvalidArgument, "has more than 2^32 corners", path);
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    soup.positions.insert(soup.positions.end(), corners.begin(), corners.end());
    soup.triangles.push_back({first, first + 1, first + 2});
    return {};
}

Result<TriangleSoup> readBinary(const RandomAccessFile& file, std::uint32_t count) {
    TriangleSoup soup;
    soup.positions.reserve(std::size_t{3} * count);
    soup.triangles.reserve(count);
    constexpr std::size_t kBatch = 20000;
    std::vector<std::byte> bytes;
    for (std::size_t begin = 0; begin < count; begin += kBatch) {
        const std::size_t inBatch = std::min<std::size_t>(kBatch, count - begin);
        bytes.resize(inBatch * kTriangleBytes);
        ISO_TRY(file.readExactlyAt(kHeaderBytes + begin * kTriangleBytes, bytes));
        for (std::size_t t = 0; t < inBatch; ++t) {
            std::array<glm::dvec3, 3> corners;
            for (int i = 0; i < 9; ++i)
                corners[static_cast<std::size_t>(i / 3)][i % 3] = std::bit_cast<float>(
                    littleEndian32(bytes.data() + t * kTriangleBytes + 12 + 4 * static_cast<std::size_t>(i)));
            ISO_TRY(addTriangle(soup, corners, file.path()));
        }
    }
    return soup;
}

std::string_view nextWord(std::string_view& text) {
    constexpr std::string_view kBlanks = " \t\r\n";
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
    text.remove_prefix(word.size());
    return word;
}

Result<TriangleSoup> readText(std::string_view text, const std::filesystem::path& path) {
    TriangleSoup soup;
    std::array<glm::dvec3, 3> corners;
    std::size_t corner = 0;
    bool hasEnd = false;
    for (std::string_view word = nextWord(text); !word.empty(); word = nextWord(text)) {
        hasEnd = hasEnd || word == "endsolid";
        if (word != "vertex")
            continue;
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view number = nextWord(text);
            const char* begin = number.data() + (number.starts_with('+') ? 1 : 0);
            const auto [end, problem] = std::from_chars(begin, number.data() + number.size(), corners[corner][axis]);
            if (problem != std::errc{} || end != number.data() + number.size())
                return makeError(ErrorCode::InvalidArgument,
                                 "vertex: '" + std::string(number.substr(0, 40)) + "' is not a number", path);
        }
        if (++corner == 3) {
            ISO_TRY(addTriangle(soup, corners, path));
            corner = 0;
        }
    }
    if (!hasEnd || corner != 0)
        return makeError(ErrorCode::Corruption, "file ends early: no endsolid line", path);
    return soup;
}

Result<TriangleSoup> readEither(const RandomAccessFile& file) {
    const std::uint64_t size = file.sizeBytes();
    std::array<std::byte, kHeaderBytes> header{};
    auto got = file.readAt(0, header);
    if (!got.isOk())
        return std::move(got).error();
    // Some binary files begin with "solid" as well: the length decides first.
    const std::uint32_t count = littleEndian32(header.data() + 80);
    if (size >= kHeaderBytes && size == kHeaderBytes + std::uint64_t{count} * kTriangleBytes)
        return readBinary(file, count);
    if (std::memcmp(header.data(), "solid", 5) == 0) {
        auto bytes = readWholeFile(file.path(), kMaxTextBytes);
        if (!bytes.isOk())
            return std::move(bytes).error();
        return readText({reinterpret_cast<const char*>(bytes.value().data()), bytes.value().size()}, file.path());
    }
    if (size < kHeaderBytes)
        return makeError(ErrorCode::InvalidArgument, "is not an STL file: shorter than its header", file.path());
    return makeError(ErrorCode::Corruption,
                     "triangle count " + std::to_string(count) + " asks for " +
                         std::to_string(kHeaderBytes + std::uint64_t{count} * kTriangleBytes) +
                         " bytes, the file has " + std::to_string(size),
                     file.path(), 80);
}

} // namespace

Result<TriangleSoup> readStl(const std::filesystem::path& path) {
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    auto soup = readEither(*file.value());
    if (soup.isOk())
        weldEqualPositions(soup.value());
    return soup;
}

} // namespace isoslider::mesh
