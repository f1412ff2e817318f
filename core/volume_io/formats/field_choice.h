#pragma once

#include "core/volume_io/volume_contents.h"

namespace isoslider::io {

/// Refuses a file in which there is nothing to choose from.
Status checkAnyField(const VolumeContents& contents, const std::filesystem::path& path);

/// Index of the field that the options name or, if they name none, of the one there is to take. Refuses one with a
/// problem, and a choice that is not made, naming what there is.
Result<std::size_t> chooseField(const VolumeContents& contents, const ReadOptions& options,
                                const std::filesystem::path& path);

/// From 0, within the field's frames. Refuses a series of which none is chosen.
Result<std::int64_t> chooseFrame(const VolumeField& field, const ReadOptions& options,
                                 const std::filesystem::path& path);

/// From 0, within the field's components, or kMagnitude. Refuses several of which none is chosen.
Result<int> chooseComponent(const VolumeField& field, const ReadOptions& options, const std::filesystem::path& path);

} // namespace isoslider::io
