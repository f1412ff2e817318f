#include "core/base/folders.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>

#include "core/base/file_system.h"

namespace isoslider {
namespace fs = std::filesystem;

bool isPresent(const fs::path& path) {
    std::error_code ignored;
    return fs::exists(path, ignored);
}

bool isFolder(const fs::path& path) {
    std::error_code ignored;
    return fs::is_directory(path, ignored);
}

bool isSameFile(const fs::path& a, const fs::path& b) {
    std::error_code ignored;
    return fs::equivalent(a, b, ignored);
}

bool isPlainFile(const fs::path& path) {
    std::error_code ignored;
    return fs::symlink_status(path, ignored).type() == fs::file_type::regular;
}

fs::file_time_type modifiedAt(const fs::path& path) {
    std::error_code ignored;
    return fs::last_write_time(path, ignored); // the least where there is none
}

Result<fs::path> canonicalPath(const fs::path& path) {
    std::error_code problem;
    fs::path canonical = fs::weakly_canonical(path.empty() ? fs::path(".") : path, problem);
    if (problem)
        return systemError(problem.value(), "cannot resolve", path);
    return canonical;
}

fs::path programFolder() {
    std::error_code ignored;
    return fs::read_symlink("/proc/self/exe", ignored).parent_path();
}

fs::path temporaryFolder() {
    std::error_code problem;
    const fs::path folder = fs::temp_directory_path(problem);
    return problem ? fs::path("/tmp") : folder;
}

Result<fs::path> makeUniqueFolder(const fs::path& parent, const std::string& name) {
    std::string pattern = (parent / (name + "-XXXXXX")).string();
    if (::mkdtemp(pattern.data()) == nullptr)
        return systemError(errno, "cannot make a folder in", parent);
    return fs::path(pattern);
}

void removeFolder(const fs::path& folder) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
}

Status makeFolders(const fs::path& folder) {
    std::error_code problem;
    fs::create_directories(folder, problem);
    return problem ? Status(systemError(problem.value(), "cannot make the folder", folder)) : Status();
}

Result<std::vector<fs::path>> listFiles(const fs::path& folder, const FolderSearch& search) {
    std::vector<fs::path> files;
    std::error_code problem, ignored;
    fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, problem);
    for (const fs::recursive_directory_iterator end; !problem && entry != end; entry.increment(problem)) {
        if (entry.depth() >= search.depth)
            entry.disable_recursion_pending();
        if (!entry->is_regular_file(ignored))
            continue;
        if (files.size() == search.most)
            break;
        files.push_back(entry->path());
    }
    if (problem)
        return systemError(problem.value(), "cannot list", folder);
    std::sort(files.begin(), files.end());
    return files;
}

} // namespace isoslider
