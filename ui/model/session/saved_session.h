#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/extract/merged/merge_bound.h"
#include "core/volume_io/volume_reader.h"
#include "ui/model/isovalue/histogram_options.h"
#include "ui/model/session/named_volume.h"
#include "ui/model/slices/slice_options.h"
#include "ui/model/surface/camera.h"
#include "ui/model/surface/surface_list.h"
#include "ui/model/surface/view_state.h"

namespace isoslider::model {

/// What it takes to show a volume again as it is shown now. Nothing of the volume itself.
struct SavedSession {
    std::filesystem::path volume; ///< absolute; empty for a built-in sample
    std::string sampleName;
    io::ReadOptions readOptions;
    std::optional<double> isovalue; ///< of the active surface
    SurfaceList surfaces; ///< empty: one, as sessions of before have it
    SecondVolumeState second;
    std::optional<double> reference; ///< the isovalue that others are compared with
    std::optional<extract::MergeError> error; ///< within which cells are merged
    std::optional<CameraPose> camera;
    std::optional<ViewOptions> view;
    /// A file of an earlier version states neither: both then stay as they are.
    bool hasStage = true, hasColouring = true;
    std::optional<HistogramOptions> histogram;
    std::optional<HistogramRange> histogramRange; ///< none: the usual one
    std::optional<SliceOptions> slices;

    bool hasVolume() const { return !volume.empty() || !sampleName.empty(); }
};

/// A session file is JSON of at most this.
inline constexpr std::size_t kMostSessionBytes = 1u << 20;
inline constexpr std::string_view kSessionSuffix = ".isosession";

bool isSessionFile(const std::filesystem::path& path);

/// `folder`: where the file will lie. Volumes below it are also named relative to it, so that both can move.
std::string sessionText(const SavedSession& session, const std::filesystem::path& folder);

/// What of a text could be understood. What could not is at its default and named in a line of `problems`.
struct ReadSession {
    SavedSession session;
    std::vector<std::string> problems;
};
ReadSession sessionFromText(const std::string& text, const std::filesystem::path& folder);

/// Errors: those of reading a file; a file that is no session is none, but a ReadSession with problems.
Result<ReadSession> readSession(const std::filesystem::path& path);
/// Appears whole or not at all. Errors: those of writing a file.
Status writeSession(const SavedSession& session, const std::filesystem::path& path);

/// ReadOptions as JSON in one line, for settings; nothing from what is not such a text.
std::string optionsText(const io::ReadOptions& options);
std::optional<io::ReadOptions> optionsFromText(const std::string& text);

} // namespace isoslider::model
