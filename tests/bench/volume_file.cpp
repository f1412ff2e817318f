#include "tests/bench/volume_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string_view>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "core/base/file_system.h"
#include "tests/bench/timing.h"

namespace isoslider::bench {
namespace {

constexpr std::size_t kCopyBytes = std::size_t{4} << 20; // at a time
constexpr std::int64_t kPassPlanes = 16;
constexpr std::size_t kLeastRepeats = 3, kMostRepeats = 7;
constexpr double kRepeatedMs = 2000; // more than the least, where that takes less

Result<double> copySeconds(const VolumeFile& file, bool isSynced) {
    FileSystem& disk = defaultFileSystem();
    const std::filesystem::path copy = file.path.string() + ".copy";
    const auto run = [&]() -> Status {
        const auto from = disk.openForReading(file.path);
        if (!from.isOk())
            return from.error();
        const auto to = disk.create(copy);
        if (!to.isOk())
            return to.error();
        std::vector<std::byte> buffer(kCopyBytes);
        for (std::uint64_t at = 0, size = from.value()->sizeBytes(); at < size; at += buffer.size()) {
            buffer.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kCopyBytes, size - at)));
            ISO_TRY(from.value()->readExactlyAt(at, buffer));
            ISO_TRY(to.value()->writeAll(buffer));
        }
        if (isSynced)
            ISO_TRY(to.value()->sync());
        return to.value()->close();
    };
    const double start = nowMs();
    const Status copied = run();
    const double seconds = 1e-3 * (nowMs() - start);
    ISO_TRY(disk.removeFile(copy));
    if (!copied.isOk())
        return copied.error();
    return seconds;
}

template <class Sample>
std::pair<Sample, Sample> spanOf(std::span<const Sample> samples) {
    using Span = std::pair<Sample, Sample>;
    const auto joined = [](const Span& a, const Span& b) {
        return Span{std::min(a.first, b.first), std::max(a.second, b.second)};
    };
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, samples.size(), 1 << 16), Span{samples.front(), samples.front()},
        [&](const tbb::blocked_range<std::size_t>& range, Span span) {
            Sample least = span.first, greatest = span.second; // on their own, for whole vectors
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                least = std::min(least, samples[i]);
                greatest = std::max(greatest, samples[i]);
            }
            return Span{least, greatest};
        },
        joined);
}

Result<double> passSeconds(const VolumeFile& file) {
    const double start = nowMs();
    auto source = io::openVolume(file.path, file.readOptions());
    if (!source.isOk())
        return std::move(source).error();
    const std::size_t plane = static_cast<std::size_t>(file.dims[0] * file.dims[1]) * scalarTypeSizeBytes(file.type);
    std::vector<std::byte> slab;
    volatile double found = 0.0; // or the compiler might leave all of it out
    for (std::int64_t z = 0; z < file.dims[2]; z += kPassPlanes) {
        const std::int64_t end = std::min(z + kPassPlanes, file.dims[2]);
        slab.resize(static_cast<std::size_t>(end - z) * plane);
        ISO_TRY(source.value()->readSlab(z, end, slab));
        visitScalarType(file.type, [&](auto sample) {
            using Sample = decltype(sample);
            const auto [least, greatest] = spanOf(
                std::span<const Sample>(reinterpret_cast<const Sample*>(slab.data()), slab.size() / sizeof(Sample)));
            found = static_cast<double>(least) + static_cast<double>(greatest);
        });
    }
    return 1e-3 * (nowMs() - start);
}

} // namespace

io::ReadOptions VolumeFile::readOptions() const {
    io::ReadOptions options;
    options.raw.emplace();
    options.raw->dims = dims;
    options.raw->type = type;
    return options;
}

Result<VolumeFile> writeVolumeFile(const ScalarGrid& grid, const std::filesystem::path& path) {
    auto file = defaultFileSystem().create(path);
    if (!file.isOk())
        return std::move(file).error();
    ISO_TRY(file.value()->writeAll(grid.bytes()));
    ISO_TRY(file.value()->sync());
    ISO_TRY(file.value()->close());
    return VolumeFile{path, grid.dims(), grid.type()};
}

Result<VolumeFile> volumeFileFromArguments(std::span<char* const> arguments) {
    VolumeFile file;
    file.path = arguments[0];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::string_view text = arguments[axis + 1];
        const auto parsed = std::from_chars(text.data(), text.data() + text.size(), file.dims[axis]);
        if (parsed.ec != std::errc{} || file.dims[axis] < 1)
            return makeError(ErrorCode::InvalidArgument, "not an extent", std::string(text));
    }
    const auto type = scalarTypeFromName(arguments[4]);
    if (!type)
        return makeError(ErrorCode::InvalidArgument, "no such type of sample", arguments[4]);
    file.type = *type;
    return file;
}

ScalarGrid sampledCoarser(const ScalarGrid& grid, std::int64_t stride) {
    GridGeometry geometry = grid.geometry();
    for (auto& dim : geometry.dims)
        dim = (dim + stride - 1) / stride;
    return grid.visit([&](auto samples) {
        using Sample = std::remove_cv_t<typename decltype(samples)::element_type>;
        std::vector<std::byte> bytes(static_cast<std::size_t>(pointCount(geometry.dims)) * sizeof(Sample));
        auto* out = reinterpret_cast<Sample*>(bytes.data());
        const auto [nx, ny, nz] = grid.dims();
        for (std::int64_t z = 0; z < nz; z += stride)
            for (std::int64_t y = 0; y < ny; y += stride)
                for (std::int64_t x = 0; x < nx; x += stride)
                    *out++ = samples[static_cast<std::size_t>(x + nx * (y + ny * z))];
        return ScalarGrid(geometry, grid.type(), std::move(bytes));
    });
}

Yardstick meanOf(const Yardstick& first, const Yardstick& second) {
    return {0.5 * (first.copy + second.copy), 0.5 * (first.copySynced + second.copySynced),
            0.5 * (first.pass + second.pass)};
}

// Passes and copies take turns: what else the machine does meanwhile meets all of them alike. The first pass
// is the first to touch the file, so that the copies find it in memory.
Result<Yardstick> measureYardstick(const VolumeFile& file) {
    std::vector<double> passes, copies, synced;
    const double start = nowMs();
    const auto isDone = [&] {
        const std::size_t done = passes.size();
        return done >= kMostRepeats || (done >= kLeastRepeats && nowMs() - start > kRepeatedMs);
    };
    while (!isDone()) {
        const auto pass = passSeconds(file);
        const auto copy = copySeconds(file, false), syncedCopy = copySeconds(file, true);
        for (const auto* seconds : {&pass, &copy, &syncedCopy})
            if (!seconds->isOk())
                return seconds->error();
        passes.push_back(pass.value());
        copies.push_back(copy.value());
        synced.push_back(syncedCopy.value());
    }
    return Yardstick{spreadOf(copies).median, spreadOf(synced).median, spreadOf(passes).median};
}

void dropFromMemory(const std::filesystem::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return;
    (void)::posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
    ::close(file);
}

} // namespace isoslider::bench
