#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/header_checks.h"
#include "core/volume_io/formats/itk_header.h"
#include "core/volume_io/sample_source.h"

// Sizes, types and extensions are settled here; ITK then works out the place in space.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kHeaderBytes = 348;
constexpr std::int64_t kMaxDataOffset = std::int64_t{16} << 20;

struct Files {
    fs::path header;
    fs::path data;
    bool isPair = false;
    bool isHeaderPacked = false;
    bool isDataPacked = false;
};

struct Header {
    std::vector<std::byte> bytes; ///< up to the samples of a single file
    bool isSwapped = false;

    template <class T>
    T at(std::size_t offset) const {
        std::array<std::byte, sizeof(T)> raw;
        std::memcpy(raw.data(), bytes.data() + offset, sizeof(T));
        if (isSwapped)
            std::reverse(raw.begin(), raw.end());
        return std::bit_cast<T>(raw);
    }
};

bool endsWith(const fs::path& path, std::string_view suffix) {
    return lowerCase(path.filename().string()).ends_with(suffix);
}

Result<Files> findFiles(const fs::path& path) {
    if (endsWith(path, ".nii"))
        return Files{path, path};
    if (endsWith(path, ".nii.gz"))
        return Files{path, path, false, true, true};
    Files files{path, path, true, false, false};
    files.header.replace_extension(".hdr");
    files.data.replace_extension(".img");
    std::error_code ignored;
    if (!fs::exists(files.header, ignored))
        return makeError(ErrorCode::NotFound, "the header of the pair is missing", files.header);
    if (!fs::exists(files.data, ignored)) {
        files.data += ".gz";
        files.isDataPacked = true;
    }
    if (!fs::exists(files.data, ignored))
        return makeError(ErrorCode::NotFound, "the samples of the pair are missing", files.data.replace_extension());
    return files;
}

Result<std::vector<std::byte>> readBytes(const Files& files, std::size_t maxBytes) {
    if (files.isHeaderPacked)
        return inflateStart(files.header, maxBytes);
    auto text = readStart(files.header, maxBytes);
    if (!text.isOk())
        return std::move(text).error();
    const auto bytes = std::as_bytes(std::span(text.value()));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Result<Header> readHeader(const Files& files) {
    auto bytes = readBytes(files, kHeaderBytes + 4);
    if (!bytes.isOk())
        return std::move(bytes).error();
    if (bytes.value().size() < kHeaderBytes)
        return makeError(ErrorCode::InvalidArgument, "is not NIfTI: shorter than its header of 348 bytes", files.header);
    Header header{std::move(bytes).value(), false};
    for (const bool swaps : {false, true}) {
        header.isSwapped = swaps;
        if (header.at<std::int32_t>(0) == 540)
            return makeError(ErrorCode::UnsupportedVersion, "is NIfTI-2; NIfTI-1 is read", files.header);
        if (header.at<std::int32_t>(0) == 348)
            break;
        if (swaps)
            return refuseField("sizeof_hdr", "348 expected: is not NIfTI", files.header);
    }
    const char* expected = files.isPair ? "ni1" : "n+1";
    if (std::memcmp(header.bytes.data() + 344, expected, 4) != 0)
        return makeError(ErrorCode::UnsupportedVersion, std::string("magic: '") + expected +
                                                            "' expected; Analyze files are not read", files.header);
    return header;
}

Result<FileType> readType(const Header& header, const fs::path& path) {
    struct Code {
        int code;
        FileType type;
    };
    constexpr Code kCodes[] = {{2, FileType::U8},    {256, FileType::I8},  {512, FileType::U16}, {4, FileType::I16},
                               {768, FileType::U32}, {8, FileType::I32},   {1280, FileType::U64}, {1024, FileType::I64},
                               {16, FileType::F32},  {64, FileType::F64}};
    const int code = header.at<std::int16_t>(70), bits = header.at<std::int16_t>(72);
    for (const Code& known : kCodes) {
        if (known.code != code)
            continue;
        if (static_cast<std::size_t>(bits) != 8 * fileTypeSizeBytes(known.type))
            return refuseField("bitpix", std::to_string(bits) + " does not fit datatype " + std::to_string(code), path);
        return known.type;
    }
    return refuseField("datatype", std::to_string(code) + " is not a type of scalars that is read", path);
}

Result<GridDims> readDims(const Header& header, const fs::path& path) {
    const int count = header.at<std::int16_t>(40);
    if (count < 1 || count > 7)
        return refuseField("dim[0]", std::to_string(count) + " is not a number of dimensions from 1 to 7", path);
    std::vector<std::int64_t> sizes;
    for (int i = 1; i <= count; ++i)
        sizes.push_back(header.at<std::int16_t>(40 + 2 * static_cast<std::size_t>(i)));
    return checkDims(sizes, "dim", path);
}

Result<std::uint64_t> readDataOffset(const Header& header, const Files& files) {
    const double offset = header.at<float>(108);
    const double least = files.isPair ? 0.0 : 352.0;
    if (!(offset >= least && offset <= static_cast<double>(kMaxDataOffset)) || offset != std::floor(offset))
        return refuseField("vox_offset", std::to_string(offset) + " is not a place for samples", files.header);
    return static_cast<std::uint64_t>(offset);
}

// A chain of extensions is bounded by the samples; a damaged one would lead anywhere.
Status checkExtensions(Header& header, const Files& files, std::uint64_t dataOffset) {
    if (header.bytes.size() < kHeaderBytes + 4 || header.bytes[kHeaderBytes] == std::byte{0})
        return {};
    auto bytes = readBytes(files, files.isPair ? kMaxDataOffset : dataOffset);
    if (!bytes.isOk())
        return std::move(bytes).error();
    header.bytes = std::move(bytes).value();
    const std::size_t end = header.bytes.size();
    for (std::size_t at = kHeaderBytes + 4; at < end;) {
        const std::int64_t size = end - at >= 8 ? header.at<std::int32_t>(at) : 0;
        if (size < 16 || size % 16 != 0 || static_cast<std::uint64_t>(size) > end - at)
            return makeError(ErrorCode::InvalidArgument, "extension: its size " + std::to_string(size) +
                                                             " is not possible", files.header, at);
        at += static_cast<std::size_t>(size);
    }
    return {};
}

std::optional<Rescale> readRescale(const Header& header, VolumeInfo& info) {
    const double slope = header.at<float>(112), intercept = header.at<float>(116);
    if (!std::isfinite(slope) || !std::isfinite(intercept)) {
        info.notes.push_back("scl_slope or scl_inter is not finite and is ignored");
        return std::nullopt;
    }
    if (slope == 0.0 || (slope == 1.0 && intercept == 0.0))
        return std::nullopt;
    return Rescale{slope, intercept};
}

void noteBadSpacing(const Header& header, VolumeInfo& info) {
    for (std::size_t axis = 1; axis <= 3; ++axis) {
        const float size = header.at<float>(76 + 4 * axis);
        if (size == 0.0f || !std::isfinite(size))
            info.notes.push_back("pixdim[" + std::to_string(axis) + "] is unusable; a spacing is assumed");
    }
    if (header.at<std::int16_t>(252) == 0 && header.at<std::int16_t>(254) == 0)
        info.notes.push_back("has neither qform nor sform; its orientation is assumed");
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openNifti(const fs::path& path, const ReadOptions& /*options*/) {
    const auto files = findFiles(path);
    if (!files.isOk())
        return files.error();
    const fs::path& headerPath = files.value().header;
    auto header = readHeader(files.value());
    if (!header.isOk())
        return std::move(header).error();
    const auto type = readType(header.value(), headerPath);
    if (!type.isOk())
        return type.error();
    const auto dims = readDims(header.value(), headerPath);
    if (!dims.isOk())
        return dims.error();
    const auto offset = readDataOffset(header.value(), files.value());
    if (!offset.isOk())
        return offset.error();
    const std::uint64_t sampleBytes =
        static_cast<std::uint64_t>(pointCount(dims.value())) * fileTypeSizeBytes(type.value());
    const fs::path& data = files.value().data;
    auto bytes = files.value().isDataPacked ? openDeflated(data, 0, offset.value(), sampleBytes)
                                            : openParts({{data, offset.value()}}, sampleBytes);
    if (!bytes.isOk())
        return std::move(bytes).error();
    ISO_TRY(checkExtensions(header.value(), files.value(), offset.value()));

    VolumeInfo info;
    info.format = "NIfTI";
    auto geometry = readItkGeometry(headerPath, ItkFormat::Nifti, dims.value());
    if (!geometry.isOk())
        return std::move(geometry).error();
    info.geometry = geometry.value();
    ISO_TRY(checkGeometry(info.geometry, "pixdim, qform, sform", headerPath));
    noteBadSpacing(header.value(), info);
    const bool isBigEndian = header.value().isSwapped == (std::endian::native == std::endian::little);
    const SampleLayout layout{type.value(), isBigEndian, readRescale(header.value(), info)};
    return makeSampleSource(std::move(info), layout, std::move(bytes).value(), data);
}

} // namespace isoslider::io
