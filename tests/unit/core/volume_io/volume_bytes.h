#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <bzlib.h>
#include <zlib.h>

// Volume files as byte strings, small and sound; tests damage them.

namespace isoslider::test {

/// 0, 1, 2, ... as samples of type T.
template <class T>
std::string ramp(std::size_t count) {
    std::string bytes(count * sizeof(T), '\0');
    for (std::size_t i = 0; i < count; ++i) {
        const T value = static_cast<T>(i);
        std::memcpy(bytes.data() + i * sizeof(T), &value, sizeof(T));
    }
    return bytes;
}

/// `from` replaced by `to`, once; the test is wrong if it is not there.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    if (at == std::string::npos)
        return "TEST ERROR: no '" + from + "' to replace";
    return text.replace(at, from.size(), to);
}

/// gzip (windowBits 31) or zlib (15).
inline std::string packed(const std::string& bytes, int windowBits) {
    z_stream stream{};
    ::deflateInit2(&stream, 9, Z_DEFLATED, windowBits, 9, Z_DEFAULT_STRATEGY);
    std::string out(::deflateBound(&stream, bytes.size()) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    ::deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    ::deflateEnd(&stream);
    return out;
}
inline std::string bzipped(const std::string& bytes) {
    std::string out(bytes.size() + bytes.size() / 100 + 600, '\0');
    auto size = static_cast<unsigned>(out.size());
    ::BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(bytes.data()), static_cast<unsigned>(bytes.size()),
                               9, 0, 0);
    out.resize(size);
    return out;
}
inline std::string gzipped(const std::string& bytes) { return packed(bytes, 31); }

/// `block` so many times as one gzip stream, packed only once: each repetition begins with nothing to look back to.
inline std::string gzippedRepeats(const std::string& block, int times) {
    z_stream stream{};
    ::deflateInit2(&stream, 9, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY);
    std::string once(::deflateBound(&stream, block.size()) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(block.data()));
    stream.avail_in = static_cast<uInt>(block.size());
    stream.next_out = reinterpret_cast<Bytef*>(once.data());
    stream.avail_out = static_cast<uInt>(once.size());
    ::deflate(&stream, Z_FULL_FLUSH);
    once.resize(stream.total_out);
    ::deflateEnd(&stream);
    const auto blockChecksum =
        ::crc32(0, reinterpret_cast<const Bytef*>(block.data()), static_cast<uInt>(block.size()));
    uLong checksum = 0;
    std::string out("\x1f\x8b\x08\0\0\0\0\0\0\xff", 10);
    for (int i = 0; i < times; ++i) {
        out += once;
        checksum = ::crc32_combine(checksum, blockChecksum, static_cast<z_off_t>(block.size()));
    }
    out += std::string("\x03\0", 2); // an empty last block
    const auto total = static_cast<std::uint32_t>(block.size() * static_cast<std::size_t>(times));
    for (const auto word : {static_cast<std::uint32_t>(checksum), total})
        for (int shift = 0; shift < 32; shift += 8)
            out += static_cast<char>(word >> shift & 255);
    return out;
}

/// 4 x 3 x 2 of i16, spacing 1 2 3.
inline std::string mhaHeader(const std::string& dataFile = "LOCAL") {
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
           "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 1 2 3\nDimSize = 4 3 2\n"
           "ElementType = MET_SHORT\nElementDataFile = " +
           dataFile + "\n";
}
inline std::string mha() { return mhaHeader() + ramp<std::int16_t>(24); }

inline std::string nrrdHeader() {
    return "NRRD0004\n# comment\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 3 2\n"
           "space directions: (1,0,0) (0,2,0) (0,0,3)\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
           "space origin: (10,20,30)\n";
}
inline std::string nrrd() { return nrrdHeader() + "\n" + ramp<std::int16_t>(24); }

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// Header of a single-file NIfTI-1, 352 bytes; its sform puts voxel (0, 0, 0) at RAS (-10, -20, 30).
inline std::string niftiHeader() {
    std::string h(352, '\0');
    put<std::int32_t>(h, 0, 348);
    const std::int16_t dim[8] = {3, 4, 3, 2, 1, 1, 1, 1};
    std::memcpy(h.data() + 40, dim, sizeof dim);
    put<std::int16_t>(h, 70, 4); // i16
    put<std::int16_t>(h, 72, 16);
    const float pixdim[8] = {1, 1, 2, 3, 1, 1, 1, 1};
    std::memcpy(h.data() + 76, pixdim, sizeof pixdim);
    put<float>(h, 108, 352);
    h[123] = 2; // millimetres
    put<std::int16_t>(h, 254, 1); // sform
    const float sform[12] = {1, 0, 0, -10, 0, 2, 0, -20, 0, 0, 3, 30};
    std::memcpy(h.data() + 280, sform, sizeof sform);
    std::memcpy(h.data() + 344, "n+1", 4);
    return h;
}
inline std::string nifti() { return niftiHeader() + ramp<std::int16_t>(24); }
template <class T>
std::string niftiWith(std::size_t at, T value) {
    std::string bytes = nifti();
    put(bytes, at, value);
    return bytes;
}

inline std::string vti() {
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
        "<ImageData WholeExtent=\"0 3 0 2 0 1\" Origin=\"10 20 30\" Spacing=\"1 2 3\">\n"
        "<Piece Extent=\"0 3 0 2 0 1\">\n<PointData Scalars=\"s\">\n"
        "<DataArray type=\"Int16\" Name=\"s\" format=\"ascii\">\n";
    for (int i = 0; i < 24; ++i)
        text += std::to_string(i) + " ";
    return text + "\n</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n";
}

/// Appended raw data; `announced` is the byte count that its block begins with.
inline std::string vtiAppended(const std::string& offset, std::uint32_t announced) {
    std::string block(4, '\0');
    put(block, 0, announced);
    return "<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
           "<ImageData WholeExtent=\"0 3 0 2 0 1\" Origin=\"10 20 30\" Spacing=\"1 2 3\">\n"
           "<Piece Extent=\"0 3 0 2 0 1\"><PointData Scalars=\"s\">"
           "<DataArray type=\"Int16\" Name=\"s\" format=\"appended\" offset=\"" +
           offset +
           "\"/></PointData></Piece>\n"
           "</ImageData>\n<AppendedData encoding=\"raw\">\n_" +
           block + ramp<std::int16_t>(24) + "\n</AppendedData>\n</VTKFile>\n";
}

inline std::string bigEndian16(std::size_t count) {
    std::string bytes;
    for (std::size_t i = 0; i < count; ++i) {
        bytes += static_cast<char>(i >> 8);
        bytes += static_cast<char>(i & 255);
    }
    return bytes;
}

inline std::string vtkHeader(const std::string& encoding) {
    return "# vtk DataFile Version 3.0\ntitle\n" + encoding +
           "\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 3 2\n"
           "SPACING 1 2 3\nORIGIN 10 20 30\nPOINT_DATA 24\n";
}
inline std::string vtkBinary() {
    return vtkHeader("BINARY") + "SCALARS s short\nLOOKUP_TABLE default\n" + bigEndian16(24) + "\n";
}
inline std::string vtkText() {
    std::string text = vtkHeader("ASCII") + "SCALARS s short 1\nLOOKUP_TABLE default\n";
    for (int i = 0; i < 24; ++i)
        text += std::to_string(i) + (i % 5 == 4 ? "\n" : " ");
    return text + "\n";
}

/// 3 x 2 x 2 points, uneven along x; value = x + 10 y + 100 z.
inline std::string vtkRectilinear() {
    return "# vtk DataFile Version 2.0\ntitle\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 3 2 2\n"
           "X_COORDINATES 3 float\n0 1 4\nY_COORDINATES 2 float\n0 1\nZ_COORDINATES 2 double\n0 1\n"
           "POINT_DATA 12\nSCALARS s float\nLOOKUP_TABLE default\n"
           "0 1 4 10 11 14\n100 101 104 110 111 114\n";
}

/// Two tetrahedra side by side; value = x + 2 y + 3 z.
inline std::string vtkCells() {
    return "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n"
           "POINTS 5 float\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n"
           "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10 10\n"
           "CELL_DATA 2\nSCALARS c int\nLOOKUP_TABLE default\n7 8\n"
           "POINT_DATA 5\nVECTORS v float\n0 0 0 1 0 0 0 1 0 0 0 1 3 4 12\n"
           "SCALARS s double\nLOOKUP_TABLE default\n0 1 2 3 6\n";
}
inline std::string vtu() {
    return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n"
           "<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n<PointData>\n"
           "<DataArray type=\"Float32\" Name=\"v\" NumberOfComponents=\"3\" format=\"ascii\">\n"
           "0 0 0 1 0 0 0 1 0 0 0 1 3 4 12</DataArray>\n"
           "<DataArray type=\"Float64\" Name=\"s\" format=\"ascii\">0 1 2 3 6</DataArray>\n</PointData>\n"
           "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n"
           "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataArray></Points>\n<Cells>\n"
           "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3 1 2 3 4</DataArray>\n"
           "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4 8</DataArray>\n"
           "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10 10</DataArray>\n</Cells>\n"
           "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

} // namespace isoslider::test
