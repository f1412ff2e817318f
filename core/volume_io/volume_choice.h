#pragma once

#include "core/volume_io/volume_contents.h"

namespace isoslider::io {

/// What of a field is taken.
struct Choice {
    int component = 0; ///< or kMagnitude
    std::int64_t frame = 0;
};

/// The component and frame that `options` choose. Nothing needs to be chosen where there is only one.
/// Errors: InvalidArgument, naming the option and its range: not chosen, or not there.
Result<Choice> chooseIn(const VolumeField& field, const ReadOptions& options,
                        const std::filesystem::path& path);

/// The same for files that have one field: if one is named, it has to be that.
Result<Choice> chooseInOnlyField(const VolumeField& field, const ReadOptions& options,
                                 const std::filesystem::path& path);

} // namespace isoslider::io
