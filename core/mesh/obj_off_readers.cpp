#include <limits>
#include <vector>

#include "core/base/plain_text.h"
#include "core/mesh/loop_control.h"
#include "core/mesh/mesh_readers.h"
#include "core/mesh/text_scan.h"

namespace isoslider::mesh {
namespace {

Error refuseLine(std::size_t number, std::string_view problem, const std::filesystem::path& path) {
    return makeError(ErrorCode::InvalidArgument, "line " + std::to_string(number) + ": " + std::string(problem), path);
}

bool parsePosition(std::string_view& line, glm::dvec3& out) {
    for (int axis = 0; axis < 3; ++axis)
        if (!parseNumber(nextWord(line), out[axis]))
            return false;
    return true;
}

/// Lines that state something, with comments cut off.
class Lines {
public:
    explicit Lines(std::string_view text) : rest_(text) {}
    std::size_t number() const { return number_; }
    std::size_t remaining() const { return rest_.size(); }
    bool next(std::string_view& line) {
        while (nextLine(rest_, line)) {
            ++number_;
            line = line.substr(0, line.find('#'));
            if (line.find_first_not_of(" \t\r") != std::string_view::npos)
                return true;
        }
        return false;
    }

private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

bool isOffMark(std::string_view word) {
    // ST texture, C colour, N normals, 4 and n other dimensions: those two are not meshes in space.
    for (const std::string_view prefix : {"ST", "C", "N"})
        if (word.starts_with(prefix) && word.size() > 3)
            word.remove_prefix(prefix.size());
    return word == "OFF";
}

} // namespace

Status addPolygon(TriangleSoup& soup, std::span<const std::int64_t> corners, const std::filesystem::path& path) {
    for (const std::int64_t corner : corners)
        if (corner < 0 || corner > std::numeric_limits<std::uint32_t>::max())
            return makeError(ErrorCode::InvalidArgument,
                             "a face names vertex " + std::to_string(corner) + ", which cannot be", path);
    for (std::size_t i = 2; i < corners.size(); ++i)
        soup.triangles.push_back({static_cast<std::uint32_t>(corners[0]), static_cast<std::uint32_t>(corners[i - 1]),
                                  static_cast<std::uint32_t>(corners[i])});
    return {};
}

Status checkIndices(const TriangleSoup& soup, const std::filesystem::path& path) {
    for (std::size_t t = 0; t < soup.triangles.size(); ++t)
        for (const std::uint32_t vertex : soup.triangles[t])
            if (vertex >= soup.positions.size())
                return makeError(ErrorCode::InvalidArgument,
                                 "triangle " + std::to_string(t) + " names vertex " + std::to_string(vertex) + " of " +
                                     std::to_string(soup.positions.size()),
                                 path);
    return {};
}

Result<TriangleSoup> readObj(std::string_view bytes, const std::filesystem::path& path, const JobControl& job) {
    TriangleSoup soup;
    Lines lines(bytes);
    std::string_view line;
    std::vector<std::int64_t> corners;
    bool hasWords = false, isObj = false;
    LoopControl loop(job, bytes.size(), "reading");
    while (lines.next(line)) {
        if (!loop.goesOn(bytes.size() - lines.remaining()))
            return cancelledError();
        hasWords = true;
        const std::string_view key = nextWord(line);
        glm::dvec3 position;
        if (key == "v") {
            if (!parsePosition(line, position))
                return refuseLine(lines.number(), "v: three numbers expected", path);
            soup.positions.push_back(position);
        } else if (key == "f") {
            corners.clear();
            for (auto word = nextWord(line); !word.empty(); word = nextWord(line)) {
                std::int64_t index = 0;
                if (!parseNumber(word.substr(0, word.find('/')), index) || index == 0)
                    return refuseLine(lines.number(), "f: " + inQuotes(word) + " is not a vertex", path);
                // Counted from 1; negative ones back from the latest vertex.
                corners.push_back(index > 0 ? index - 1 : static_cast<std::int64_t>(soup.positions.size()) + index);
            }
            ISO_TRY(addPolygon(soup, corners, path));
        }
        isObj = isObj || key == "v" || key == "vn" || key == "o" || key == "g" || key == "mtllib";
    }
    if (hasWords && !isObj) // comments alone are a mesh without vertices
        return makeError(ErrorCode::InvalidArgument, "is not a readable obj mesh: it has no vertex", path);
    ISO_TRY(checkIndices(soup, path));
    return soup;
}

Result<TriangleSoup> readOff(std::string_view bytes, const std::filesystem::path& path, const JobControl& job) {
    TriangleSoup soup;
    Lines lines(bytes);
    std::string_view line;
    if (!lines.next(line) || !isOffMark(nextWord(line)))
        return makeError(ErrorCode::InvalidArgument, "is not a readable off mesh: 'OFF' expected in its first line",
                         path);
    std::string_view word = nextWord(line);
    if (word.empty() && lines.next(line))
        word = nextWord(line);
    std::uint64_t vertices = 0, faces = 0;
    if (!parseNumber(word, vertices) || !parseNumber(nextWord(line), faces))
        return refuseLine(lines.number(), "numbers of vertices and faces expected in the header", path);
    if (vertices > bytes.size() || faces > bytes.size())
        return makeError(ErrorCode::InvalidArgument,
                         "the header asks for more vertices or faces than the file can hold", path);
    LoopControl loop(job, vertices + faces, "reading");
    for (std::uint64_t i = 0; i < vertices; ++i) {
        if (!loop.goesOn(i))
            return cancelledError();
        glm::dvec3 position;
        if (!lines.next(line))
            return makeError(ErrorCode::Corruption, "file ends early: vertex " + std::to_string(i) + " is missing",
                             path);
        if (!parsePosition(line, position))
            return refuseLine(lines.number(), "three numbers expected", path);
        soup.positions.push_back(position);
    }
    std::vector<std::int64_t> corners;
    for (std::uint64_t i = 0; i < faces; ++i) {
        if (!loop.goesOn(vertices + i))
            return cancelledError();
        std::uint64_t count = 0;
        if (!lines.next(line))
            return makeError(ErrorCode::Corruption, "file ends early: face " + std::to_string(i) + " is missing", path);
        if (!parseNumber(nextWord(line), count) || count > line.size())
            return refuseLine(lines.number(), "a number of corners expected", path);
        corners.assign(count, 0);
        for (std::int64_t& corner : corners)
            if (!parseNumber(nextWord(line), corner))
                return refuseLine(lines.number(), std::to_string(count) + " corners expected", path);
        ISO_TRY(addPolygon(soup, corners, path));
    }
    ISO_TRY(checkIndices(soup, path));
    return soup;
}

} // namespace isoslider::mesh
