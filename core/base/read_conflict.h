#pragma once

#include <filesystem>
#include <vector>

namespace isoslider {

/// What writing a file would do to files that are read.
enum class ReadConflict {
    None,
    Itself, ///< it is one of them
    Partial, ///< what is written beside it first, before it takes its name, is one of them
};

/// Links are followed. Questions that the system does not answer are no conflict.
ReadConflict conflictWith(const std::filesystem::path& output, const std::vector<std::filesystem::path>& read);

/// The same where a folder is read, and which of its files is not known: those that are there.
ReadConflict conflictWithFolder(const std::filesystem::path& output, const std::filesystem::path& folder);

} // namespace isoslider
