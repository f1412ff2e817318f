#include "core/mesh/mesh_writers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>

#include <glm/geometric.hpp>

// Not OpenMesh's writers: those round positions to float, print to the standard error stream, and
// need a halfedge mesh first.

namespace isoslider::mesh {
namespace {

static_assert(std::endian::native == std::endian::little, "binary formats are written as they lie in memory");

/// Collects small pieces into large writes.
class Output {
public:
    Output(AtomicFile& file, std::uint64_t records, const JobControl& job) : file_(file), records_(records), job_(job) {
        buffer_.reserve(kFlushBytes + 1024);
    }

    void text(std::string_view piece) { buffer_ += piece; }

    template <class Number>
    void number(Number value) {
        char digits[40];
        const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
        buffer_.append(digits, end);
    }

    template <class Number>
    void binary(Number value) {
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        buffer_.append(bytes, sizeof value);
    }

    /// To be called after every record, so that the buffer stays small.
    Status endRecord() {
        ++done_;
        return buffer_.size() < kFlushBytes ? Status() : flush();
    }
    Status flush() {
        if (job_.isStopRequested())
            return cancelledError();
        ISO_TRY(file_.writeAll(std::as_bytes(std::span(buffer_))));
        unsynced_ += buffer_.size();
        buffer_.clear();
        if (unsynced_ >= kSyncBytes) {
            ISO_TRY(file_.sync());
            unsynced_ = 0;
        }
        job_.report(static_cast<double>(done_) / static_cast<double>(std::max<std::uint64_t>(1, records_)), "writing");
        return {};
    }

private:
    static constexpr std::size_t kFlushBytes = std::size_t{1} << 20;
    AtomicFile& file_;
    std::uint64_t records_; ///< in all
    const JobControl& job_;
    std::uint64_t done_ = 0, unsynced_ = 0;
    std::string buffer_;
};

template <class Vector>
void putText(Output& out, const Vector& v, Precision precision) {
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0)
            out.text(" ");
        if (precision == Precision::Float)
            out.number(static_cast<float>(v[axis]));
        else
            out.number(v[axis]);
    }
}

template <class Vector>
void putBinary(Output& out, const Vector& v, Precision precision) {
    for (int axis = 0; axis < 3; ++axis) {
        if (precision == Precision::Float)
            out.binary(static_cast<float>(v[axis]));
        else
            out.binary(v[axis]);
    }
}

std::string plyHeader(const TriangleSoup& soup, Precision precision, Comments comments) {
    const std::string type = precision == Precision::Float ? "float" : "double";
    std::string header = "ply\nformat binary_little_endian 1.0\n";
    for (const std::string& comment : comments)
        header += "comment " + comment + "\n";
    header += "element vertex " + std::to_string(soup.positions.size()) + "\n";
    for (const char* name : {"x", "y", "z"})
        header += "property " + type + " " + name + "\n";
    if (!soup.normals.empty())
        header += "property float nx\nproperty float ny\nproperty float nz\n";
    return header + "element face " + std::to_string(soup.triangles.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
}

void putComments(Output& out, Comments comments) {
    for (const std::string& comment : comments) {
        out.text("# ");
        out.text(comment);
        out.text("\n");
    }
}

} // namespace

Status writePly(const TriangleSoup& soup, Precision precision, Comments comments, AtomicFile& file,
                const JobControl& job) {
    Output out(file, soup.positions.size() + soup.triangles.size(), job);
    out.text(plyHeader(soup, precision, comments));
    for (std::size_t i = 0; i < soup.positions.size(); ++i) {
        putBinary(out, soup.positions[i], precision);
        if (!soup.normals.empty())
            putBinary(out, soup.normals[i], Precision::Float);
        ISO_TRY(out.endRecord());
    }
    for (const Triangle& triangle : soup.triangles) {
        out.binary(std::uint8_t{3});
        for (const std::uint32_t vertex : triangle)
            out.binary(vertex);
        ISO_TRY(out.endRecord());
    }
    return out.flush();
}

Status writeObj(const TriangleSoup& soup, Precision precision, Comments comments, AtomicFile& file,
                const JobControl& job) {
    Output out(file, soup.positions.size() + soup.normals.size() + soup.triangles.size(), job);
    putComments(out, comments);
    for (const glm::dvec3& position : soup.positions) {
        out.text("v ");
        putText(out, position, precision);
        out.text("\n");
        ISO_TRY(out.endRecord());
    }
    for (const glm::vec3& normal : soup.normals) {
        out.text("vn ");
        putText(out, normal, Precision::Float);
        out.text("\n");
        ISO_TRY(out.endRecord());
    }
    for (const Triangle& triangle : soup.triangles) {
        out.text("f");
        for (const std::uint32_t vertex : triangle) {
            out.text(" ");
            out.number(std::uint64_t{vertex} + 1);
            if (!soup.normals.empty()) {
                out.text("//");
                out.number(std::uint64_t{vertex} + 1);
            }
        }
        out.text("\n");
        ISO_TRY(out.endRecord());
    }
    return out.flush();
}

Status writeOff(const TriangleSoup& soup, Precision precision, Comments comments, AtomicFile& file,
                const JobControl& job) {
    Output out(file, soup.positions.size() + soup.triangles.size(), job);
    out.text(soup.normals.empty() ? "OFF\n" : "NOFF\n");
    out.number(soup.positions.size());
    out.text(" ");
    out.number(soup.triangles.size());
    out.text(" 0\n");
    for (std::size_t i = 0; i < soup.positions.size(); ++i) {
        putText(out, soup.positions[i], precision);
        if (!soup.normals.empty()) {
            out.text(" ");
            putText(out, soup.normals[i], Precision::Float);
        }
        out.text("\n");
        ISO_TRY(out.endRecord());
    }
    for (const Triangle& triangle : soup.triangles) {
        out.text("3");
        for (const std::uint32_t vertex : triangle) {
            out.text(" ");
            out.number(vertex);
        }
        out.text("\n");
        ISO_TRY(out.endRecord());
    }
    putComments(out, comments); // last: OpenMesh, for one, knows no comments among the numbers
    return out.flush();
}

Status writeStl(const TriangleSoup& soup, std::string header, AtomicFile& file, const JobControl& job) {
    Output out(file, soup.triangles.size(), job);
    header.resize(kStlHeaderBytes, ' ');
    out.text(header);
    out.binary(static_cast<std::uint32_t>(soup.triangles.size()));
    for (const Triangle& t : soup.triangles) {
        const glm::dvec3 doubled =
            glm::cross(soup.positions[t[1]] - soup.positions[t[0]], soup.positions[t[2]] - soup.positions[t[0]]);
        const double length = glm::length(doubled);
        putBinary(out, length > 0.0 ? doubled / length : glm::dvec3(0.0), Precision::Float);
        for (const std::uint32_t vertex : t)
            putBinary(out, soup.positions[vertex], Precision::Float);
        out.binary(std::uint16_t{0});
        ISO_TRY(out.endRecord());
    }
    return out.flush();
}

} // namespace isoslider::mesh
