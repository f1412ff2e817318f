#include "tests/bench/prepared_index.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "core/extract/full_extraction.h"
#include "core/grid/classification.h"
#include "core/index/index_reader.h"
#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "tests/bench/timing.h"

namespace isoslider::bench {

double sortSeconds(const ScalarGrid& grid) {
    return grid.visit([](auto samples) {
        using Sample = std::remove_cv_t<typename decltype(samples)::element_type>;
        std::vector<std::pair<Sample, std::uint32_t>> pairs;
        pairs.reserve(samples.size());
        for (std::size_t i = 0; i < samples.size(); ++i)
            if (!isMissing(samples[i]))
                pairs.emplace_back(samples[i], static_cast<std::uint32_t>(i));
        const double start = nowMs();
        std::sort(pairs.begin(), pairs.end());
        return 1e-3 * (nowMs() - start);
    });
}

Result<PreparedIndex> prepareIndex(const BenchVolume& volume, const std::filesystem::path& folder,
                                   bool reuses, int threads) {
    PreparedIndex prepared;
    prepared.path = folder / (volume.name + ".isx");
    if (reuses && std::filesystem::exists(prepared.path)) {
        auto reader = index::IndexReader::open(prepared.path);
        if (!reader.isOk())
            return std::move(reader).error();
        prepared.info = reader.value()->info();
        return prepared;
    }
    const double sortBefore = sortSeconds(*volume.grid);
    const auto source = io::makeMemorySource(volume.grid);
    preprocess::BuildOptions options;
    options.sourceName = volume.name;
    options.threads = threads;
    const double start = nowMs();
    auto report = preprocess::buildIndex(*source, prepared.path, options);
    prepared.buildSeconds = 1e-3 * (nowMs() - start);
    if (!report.isOk())
        return std::move(report).error();
    prepared.sortSeconds = 0.5 * (sortBefore + sortSeconds(*volume.grid));
    prepared.info = report.value().info;
    prepared.wasBuilt = true;
    return prepared;
}

Result<double> firstPictureSeconds(const BenchVolume& volume, const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / (volume.name + ".first_picture.raw");
    {
        const auto bytes = volume.grid->bytes();
        std::ofstream file(path, std::ios::binary);
        file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        if (!file.flush())
            return makeError(ErrorCode::IoError, "cannot write the volume", path.string());
    }
    io::ReadOptions options;
    options.raw.emplace();
    options.raw->dims = volume.grid->dims();
    options.raw->type = volume.grid->type();
    const double start = nowMs();
    auto grid = io::readVolume(path, options);
    if (!grid.isOk())
        return std::move(grid).error();
    auto mesh = extract::extractFull(*grid.value(), volume.centre);
    const double seconds = 1e-3 * (nowMs() - start);
    std::filesystem::remove(path);
    if (!mesh.isOk())
        return std::move(mesh).error();
    return seconds;
}

void dropFromMemory(const std::filesystem::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return;
    (void)::posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
    ::close(file);
}

} // namespace isoslider::bench
