#include "core/volume_io/sources/sample_volumes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <mutex>

#include <tbb/parallel_for.h>

#include "core/base/folders.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/volume_reader.h"
#include "core/volume_io/volume_writer.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kDefaultSize = 256;

// To be raised when the resampled values change, so that caches of older versions are not used.
constexpr const char* kCacheVersion = "v1";

Result<GridDims> checkedDims(const GridDims& dims) {
    if (dims == GridDims{0, 0, 0})
        return GridDims{kDefaultSize, kDefaultSize, kDefaultSize};
    return checkDims(dims, "dims", {});
}

fs::path cacheFolder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/')
        return fs::path(cache) / "isoslider";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
        return fs::path(home) / ".cache" / "isoslider";
    return {};
}

fs::path cacheFile(const GridDims& dims) {
    const fs::path folder = cacheFolder();
    if (folder.empty())
        return {};
    return folder / ("bluntfin-density-" + std::to_string(dims[0]) + "x" + std::to_string(dims[1]) + "x" +
                     std::to_string(dims[2]) + "-" + kCacheVersion + ".mha");
}

std::shared_ptr<const ScalarGrid> readCache(const fs::path& file, const GridDims& dims) {
    if (file.empty())
        return nullptr;
    auto grid = readVolume(file);
    if (!grid.isOk() || grid.value()->dims() != dims || grid.value()->type() != ScalarType::F32)
        return nullptr;
    return std::move(grid).value();
}

void keep(const ScalarGrid& grid, const fs::path& file) {
    if (file.empty())
        return;
    if (makeFolders(file.parent_path()).isOk())
        static_cast<void>(writeVolume(grid, file)); // or it is resampled again the next time
}

Result<std::shared_ptr<const ScalarGrid>> loadBluntFin(const GridDims& dims, const fs::path& resourcesDir,
                                                       const JobControl& job) {
    const fs::path file = cacheFile(dims);
    if (auto cached = readCache(file, dims))
        return cached;
    ReadOptions options;
    options.resampleDims = dims;
    auto grid = readVolume(resourcesDir / "samples" / "bluntfinxyz.bin", options, job);
    if (grid.isOk())
        keep(*grid.value(), file);
    return grid;
}

} // namespace

std::vector<SampleVolume> sampleVolumes() {
    return {{"bluntfin", "Blunt Fin",
             "Density of the air flow over a flat plate with a blunt fin, resampled from a curvilinear grid."},
            {"shell", "Spherical Shell", "Distance from a sphere, 16 bits: two nested spheres that part and meet."}};
}

Result<std::shared_ptr<const ScalarGrid>> loadSample(std::string_view name, const GridDims& dims,
                                                     const fs::path& resourcesDir, const JobControl& job) {
    const auto checked = checkedDims(dims);
    if (!checked.isOk())
        return checked.error();
    if (name == "bluntfin")
        return loadBluntFin(checked.value(), resourcesDir, job);
    if (name == "shell") {
        auto grid = makeSphericalShell(checked.value(), job);
        if (!grid.isOk())
            return std::move(grid).error();
        return std::make_shared<const ScalarGrid>(std::move(grid).value());
    }
    return makeError(ErrorCode::InvalidArgument,
                     "there is no sample volume " + inQuotes(name) + "; bluntfin and shell are known");
}

Result<ScalarGrid> makeSphericalShell(const GridDims& wanted, const JobControl& job) {
    const auto dims = checkedDims(wanted);
    if (!dims.isOk())
        return dims.error();
    GridGeometry geometry;
    geometry.dims = dims.value();
    const auto [nx, ny, nz] = geometry.dims;
    ISO_TRY(checkFitsMemory(2 * static_cast<std::uint64_t>(pointCount(geometry.dims)), 0, {}));
    const double cx = static_cast<double>(nx) / 2, cy = static_cast<double>(ny) / 2, cz = static_cast<double>(nz) / 2;
    const double radius = 79.1 * static_cast<double>(std::min({nx, ny, nz})) / 256;
    const double top = std::max(radius, std::sqrt(cx * cx + cy * cy + cz * cz) - radius);
    std::vector<std::byte> samples(static_cast<std::size_t>(2 * pointCount(geometry.dims)));
    auto* values = reinterpret_cast<std::uint16_t*>(samples.data());
    std::atomic<std::int64_t> finished = 0;
    std::mutex progressMutex;
    tbb::parallel_for(std::int64_t{0}, nz, [&, nx = nx, ny = ny, nz = nz](std::int64_t z) {
        if (job.isStopRequested())
            return;
        const double dz = static_cast<double>(z) - cz;
        for (std::int64_t y = 0; y < ny; ++y) {
            const double dy = static_cast<double>(y) - cy;
            for (std::int64_t x = 0; x < nx; ++x) {
                const double dx = static_cast<double>(x) - cx;
                const double distance = std::abs(std::sqrt(dx * dx + dy * dy + dz * dz) - radius);
                values[x + nx * (y + ny * z)] = static_cast<std::uint16_t>(std::lround(65535.0 * distance / top));
            }
        }
        const std::scoped_lock lock(progressMutex);
        job.report(static_cast<double>(++finished) / static_cast<double>(nz), "generating");
    });
    if (job.isStopRequested())
        return cancelledError();
    return ScalarGrid(geometry, ScalarType::U16, std::move(samples));
}

} // namespace isoslider::io
