#pragma once

#include <filesystem>

#include "core/volume_io/volume_reader.h"

namespace isoslider::cli {

enum class InputKind { Volume, Index };

/// What a file is, by its content: an index begins with its magic bytes, whatever its name. A
/// file named .isx that is neither an index nor a volume counts as an index, so that its refusal
/// speaks of an index, unless it is to be read as headerless samples. A folder counts as a volume: a series of slices.
/// Errors: NotFound, IoError, InvalidArgument (a FIFO or device).
Result<InputKind> sniffInput(const std::filesystem::path& path, const io::ReadOptions& options = {});

} // namespace isoslider::cli
