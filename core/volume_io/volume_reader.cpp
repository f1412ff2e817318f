#include "core/volume_io/volume_reader.h"

#include <algorithm>
#include <cstring>
#include <new>

#include "core/base/file_system.h"
#include "core/volume_io/format_readers.h"
#include "core/volume_io/header_checks.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kSlabBytes = std::uint64_t{64} << 20;

bool endsWithAny(const std::string& name, std::initializer_list<std::string_view> suffixes) {
    return std::any_of(suffixes.begin(), suffixes.end(), [&](std::string_view s) { return name.ends_with(s); });
}

Result<std::unique_ptr<VolumeSource>> openBySuffix(const fs::path& path, const ReadOptions& options) {
    const std::string name = lowerCase(path.filename().string());
    if (endsWithAny(name, {".mhd", ".mha"}))
        return openMetaImage(path);
    if (endsWithAny(name, {".nrrd", ".nhdr"}))
        return openNrrd(path);
    if (endsWithAny(name, {".nii", ".nii.gz", ".hdr", ".img"}))
        return openNifti(path);
    if (endsWithAny(name, {".vti"}))
        return openVtkXml(path, options);
    if (endsWithAny(name, {".vtk"}))
        return openVtkLegacy(path, options);
    if (endsWithAny(name, {"xyz.bin", "q.bin", ".xyz", ".q", ".p3d"}))
        return openPlot3d(path, options);
    return makeError(ErrorCode::InvalidArgument,
                     "is not a known volume format: expected .mhd .mha .nrrd .nhdr .nii .nii.gz .hdr .img .vti .vtk, "
                     "a PLOT3D pair, or raw samples with their dims and type",
                     path);
}

Result<std::shared_ptr<const ScalarGrid>> readSlabs(VolumeSource& source, const fs::path& path,
                                                    const JobControl& job) {
    const VolumeInfo& info = source.info();
    const GridDims& dims = info.geometry.dims;
    const std::uint64_t planeBytes =
        static_cast<std::uint64_t>(dims[0] * dims[1]) * scalarTypeSizeBytes(info.type);
    const std::uint64_t totalBytes = planeBytes * static_cast<std::uint64_t>(dims[2]);
    ISO_TRY(checkFitsMemory(totalBytes, path));
    std::vector<std::byte> samples(totalBytes);
    const auto step = static_cast<std::int64_t>(std::max<std::uint64_t>(1, kSlabBytes / planeBytes));
    for (std::int64_t z = 0; z < dims[2]; z += step) {
        if (job.isStopRequested())
            return cancelledError();
        const std::int64_t zEnd = std::min(z + step, dims[2]);
        const auto slab = std::span(samples).subspan(static_cast<std::size_t>(z) * planeBytes,
                                                     static_cast<std::size_t>(zEnd - z) * planeBytes);
        ISO_TRY(source.readSlab(z, zEnd, slab));
        job.report(static_cast<double>(zEnd) / static_cast<double>(dims[2]), "reading");
    }
    return std::make_shared<const ScalarGrid>(info.geometry, info.type, std::move(samples));
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openVolume(const fs::path& path, const ReadOptions& options) {
    try {
        // Before any library sees the name: a missing file, a folder or a pipe ends here.
        auto file = defaultFileSystem().openForReading(path);
        if (!file.isOk())
            return std::move(file).error();
        if (options.raw)
            return openRaw(path, *options.raw);
        if (file.value()->sizeBytes() == 0)
            return makeError(ErrorCode::InvalidArgument, "is empty", path);
        return openBySuffix(path, options);
    } catch (const std::bad_alloc&) {
        return makeError(ErrorCode::OutOfSpace, "not enough memory to open it", path);
    } catch (const std::exception& problem) {
        return makeError(ErrorCode::InvalidArgument, std::string("cannot be opened: ") + problem.what(), path);
    }
}

Result<std::shared_ptr<const ScalarGrid>> readVolume(const fs::path& path, const ReadOptions& options,
                                                     const JobControl& job) {
    auto source = openVolume(path, options);
    if (!source.isOk())
        return std::move(source).error();
    try {
        if (auto* whole = dynamic_cast<WholeGridSource*>(source.value().get()))
            return whole->grid(job);
        return readSlabs(*source.value(), path, job);
    } catch (const std::bad_alloc&) {
        return makeError(ErrorCode::OutOfSpace, "does not fit in memory", path);
    }
}

Status WholeGridSource::readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
    const auto made = grid({});
    if (!made.isOk())
        return made.error();
    const ScalarGrid& whole = *made.value();
    const auto planeBytes = static_cast<std::size_t>(whole.dims()[0] * whole.dims()[1]) *
                            scalarTypeSizeBytes(whole.type());
    const auto bytes = whole.bytes().subspan(static_cast<std::size_t>(zBegin) * planeBytes,
                                             static_cast<std::size_t>(zEnd - zBegin) * planeBytes);
    ISO_CHECK(bytes.size() == out.size());
    if (!bytes.empty())
        std::memcpy(out.data(), bytes.data(), bytes.size());
    return {};
}

} // namespace isoslider::io
