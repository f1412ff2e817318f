#pragma once

#include <filesystem>

#include "app/cli/input_kind.h"
#include "app/cli/options.h"
#include "app/cli/outcome.h"

namespace isoslider::cli {

/// Refuses options that describe volumes where the input is an index (wrong usage).
Outcome checkVolumeOptions(const VolumeOptions& options, InputKind kind, const std::filesystem::path& path);

/// Refuses a size for resampling where no grid of the input that may be taken is resampled (wrong usage). Costs a look
/// at the volume's header where a size is given. Errors: as io::listVolumes.
Outcome checkResampling(const io::ReadOptions& options, const std::filesystem::path& path, const JobControl& job);

} // namespace isoslider::cli
