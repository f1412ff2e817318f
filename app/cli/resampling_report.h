#pragma once

#include <optional>
#include <string>

#include "app/cli/output.h"
#include "core/volume_io/sources/volume_source.h"

namespace isoslider::cli {

/// Sets "resampled" of a volume that was: what that lost, in numbers and as a line of text.
void addResampling(const io::VolumeInfo& info, Json& json);
/// The same of an index, which keeps the line only.
void addResampling(const std::string& line, Json& json);

/// As io::lossText; empty if nothing was resampled.
std::string resamplingText(const io::VolumeInfo& info);

} // namespace isoslider::cli
