#pragma once

#include <filesystem>

#include "core/volume_io/formats/format_readers.h"

namespace isoslider::fuzz {

/// Lists what is in a file and opens it in some of the ways that it offers; reads what is small
/// enough, forwards and once again from the start. Aborts unless listing and opening agree, errors are one line, and
/// the same samples come both times.
/// `list` may be null, as in io::Format.
void requireVolumePromises(io::OpenFormat* open, io::ListFormat* list, const std::filesystem::path& path,
                           const io::ReadOptions& options = {});

} // namespace isoslider::fuzz
