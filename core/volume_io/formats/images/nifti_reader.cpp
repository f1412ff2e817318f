#include <cmath>

#include "core/volume_io/formats/data_files.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/formats/images/nifti_header.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/sources/magnitude_source.h"
#include "core/volume_io/sources/sample_source.h"
#include "core/volume_io/volume_choice.h"

// NIfTI-1, NIfTI-2 and Analyze 7.5, which NIfTI grew from.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

/// A type of samples, some of several values beside each other.
struct Code {
    int code;
    FileType type;
    int values = 1;
    const char* name = nullptr; ///< if fileTypeName will not do
};
constexpr Code kCodes[] = {{2, FileType::U8},
                           {256, FileType::I8},
                           {512, FileType::U16},
                           {4, FileType::I16},
                           {768, FileType::U32},
                           {8, FileType::I32},
                           {1280, FileType::U64},
                           {1024, FileType::I64},
                           {16, FileType::F32},
                           {64, FileType::F64},
                           {128, FileType::U8, 3},
                           {2304, FileType::U8, 4},
                           {32, FileType::F32, 2, "complex64"},
                           {1792, FileType::F64, 2, "complex128"}};

struct Volume {
    NiftiFiles files;
    NiftiHeader header;
    Code code{};
    std::int64_t times = 1; ///< dim[4]: frames that lie beside each other
    std::int64_t vectors = 1; ///< dim[5]: components, each a volume or a separate series
    std::uint64_t sampleBytes = 0;
    VolumeField field;

    std::uint64_t pointsBefore(std::int64_t component, std::int64_t frame) const {
        const std::int64_t volumes = frame % times + times * (component + vectors * (frame / times));
        return static_cast<std::uint64_t>(volumes * pointCount(field.dims));
    }
};

Result<Code> readCode(const NiftiHeader& header, const fs::path& path) {
    for (const Code& known : kCodes) {
        if (known.code != header.dataType)
            continue;
        if (static_cast<std::size_t>(header.bitsPerSample) !=
            8 * fileTypeSizeBytes(known.type) * static_cast<std::size_t>(known.values))
            return refuseField(
                "bitpix", std::to_string(header.bitsPerSample) + " does not fit datatype " + std::to_string(known.code),
                path);
        return known;
    }
    const char* name = header.dataType == 1536 ? " (float128)" : header.dataType == 2048 ? " (complex256)" : "";
    return refuseField("datatype", std::to_string(header.dataType) + name + " is not a type of samples that is read",
                       path);
}

std::vector<std::string> componentNames(const Volume& volume) {
    if (volume.code.name != nullptr)
        return {"real", "imaginary"};
    if (volume.code.values == 3)
        return {"red", "green", "blue"};
    if (volume.code.values == 4)
        return {"red", "green", "blue", "alpha"};
    if (volume.header.intent == 2003 && volume.vectors == 3)
        return {"red", "green", "blue"};
    if (volume.header.intent == 2004 && volume.vectors == 4)
        return {"red", "green", "blue", "alpha"};
    if (volume.header.intent == 1006 && volume.vectors == 3) // displacements
        return {"x", "y", "z"};
    return {};
}

Result<Volume> describe(const fs::path& path) {
    auto files = findNiftiFiles(path);
    if (!files.isOk())
        return std::move(files).error();
    auto header = readNiftiHeader(files.value());
    if (!header.isOk())
        return std::move(header).error();
    const auto code = readCode(header.value(), files.value().header);
    if (!code.isOk())
        return code.error();
    const auto sizes = header.value().sizes;
    ISO_TRY(checkExtents(sizes, "dim", files.value().header));
    const auto size = [&](std::size_t axis) { return axis < sizes.size() ? sizes[axis] : 1; };

    Volume volume{std::move(files).value(), std::move(header).value(), code.value(), size(3), size(4), 0, {}};
    volume.field.dims = {size(0), size(1), size(2)};
    if (volume.vectors > 1 && volume.code.values > 1)
        return refuseField("dim[5]", "vectors of colours or complex numbers are not read", volume.files.header);
    volume.field.components = static_cast<int>(volume.vectors) * volume.code.values;
    volume.field.componentNames = componentNames(volume);
    volume.field.frames = volume.times * size(5) * size(6);
    volume.field.typeName =
        volume.code.name != nullptr ? std::string_view(volume.code.name) : fileTypeName(volume.code.type);
    const auto values = pointCount(volume.field.dims) * volume.field.components * volume.field.frames;
    volume.sampleBytes = static_cast<std::uint64_t>(values) * fileTypeSizeBytes(volume.code.type);
    return volume;
}

Result<std::unique_ptr<ByteStream>> openBytes(const Volume& volume, const ReadOptions& options) {
    const auto offset = static_cast<std::uint64_t>(volume.header.dataOffset);
    if (volume.files.isDataPacked)
        return openEncoded({{volume.files.data, 0}}, volume.sampleBytes,
                           {Encoding::Deflate, FileType::U8, offset, options.allowsTrailing,
                            planeBytes(volume.field, volume.code.type)});
    return openParts({{volume.files.data, offset}}, volume.sampleBytes);
}

std::optional<Rescale> readRescale(const Volume& volume, VolumeInfo& info) {
    const double slope = volume.header.slope, intercept = volume.header.intercept;
    if (volume.code.values > 2 || volume.header.version == NiftiVersion::Analyze75) // of no meaning there
        return std::nullopt;
    if (!std::isfinite(slope) || !std::isfinite(intercept)) {
        info.notes.push_back("scl_slope or scl_inter is not finite and is ignored");
        return std::nullopt;
    }
    if (slope == 0.0 || (slope == 1.0 && intercept == 0.0))
        return std::nullopt;
    return Rescale{slope, intercept};
}

std::unique_ptr<VolumeSource> openComponent(const Volume& volume, int component, std::int64_t frame,
                                            const VolumeInfo& info, const std::optional<Rescale>& rescale,
                                            std::unique_ptr<ByteStream> bytes) {
    const bool isPlanar = volume.vectors > 1;
    SampleLayout layout{volume.code.type,   volume.header.isBigEndian, rescale,
                        volume.code.values, isPlanar ? 0 : component,  0};
    layout.firstValue =
        volume.pointsBefore(isPlanar ? component : 0, frame) * static_cast<std::uint64_t>(volume.code.values);
    return makeSampleSource(info, layout, std::move(bytes), volume.files.data);
}

Status noteTrailing(const Volume& volume, VolumeInfo& info) {
    if (volume.files.isDataPacked)
        return {};
    const auto file = defaultFileSystem().openForReading(volume.files.data);
    if (!file.isOk())
        return file.error();
    if (file.value()->sizeBytes() > static_cast<std::uint64_t>(volume.header.dataOffset) + volume.sampleBytes)
        info.notes.push_back("the data file is longer than the samples; the rest is ignored");
    return {};
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openNifti(const fs::path& path, const ReadOptions& options) {
    const auto described = describe(path);
    if (!described.isOk())
        return described.error();
    const Volume& volume = described.value();
    auto bytes = openBytes(volume, options); // sizes first: a choice among what is not there is none
    if (!bytes.isOk())
        return std::move(bytes).error();
    const auto choice = chooseInOnlyField(volume.field, options, volume.files.header);
    if (!choice.isOk())
        return choice.error();
    VolumeInfo info;
    info.format = volume.header.version == NiftiVersion::Analyze75 ? "Analyze" : "NIfTI";
    info.dataFiles = filesBeside(path, {{volume.files.header, 0}, {volume.files.data, 0}});
    const NiftiPlace place = niftiPlace(volume.header, volume.field.dims, info.notes);
    info.geometry = place.geometry;
    info.isPatientSpace = place.isStated && volume.header.version != NiftiVersion::Analyze75;
    if (hasMillimetres(volume.header))
        info.lengthUnit = "mm";
    ISO_TRY(checkGeometry(info.geometry, "pixdim, qform, sform", volume.files.header));
    ISO_TRY(noteTrailing(volume, info));
    const auto rescale = readRescale(volume, info);
    const auto [component, frame] = choice.value();
    if (component != kMagnitude || volume.vectors == 1)
        return openComponent(volume, component, frame, info, rescale, std::move(bytes).value());
    if (volume.field.components > static_cast<int>(kMaxMagnitudeParts))
        return refuseField("--component magnitude", "is taken of at most 64 components", path);
    std::vector<std::unique_ptr<VolumeSource>> parts;
    for (int i = 0; i < volume.field.components; ++i) {
        bytes = openBytes(volume, options);
        if (!bytes.isOk())
            return std::move(bytes).error();
        parts.push_back(openComponent(volume, i, frame, info, rescale, std::move(bytes).value()));
    }
    return makeMagnitudeSource(std::move(parts));
}

Result<VolumeContents> listNifti(const fs::path& path, const ReadOptions& options) {
    auto volume = describe(path);
    if (!volume.isOk())
        return std::move(volume).error();
    const auto bytes = openBytes(volume.value(), options);
    if (!bytes.isOk())
        return bytes.error();
    VolumeContents contents;
    contents.format = volume.value().header.version == NiftiVersion::Analyze75 ? "Analyze" : "NIfTI";
    contents.fields.push_back(std::move(volume.value().field));
    return contents;
}

} // namespace isoslider::io
