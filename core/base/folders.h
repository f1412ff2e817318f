#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace isoslider {

/// What is asked of the disk beside the bytes of files. Questions follow symbolic links and answer no where the system
/// gives no answer.
bool isPresent(const std::filesystem::path& path);
bool isFolder(const std::filesystem::path& path);
bool isSameFile(const std::filesystem::path& a, const std::filesystem::path& b);
/// A file itself, not a link to one.
bool isPlainFile(const std::filesystem::path& path);
/// The least time there is where the system gives none.
std::filesystem::file_time_type modifiedAt(const std::filesystem::path& path);

/// With links followed as far as the path exists. Errors: IoError (links in a circle, no permission).
Result<std::filesystem::path> canonicalPath(const std::filesystem::path& path);
/// The folder of the running program; empty where the system does not report it.
std::filesystem::path programFolder();

/// Where files that are soon gone may lie.
std::filesystem::path temporaryFolder();

/// A new folder below another one that only this user may look into. Errors: NotFound, OutOfSpace, IoError.
Result<std::filesystem::path> makeUniqueFolder(const std::filesystem::path& parent, const std::string& name);
/// With all that is in it, as far as that can be.
void removeFolder(const std::filesystem::path& folder);

/// Makes a folder and those above it, unless they are there. Errors: OutOfSpace, IoError.
Status makeFolders(const std::filesystem::path& folder);

struct FolderSearch {
    int depth = 0; ///< folders below folders: 0, none
    std::size_t most = 1u << 20; ///< entries returned; the search ends there
};
/// Regular files of a folder, and links to such, sorted by path; folders that may not be read are left out.
/// Errors: NotFound, IoError.
Result<std::vector<std::filesystem::path>> listFiles(const std::filesystem::path& folder,
                                                     const FolderSearch& search = {});

} // namespace isoslider
