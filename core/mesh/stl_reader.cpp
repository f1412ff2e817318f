#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "core/base/plain_text.h"
#include "core/mesh/loop_control.h"
#include "core/mesh/mesh_readers.h"
#include "core/mesh/text_scan.h"

namespace isoslider::mesh {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50; // normal, three corners, 16 bits of attributes

std::uint32_t littleEndian32(std::string_view bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;)
        value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
}

Status addTriangle(TriangleSoup& soup, const std::array<glm::dvec3, 3>& corners, const std::filesystem::path& path) {
    if (soup.positions.size() > std::numeric_limits<std::uint32_t>::max() - 3)
        return makeError(ErrorCode::InvalidArgument, "has more than 2^32 corners", path);
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    soup.positions.insert(soup.positions.end(), corners.begin(), corners.end());
    soup.triangles.push_back({first, first + 1, first + 2});
    return {};
}

Result<TriangleSoup> readBinary(std::string_view bytes, std::uint32_t count, const std::filesystem::path& path,
                                const JobControl& job) {
    TriangleSoup soup;
    soup.positions.reserve(std::size_t{3} * count);
    soup.triangles.reserve(count);
    LoopControl loop(job, count, "reading");
    for (std::size_t t = 0; t < count; ++t) {
        if (!loop.goesOn(t))
            return cancelledError();
        const std::string_view triangle = bytes.substr(kHeaderBytes + t * kTriangleBytes, kTriangleBytes);
        std::array<glm::dvec3, 3> corners;
        for (std::size_t i = 0; i < 9; ++i)
            corners[i / 3][static_cast<int>(i % 3)] =
                static_cast<double>(std::bit_cast<float>(littleEndian32(triangle.substr(12 + 4 * i))));
        ISO_TRY(addTriangle(soup, corners, path));
    }
    return soup;
}

Result<TriangleSoup> readText(std::string_view text, const std::filesystem::path& path, const JobControl& job) {
    TriangleSoup soup;
    std::array<glm::dvec3, 3> corners;
    std::size_t corner = 0;
    bool hasEnd = false;
    const std::size_t bytes = text.size();
    LoopControl loop(job, bytes, "reading");
    for (std::string_view word = nextWord(text); !word.empty(); word = nextWord(text)) {
        if (!loop.goesOn(bytes - text.size()))
            return cancelledError();
        hasEnd = hasEnd || word == "endsolid";
        if (word != "vertex")
            continue;
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view number = nextWord(text);
            if (!parseNumber(number, corners[corner][axis]))
                return makeError(ErrorCode::InvalidArgument, "vertex: " + inQuotes(number) + " is not a number", path);
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

Result<TriangleSoup> readEither(std::string_view bytes, const std::filesystem::path& path, const JobControl& job) {
    // Some binary files begin with "solid" as well: the length decides first.
    const std::uint32_t count = bytes.size() >= kHeaderBytes ? littleEndian32(bytes.substr(80)) : 0;
    const std::uint64_t wanted = kHeaderBytes + std::uint64_t{count} * kTriangleBytes;
    if (bytes.size() == wanted)
        return readBinary(bytes, count, path, job);
    if (bytes.starts_with("solid"))
        return readText(bytes, path, job);
    if (bytes.size() < kHeaderBytes)
        return makeError(ErrorCode::InvalidArgument, "is not an STL file: shorter than its header", path);
    return makeError(ErrorCode::Corruption,
                     "triangle count " + std::to_string(count) + " asks for " + std::to_string(wanted) +
                         " bytes, the file has " + std::to_string(bytes.size()),
                     path, 80);
}

} // namespace

Result<TriangleSoup> readStl(std::string_view bytes, const std::filesystem::path& path, const JobControl& job) {
    const JobControl reading = job.part(0.0, 0.4);
    auto soup = readEither(bytes, path, reading);
    if (soup.isOk()) {
        job.report(0.4, "welding");
        ISO_TRY(weldEqualPositions(soup.value(), job));
    }
    return soup;
}

} // namespace isoslider::mesh
