#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/job_control.h"
#include "core/extract/slide_engine.h"
#include "core/grid/scalar_grid.h"
#include "core/index/index_info.h"
#include "core/volume_io/volume_reader.h"
#include "ui/model/index_cache.h"

namespace isoslider::model {

/// What the window knows of the volume that is open.
struct Dataset {
    std::string name;                 ///< file name or sample title
    std::filesystem::path path;       ///< empty for samples
    std::string format;
    std::string fieldName;
    GridGeometry geometry;
    ScalarType type = ScalarType::U8;
    double min = 0.0;
    double max = 0.0;
    std::uint64_t distinctValues = 0; ///< 0: not counted yet
    std::uint64_t missingSamples = 0;
    index::Histogram histogram;
    std::filesystem::path indexPath;  ///< where the index is or will be
    std::optional<index::IndexInfo> index;

    std::uint64_t sampleBytes() const;
    double bytesPerVoxel() const;     ///< of the index; 0 without one
};

/// What to open: a file (a volume or an index), or a built-in sample by name.
struct OpenRequest {
    std::filesystem::path path;
    std::string sampleName;
    io::ReadOptions readOptions;
    std::optional<double> isovalue;   ///< the first isovalue; otherwise a suggested one
};

/// Makes a built-in sample volume.
using SampleLoader =
    std::function<Result<std::shared_ptr<const ScalarGrid>>(const std::string& name, const JobControl&)>;

/// A dataset with what it takes to draw it: exactly one of grid and engine is set.
struct LoadedDataset {
    Dataset dataset;
    std::shared_ptr<const ScalarGrid> grid;
    std::unique_ptr<extract::SlideEngine> engine;
    double isovalue = 0.0;
};

bool isIndexFile(const std::filesystem::path& path);
/// The name to show for a request before anything is read.
std::string displayName(const OpenRequest& request);

/// Opens a volume, or its index from the cache if there is one, or an index file. Worker thread.
/// Errors: whatever reading reports; InvalidArgument if no sample is finite.
Result<LoadedDataset> loadDataset(const OpenRequest& request, const IndexCache& cache,
                                  const SampleLoader& samples, const JobControl& job);

} // namespace isoslider::model
