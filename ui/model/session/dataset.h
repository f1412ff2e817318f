#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/job_control.h"
#include "core/extract/slide_engine.h"
#include "core/grid/scalar_grid.h"
#include "core/grid/value_distribution.h"
#include "core/index/format/index_info.h"
#include "core/volume_io/volume_reader.h"
#include "ui/model/jobs/index_builder.h"
#include "ui/model/opening/volume_access.h"
#include "ui/model/session/index_cache.h"
#include "ui/model/topology/suggested_isovalue.h"

namespace isoslider::model {

/// Names a volume that was opened: differs between any two of a session. Zero is none.
enum class DatasetGeneration : std::uint64_t {};

/// What the window knows of the volume that is open.
struct Dataset {
    std::string name; ///< file name or sample title
    std::filesystem::path path; ///< empty for samples
    std::string sampleName; ///< of a built-in sample
    io::ReadOptions readOptions; ///< what `path` was opened with
    std::string format;
    std::string fieldName;
    std::string fieldTitle; ///< the same for people; empty: the name will do
    std::string lengthUnit; ///< of spacing and origin; empty: unknown
    bool statesPatientSpace = false; ///< see io::VolumeInfo::isPatientSpace
    std::vector<std::string> notes; ///< what the reader had to assume or leave out, one line each
    std::optional<io::ResampleReport> resampling; ///< what a grid that is not uniform lost when it was read
    GridGeometry geometry; ///< of the whole volume
    ScalarType type = ScalarType::U8;
    /// Above 1: min, max, missingSamples and histogram are those of every coarseStep-th sample along each
    /// axis until the index is there.
    std::int64_t coarseStep = 1;
    double min = 0.0;
    double max = 0.0;
    std::uint64_t distinctValues = 0; ///< 0: not counted yet
    std::uint64_t missingSamples = 0;
    Histogram histogram;
    std::shared_ptr<const ValueDistribution>
        values; ///< never null once it is open; of the whole volume, of some of an index, or of a preview
    std::filesystem::path indexPath; ///< where the index is or will be
    std::optional<VolumeStamp> stamp; ///< of the volume's files before they were read; none of samples and indexes
    std::optional<index::IndexInfo> index;

    /// REQUIRES: values are there.
    SuggestedRange suggestedRange() const { return {values->body.min, values->body.max, type}; }
    std::uint64_t sampleBytes() const;
    double bytesPerVoxel() const; ///< of the index; 0 without one
};

/// Of the samples; none differ of no volume.
inline ValueSpread spreadOf(const Dataset* dataset) { return dataset ? dataset->values->spread : ValueSpread(); }

/// Whether the world's axes are a patient's: towards left, posterior, superior.
bool isPatientSpace(const Dataset& dataset);

/// What to open: a file (a volume or an index), or a built-in sample by name.
struct OpenRequest {
    std::filesystem::path path;
    std::string sampleName;
    io::ReadOptions readOptions;
    std::optional<AskedIsovalue> isovalue; ///< the first isovalue; otherwise a suggested one
    /// A file of several volumes is not an error: Session::choiceNeeded reports what it holds.
    bool asksForChoice = false;
};

/// Makes a built-in sample volume.
using SampleLoader =
    std::function<Result<std::shared_ptr<const ScalarGrid>>(const std::string& name, const JobControl&)>;

/// A dataset with what it takes to draw it: exactly one of grid and engine is set. The grid has
/// dataset.coarseStep: it is the whole volume, or a preview of it.
struct LoadedDataset {
    Dataset dataset;
    std::shared_ptr<const ScalarGrid> grid;
    std::unique_ptr<extract::SlideEngine> engine;
    SuggestedIsovalue first; ///< the isovalue asked for, or the best one known
    bool isFirstBest = false; ///< by its topology
    std::string refusal; ///< why the isovalue asked for has no value; empty if it has one, or none was asked for
};

/// Most samples of a preview: what a machine reads and shows within seconds.
inline constexpr std::uint64_t kMostPreviewSamples = 24'000'000;

/// Distinguishes readings of one file, in the cache of indexes.
std::string layoutText(const io::ReadOptions& options);

bool isIndexFile(const std::filesystem::path& path);
/// The name to show for a request before anything is read.
std::string displayName(const OpenRequest& request);
/// What the names of files made from it begin with: its name without suffix, as in "brain" of brain.nii.gz.
std::string fileStem(const Dataset& dataset);

/// What the index states of its volume takes the place of what was known before.
void adoptIndex(Dataset& dataset, const index::IndexInfo& info);

/// Of an index that is just being opened, few samples are counted, so that it shows at once; later, up to so many.
inline constexpr std::uint64_t kFirstCountedSamples = 16'000'000;
inline constexpr std::uint64_t kMostCountedSamples = 1'000'000'000;

/// Of the samples of an index; as far as `info` tells if they cannot be read.
ValueDistribution valuesOfIndex(const std::filesystem::path& path, const index::IndexInfo& info,
                                std::uint64_t mostSamples, const JobControl& job = {});

/// Opens a volume, or its index from the cache if there is one, or an index file. Worker thread. Of a file
/// whose samples take more than `wholeVolumeBytes`, and that has no index yet, a preview is read: the finest
/// of at most kMostPreviewSamples that fits in `wholeVolumeBytes`. Errors: whatever reading reports;
/// InvalidArgument if no sample is finite; OutOfSpace if no preview fits.
Result<LoadedDataset> loadDataset(const OpenRequest& request, const IndexCache& cache, const SampleLoader& samples,
                                  std::uint64_t wholeVolumeBytes, const JobControl& job,
                                  const VolumeAccess& volumes = {});

/// Builds the index of a volume in the cache, from its samples or, of a preview, from its file; records what it was
/// built from; and has the cache keep to its limit. Errors: those of IndexBuilder; OutOfSpace, IoError.
Status buildIndexOf(const Dataset& volume, const std::shared_ptr<const ScalarGrid>& grid, IndexBuilder& builder,
                    const IndexCache& cache, const JobControl& job);

} // namespace isoslider::model
