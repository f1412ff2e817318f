#include "core/volume_io/formats/format_readers.h"

#include <cstring>

namespace isoslider::io {

Result<VolumeContents> listByOpening(OpenFormat open, const std::filesystem::path& path, const ReadOptions& options) {
    const auto source = open(path, options);
    if (!source.isOk())
        return source.error();
    const VolumeInfo& info = source.value()->info();
    VolumeField field;
    field.name = info.fieldName;
    field.title = info.fieldTitle;
    field.dims = info.geometry.dims;
    field.typeName = scalarTypeName(info.type);
    VolumeContents contents;
    contents.format = info.format;
    contents.fields.push_back(std::move(field));
    return contents;
}

Status WholeGridSource::prepare(const JobControl& job) {
    const auto made = grid(job);
    return made.isOk() ? Status{} : made.error();
}

Status WholeGridSource::readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
    const auto made = grid({});
    if (!made.isOk())
        return made.error();
    const ScalarGrid& whole = *made.value();
    const auto planeBytes =
        static_cast<std::size_t>(whole.dims()[0] * whole.dims()[1]) * scalarTypeSizeBytes(whole.type());
    const auto bytes = whole.bytes().subspan(static_cast<std::size_t>(zBegin) * planeBytes,
                                             static_cast<std::size_t>(zEnd - zBegin) * planeBytes);
    ISO_CHECK(bytes.size() == out.size());
    if (!bytes.empty())
        std::memcpy(out.data(), bytes.data(), bytes.size());
    return {};
}

} // namespace isoslider::io
