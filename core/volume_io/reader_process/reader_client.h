#pragma once

#include <filesystem>
#include <memory>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::io {

// Libraries parse in a separate process, `isoslider-reader`, which may die of a file without harm: it lies
// beside the program, or in ../libexec/isoslider, or where ISOSLIDER_READER states. One process per volume; it
// ends with its source. Costs some 0.1 s to start, and one copy of the samples through a socket.

// A reader that sends nothing for kReaderSilence, not even that it is alive, is ended. ISOSLIDER_READER_SILENCE is that
// time in seconds for tests.

/// As openInProcess, in a reader process. Further errors: Corruption (the reader died of the file),
/// IoError (there is no reader program; it has hung), Cancelled. A stop request of `job` is also heeded by the source.
Result<std::unique_ptr<VolumeSource>> openInReaderProcess(const std::filesystem::path& path, const ReadOptions& options,
                                                          const JobControl& job = {});
/// As listInProcess, likewise.
Result<VolumeContents> listInReaderProcess(const std::filesystem::path& path, const ReadOptions& options,
                                           const JobControl& job = {});

} // namespace isoslider::io
