#include "tests/bench/prepared_index.h"

#include <algorithm>
#include <utility>

#include "core/extract/full_extraction.h"
#include "core/grid/classification.h"
#include "core/index/index_reader.h"
#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "tests/bench/timing.h"
#include "tests/bench/volume_file.h"

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

Result<PreparedIndex> prepareIndex(const BenchVolume& volume, const PrepareOptions& wanted) {
    PreparedIndex prepared;
    prepared.path = wanted.folder / (volume.name + "." + index::indexKindName(wanted.kind) + ".isx");
    if (wanted.reuses && std::filesystem::exists(prepared.path)) {
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
    options.kind = wanted.kind;
    options.threads = wanted.threads;
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
    const auto file = writeVolumeFile(*volume.grid, path);
    if (!file.isOk())
        return file.error();
    const double start = nowMs();
    auto grid = io::readVolume(path, file.value().readOptions());
    if (!grid.isOk())
        return std::move(grid).error();
    auto mesh = extract::extractFull(*grid.value(), volume.centre);
    const double seconds = 1e-3 * (nowMs() - start);
    std::filesystem::remove(path);
    if (!mesh.isOk())
        return std::move(mesh).error();
    return seconds;
}

} // namespace isoslider::bench
