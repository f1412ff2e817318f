#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/header_checks.h"
#include "core/volume_io/sample_source.h"

namespace isoslider::io {

Result<std::unique_ptr<VolumeSource>> openRaw(const std::filesystem::path& path, const ReadOptions& options) {
    const RawLayout& layout = *options.raw;
    const auto dims = checkDims(layout.dims, "dims", path);
    if (!dims.isOk())
        return dims.error();
    VolumeInfo info;
    info.format = "raw";
    info.geometry.dims = dims.value();
    info.geometry.spacing = layout.spacing;
    ISO_TRY(checkGeometry(info.geometry, "spacing", path));
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    const std::uint64_t samples = static_cast<std::uint64_t>(pointCount(dims.value())) * scalarTypeSizeBytes(layout.type);
    const std::uint64_t size = file.value()->sizeBytes();
    const bool isShort = layout.skipBytes > size || size - layout.skipBytes < samples;
    if (isShort || (!options.allowsTrailing && size - layout.skipBytes > samples))
        return makeError(isShort ? ErrorCode::Corruption : ErrorCode::InvalidArgument,
                         "has " + std::to_string(size) + " bytes; dims, type and skipped bytes ask for " +
                             std::to_string(samples) + (layout.skipBytes > 0 ? " after " + std::to_string(layout.skipBytes) : "") +
                             (isShort ? "" : " (trailing bytes have to be allowed)"),
                         path);
    auto bytes = openParts({{path, layout.skipBytes}}, samples);
    if (!bytes.isOk())
        return std::move(bytes).error();
    return makeSampleSource(std::move(info), {fileTypeOf(layout.type), layout.isBigEndian, std::nullopt},
                            std::move(bytes).value(), path);
}

} // namespace isoslider::io
