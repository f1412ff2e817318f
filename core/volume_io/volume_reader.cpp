#include "core/volume_io/volume_reader.h"

#include <algorithm>
#include <new>

#include "core/base/build_leftovers.h"
#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/base/guarded.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/reader_process/reader_client.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kSlabBytes = std::uint64_t{16} << 20;

// Missing files, pipes, devices and empty files end here, before any library sees the name.
Status checkInput(const fs::path& path, bool isRaw) {
    if (!isRaw && isFolder(path))
        return {};
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    ISO_TRY(checkIsNoLeftover(path));
    if (!isRaw && file.value()->sizeBytes() == 0)
        return makeError(ErrorCode::InvalidArgument, "is empty", path);
    return {};
}

ThrownErrors errorsOfOpening(const fs::path& path) {
    return {"not enough memory to open it", ErrorCode::InvalidArgument, "cannot be opened", path};
}

Result<std::shared_ptr<const ScalarGrid>> readSlabs(VolumeSource& source, const fs::path& path, const JobControl& job) {
    const VolumeInfo& info = source.info();
    const GridDims& dims = info.geometry.dims;
    const std::uint64_t planeBytes = static_cast<std::uint64_t>(dims[0] * dims[1]) * scalarTypeSizeBytes(info.type);
    const std::uint64_t totalBytes = planeBytes * static_cast<std::uint64_t>(dims[2]);
    ISO_TRY(checkFitsMemory(totalBytes, 0, path));
    std::vector<std::byte> samples; // grows as samples come: packed data may hold fewer than its header states
    const auto step = static_cast<std::int64_t>(std::max<std::uint64_t>(1, kSlabBytes / planeBytes));
    for (std::int64_t z = 0; z < dims[2]; z += step) {
        if (job.isStopRequested())
            return cancelledError();
        const std::int64_t zEnd = std::min(z + step, dims[2]);
        if (z > 0) // the first slab is there: so is the rest, likely
            samples.reserve(totalBytes);
        samples.resize(static_cast<std::size_t>(zEnd) * planeBytes);
        const auto slab = std::span(samples).subspan(static_cast<std::size_t>(z) * planeBytes,
                                                     static_cast<std::size_t>(zEnd - z) * planeBytes);
        ISO_TRY(source.readSlab(z, zEnd, slab));
        job.report(static_cast<double>(zEnd) / static_cast<double>(dims[2]), "reading");
    }
    return std::make_shared<const ScalarGrid>(info.geometry, info.type, std::move(samples));
}

// What came from a file that changed meanwhile is of neither version.
Result<std::shared_ptr<const ScalarGrid>> unchanged(const VolumeSource& source,
                                                    Result<std::shared_ptr<const ScalarGrid>> grid) {
    if (grid.isOk())
        ISO_TRY(source.checkUnchanged());
    return grid;
}

Result<std::unique_ptr<VolumeSource>> open(const fs::path& path, const ReadOptions& options, const JobControl& job) {
    const OpenAs openAs = [&](const Format& format) {
        return format.open != nullptr ? format.open(path, options) : openInReaderProcess(path, options, job);
    };
    return openBy(openAs, path, options);
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openBy(const OpenAs& openAs, const fs::path& path, const ReadOptions& options) {
    using Opened = Result<std::unique_ptr<VolumeSource>>;
    return guarded(errorsOfOpening(path), [&]() -> Opened {
        ISO_TRY(checkInput(path, options.raw.has_value()));
        if (options.raw)
            return openRaw(path, options);
        const auto format = findFormat(path);
        if (!format.isOk())
            return format.error();
        return openAs(*format.value());
    });
}

Result<VolumeContents> listBy(const ListAs& listAs, const fs::path& path, const ReadOptions& options) {
    return guarded(errorsOfOpening(path), [&]() -> Result<VolumeContents> {
        ISO_TRY(checkInput(path, options.raw.has_value()));
        if (options.raw)
            return listByOpening(openRaw, path, options);
        const auto format = findFormat(path);
        if (!format.isOk())
            return format.error();
        return listAs(*format.value());
    });
}

Result<std::unique_ptr<VolumeSource>> openVolume(const fs::path& path, const ReadOptions& options,
                                                 const JobControl& job) {
    FileWatch files;
    files.add(path);
    auto source = open(path, options, job);
    if (!source.isOk())
        return source;
    std::vector<fs::path> read = source.value()->info().dataFiles;
    if (!isFolder(path))
        read.push_back(path);
    if (!read.empty()) // else all of the folder's
        files.keepOnly(read);
    source.value()->watch(std::move(files));
    return source;
}

Result<VolumeContents> listVolumes(const fs::path& path, const ReadOptions& options, const JobControl& job) {
    const ListAs listAs = [&](const Format& format) {
        return format.list != nullptr ? format.list(path, options) : listInReaderProcess(path, options, job);
    };
    return listBy(listAs, path, options);
}

Result<std::shared_ptr<const ScalarGrid>> readVolume(const fs::path& path, const ReadOptions& options,
                                                     const JobControl& job) {
    auto source = openVolume(path, options, job);
    if (!source.isOk())
        return std::move(source).error();
    return readVolume(*source.value(), path, job);
}

Result<std::shared_ptr<const ScalarGrid>> readVolume(VolumeSource& source, const fs::path& path,
                                                     const JobControl& job) {
    try {
        if (auto* whole = dynamic_cast<WholeGridSource*>(&source))
            return unchanged(source, whole->grid(job));
        ISO_TRY(source.prepare(job));
        return unchanged(source, readSlabs(source, path, job));
    } catch (const std::bad_alloc&) {
        return makeError(ErrorCode::OutOfSpace, "does not fit in memory", path);
    }
}

} // namespace isoslider::io
