#include "core/volume_io/formats/images/nifti_header.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "core/base/folders.h"
#include "core/volume_io/parsing/byte_stream.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kHeader1Bytes = 348, kHeader2Bytes = 540;
constexpr double kMaxDataOffset = 16 << 20;

struct Bytes {
    std::vector<std::byte> bytes;
    bool isSwapped = false;

    template <class T>
    T at(std::size_t offset) const {
        std::array<std::byte, sizeof(T)> raw;
        std::memcpy(raw.data(), bytes.data() + offset, sizeof(T));
        if (isSwapped)
            std::reverse(raw.begin(), raw.end());
        return std::bit_cast<T>(raw);
    }
    bool has(std::size_t offset, const char (&text)[4]) const {
        return std::memcmp(bytes.data() + offset, text, 4) == 0;
    }
};

bool endsWith(const fs::path& path, std::string_view suffix) {
    return lowerCase(path.filename().string()).ends_with(suffix);
}

Result<std::vector<std::byte>> readBytes(const NiftiFiles& files, std::size_t maxBytes) {
    if (files.isHeaderPacked)
        return inflateStart(files.header, maxBytes);
    auto text = readStart(files.header, maxBytes);
    if (!text.isOk())
        return std::move(text).error();
    const auto bytes = std::as_bytes(std::span(text.value()));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
}

// Fills everything but version and byte order. Whole and Real: the two kinds of numbers in the header.
struct Offsets {
    std::size_t dim, dataType, intent, pixdim, slope, qform, quaternion, sform;
};
template <class Size, class Real, class Code>
void readFields(const Bytes& bytes, const Offsets& at, NiftiHeader& header) {
    const auto count = std::clamp<std::int64_t>(bytes.at<Size>(at.dim), 0, 7);
    for (std::int64_t i = 1; i <= count; ++i)
        header.sizes.push_back(bytes.at<Size>(at.dim + static_cast<std::size_t>(i) * sizeof(Size)));
    header.dataType = bytes.at<std::int16_t>(at.dataType);
    header.bitsPerSample = bytes.at<std::int16_t>(at.dataType + 2);
    header.intent = bytes.at<Code>(at.intent);
    const auto reals = [&](std::size_t offset, std::span<double> out) {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = bytes.at<Real>(offset + i * sizeof(Real));
    };
    reals(at.pixdim, header.pixelSizes);
    header.slope = bytes.at<Real>(at.slope);
    header.intercept = bytes.at<Real>(at.slope + sizeof(Real));
    header.qformCode = bytes.at<Code>(at.qform);
    header.sformCode = bytes.at<Code>(at.qform + sizeof(Code));
    reals(at.quaternion, header.quaternion);
    reals(at.quaternion + 3 * sizeof(Real), header.offset);
    for (std::size_t row = 0; row < 3; ++row)
        reals(at.sform + 4 * row * sizeof(Real), header.sform[row]);
}

Result<Bytes> readStartOfHeader(const NiftiFiles& files) {
    auto read = readBytes(files, kHeader2Bytes + 4);
    if (!read.isOk())
        return std::move(read).error();
    Bytes bytes{std::move(read).value(), false};
    if (bytes.bytes.size() < kHeader1Bytes)
        return makeError(ErrorCode::InvalidArgument, "is not NIfTI: shorter than its header of 348 bytes",
                         files.header);
    for (const bool swaps : {false, true}) {
        bytes.isSwapped = swaps;
        const auto size = bytes.at<std::int32_t>(0);
        if (size == static_cast<std::int32_t>(kHeader2Bytes) && bytes.bytes.size() < kHeader2Bytes)
            return makeError(ErrorCode::InvalidArgument, "is not NIfTI-2: shorter than its header of 540 bytes",
                             files.header);
        if (size == static_cast<std::int32_t>(kHeader1Bytes) || size == static_cast<std::int32_t>(kHeader2Bytes))
            return bytes;
    }
    return refuseField("sizeof_hdr", "348 or 540 expected: is not NIfTI", files.header);
}

// A chain of extensions is bounded by the samples; a damaged one would lead anywhere.
Status checkExtensions(Bytes& bytes, const NiftiFiles& files, std::size_t headerBytes, double dataOffset) {
    if (bytes.bytes.size() < headerBytes + 4 || bytes.bytes[headerBytes] == std::byte{0})
        return {};
    auto read = readBytes(files, static_cast<std::size_t>(files.isPair ? kMaxDataOffset : dataOffset));
    if (!read.isOk())
        return std::move(read).error();
    bytes.bytes = std::move(read).value();
    const std::size_t end = bytes.bytes.size();
    for (std::size_t at = headerBytes + 4; at < end;) {
        const std::int64_t size = end - at >= 8 ? bytes.at<std::int32_t>(at) : 0;
        if (size < 16 || size % 16 != 0 || static_cast<std::uint64_t>(size) > end - at)
            return makeError(ErrorCode::InvalidArgument,
                             "extension: its size " + std::to_string(size) + " is not possible", files.header, at);
        at += static_cast<std::size_t>(size);
    }
    return {};
}

bool isUsable(const glm::dmat3& axes, const glm::dvec3& origin) {
    for (int i = 0; i < 3; ++i)
        if (!std::isfinite(origin[i]) || !(glm::length(axes[i]) > 0.0) || !std::isfinite(glm::length(axes[i])))
            return false;
    const glm::dmat3 unit(glm::normalize(axes[0]), glm::normalize(axes[1]), glm::normalize(axes[2]));
    return std::abs(glm::determinant(unit)) > 1e-6;
}

glm::dvec3 pixelSizes(const NiftiHeader& header, std::vector<std::string>& notes) {
    glm::dvec3 sizes(1.0);
    for (int axis = 0; axis < 3; ++axis) {
        const double size = header.pixelSizes[static_cast<std::size_t>(axis) + 1];
        if (size == 0.0 || !std::isfinite(size))
            notes.push_back("pixdim[" + std::to_string(axis + 1) + "] is unusable; a spacing is assumed");
        else
            sizes[axis] = std::abs(size);
    }
    return sizes;
}

// Rotation of the unit quaternion (a, b, c, d), whose first number is not stored.
glm::dmat3 qformRotation(const NiftiHeader& header) {
    auto [b, c, d] = header.quaternion;
    double a = 1.0 - (b * b + c * c + d * d);
    if (a < 1e-7) { // a half turn, rounded
        const double scale = 1.0 / std::sqrt(b * b + c * c + d * d);
        b *= scale, c *= scale, d *= scale, a = 0.0;
    } else {
        a = std::sqrt(a);
    }
    const double handed = header.pixelSizes[0] < 0.0 ? -1.0 : 1.0;
    return {glm::dvec3(a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)),
            glm::dvec3(2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)),
            handed * glm::dvec3(2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c)};
}

double millimetresPerUnit(const NiftiHeader& header, std::vector<std::string>& notes) {
    const auto unit = header.units & 7;
    if (unit != 1 && unit != 3)
        return 1.0;
    notes.push_back(unit == 1 ? "lengths are metres in the file, millimetres here"
                              : "lengths are micrometres in the file, millimetres here");
    return unit == 1 ? 1e3 : 1e-3;
}

} // namespace

Result<NiftiFiles> findNiftiFiles(const fs::path& path) {
    if (!endsWith(path, ".hdr") && !endsWith(path, ".img") && !endsWith(path, ".hdr.gz") &&
        !endsWith(path, ".img.gz")) {
        const bool isPacked = endsWith(path, ".gz");
        return NiftiFiles{path, path, false, isPacked, isPacked};
    }
    const fs::path stem =
        endsWith(path, ".gz") ? path.parent_path() / path.stem().stem() : path.parent_path() / path.stem();
    NiftiFiles files{stem, stem, true, false, false};
    const auto find = [&](fs::path& file, const char* suffix, bool& isPacked) {
        file += suffix;
        if (isPresent(file))
            return true;
        isPacked = true;
        file += ".gz";
        return isPresent(file);
    };
    if (!find(files.header, ".hdr", files.isHeaderPacked))
        return makeError(ErrorCode::InvalidArgument, "the header of the pair is missing",
                         files.header.replace_extension());
    if (!find(files.data, ".img", files.isDataPacked))
        return makeError(ErrorCode::InvalidArgument, "the samples of the pair are missing",
                         files.data.replace_extension());
    return files;
}

Result<NiftiHeader> readNiftiHeader(const NiftiFiles& files) {
    auto read = readStartOfHeader(files);
    if (!read.isOk())
        return std::move(read).error();
    Bytes& bytes = read.value();
    const bool isSecond = bytes.at<std::int32_t>(0) == static_cast<std::int32_t>(kHeader2Bytes);
    const bool isNifti = isSecond ? (files.isPair ? bytes.has(4, "ni2") : bytes.has(4, "n+2"))
                                  : (files.isPair ? bytes.has(344, "ni1") : bytes.has(344, "n+1"));
    const bool isOther = isSecond || bytes.has(344, "ni1") || bytes.has(344, "n+1");
    if (!isNifti && (isOther || !files.isPair))
        return makeError(ErrorCode::InvalidArgument,
                         std::string("magic: '") + (files.isPair ? "ni" : "n+") + (isSecond ? '2' : '1') + "' expected",
                         files.header);
    NiftiHeader header;
    header.version = isSecond ? NiftiVersion::Nifti2 : isNifti ? NiftiVersion::Nifti1 : NiftiVersion::Analyze75;
    header.isBigEndian = bytes.isSwapped == (std::endian::native == std::endian::little);
    const std::int64_t count = isSecond ? bytes.at<std::int64_t>(16) : bytes.at<std::int16_t>(40);
    if (count < 1 || count > 7)
        return refuseField("dim[0]", std::to_string(count) + " is not a number of dimensions from 1 to 7",
                           files.header);
    if (isSecond) {
        readFields<std::int64_t, double, std::int32_t>(bytes, {16, 12, 504, 104, 176, 344, 352, 400}, header);
        header.dataOffset = static_cast<double>(bytes.at<std::int64_t>(168));
        header.units = bytes.at<std::int32_t>(500);
    } else {
        readFields<std::int16_t, float, std::int16_t>(bytes, {40, 70, 68, 76, 112, 252, 256, 280}, header);
        header.dataOffset = bytes.at<float>(108);
        header.units = std::to_integer<int>(bytes.bytes[123]);
    }
    const std::size_t headerBytes = isSecond ? kHeader2Bytes : kHeader1Bytes;
    const double least = files.isPair ? 0.0 : static_cast<double>(headerBytes + 4);
    const double offset = header.dataOffset;
    if (!(offset >= least && offset <= kMaxDataOffset) || offset != std::floor(offset))
        return refuseField("vox_offset", std::to_string(offset) + " is not a place for samples", files.header);
    if (header.version == NiftiVersion::Analyze75) { // the rest of its header means other things
        header.units = header.qformCode = header.sformCode = header.intent = 0;
        return header;
    }
    ISO_TRY(checkExtensions(bytes, files, headerBytes, offset));
    return header;
}

bool hasMillimetres(const NiftiHeader& header) {
    const auto unit = header.units & 7;
    return header.version == NiftiVersion::Analyze75 || (unit >= 1 && unit <= 3);
}

NiftiPlace niftiPlace(const NiftiHeader& header, const GridDims& dims, std::vector<std::string>& notes) {
    const glm::dvec3 sizes = pixelSizes(header, notes);
    glm::dmat3 axes(glm::dvec3(sizes.x, 0, 0), glm::dvec3(0, sizes.y, 0), glm::dvec3(0, 0, sizes.z));
    glm::dvec3 origin(0.0);
    bool isPlaced = false;
    if (header.sformCode > 0) {
        glm::dmat3 sform;
        glm::dvec3 place;
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column)
                sform[column][row] = header.sform[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
            place[row] = header.sform[static_cast<std::size_t>(row)][3];
        }
        isPlaced = isUsable(sform, place);
        if (isPlaced)
            axes = sform, origin = place;
        else
            notes.push_back("its sform does not span space and is not used");
    }
    if (!isPlaced && header.qformCode > 0) {
        glm::dmat3 qform = qformRotation(header);
        const glm::dvec3 place(header.offset[0], header.offset[1], header.offset[2]);
        for (int axis = 0; axis < 3; ++axis)
            qform[axis] *= sizes[axis];
        isPlaced = isUsable(qform, place);
        if (isPlaced)
            axes = qform, origin = place;
        else
            notes.push_back("its qform does not span space and is not used");
    }
    if (header.version == NiftiVersion::Analyze75) {
        axes[0] = -axes[0];
        notes.push_back("Analyze headers contain no orientation; left, anterior, superior is assumed");
    } else if (!isPlaced) {
        notes.push_back("has neither qform nor sform that is of use; its orientation is assumed");
    }
    const double scale = millimetresPerUnit(header, notes);
    const glm::dvec3 flip(-1.0, -1.0, 1.0); // from right-anterior-superior
    GridGeometry geometry;
    geometry.dims = dims;
    geometry.origin = scale * flip * origin + 0.0; // no negative zeros
    for (int axis = 0; axis < 3; ++axis) {
        const double length = glm::length(axes[axis]);
        // Rows of an sform are rounded; the pixel size is what was meant where both agree.
        const bool agrees = std::abs(length - sizes[axis]) <= 1e-5 * length;
        geometry.spacing[axis] = scale * (agrees ? sizes[axis] : length);
        geometry.direction[axis] = flip * axes[axis] / length + 0.0;
    }
    return {geometry, isPlaced};
}

} // namespace isoslider::io
