#pragma once

#include "core/volume_io/volume_contents.h"

namespace isoslider::io {

/// Refuses a file in which there is nothing to choose from.
Status checkAnyField(const VolumeContents& contents, const std::filesystem::path& path);

/// Index of the field that the options name or, if they name none, of the one there is to take. Refuses one with a
/// problem, and a choice that is not made, naming what there is.
Result<std::size_t> chooseField(const VolumeContents& contents, const ReadOptions& options,
                                const std::filesystem::path& path);

/// What of a field is taken.
struct Choice {
    int component = 0; ///< or kMagnitude
    std::int64_t frame = 0;
};

/// The component and frame that `options` choose. Nothing needs to be chosen where there is only one.
/// Errors: InvalidArgument, naming the option and its range: not chosen, or not there.
Result<Choice> chooseIn(const VolumeField& field, const ReadOptions& options, const std::filesystem::path& path);

/// The same for files that have one field: if one is named, it has to be that.
Result<Choice> chooseInOnlyField(const VolumeField& field, const ReadOptions& options,
                                 const std::filesystem::path& path);

} // namespace isoslider::io
