#include "ui/model/session/read_files.h"

#include "core/base/folders.h"
#include "core/base/read_conflict.h"
#include "ui/model/session/dataset.h"

namespace isoslider::model {
namespace fs = std::filesystem;

ReadFiles::ReadFiles(std::initializer_list<const Dataset*> volumes) {
    for (const Dataset* volume : volumes)
        if (volume != nullptr)
            add(*volume);
}

void ReadFiles::add(const Dataset& volume) {
    if (!volume.indexPath.empty())
        files_.push_back(volume.indexPath);
    if (volume.path.empty()) // of a sample
        return;
    files_.push_back(volume.path);
    folders_.push_back(volume.path); // if it is one
    if (!volume.stamp)
        return;
    const auto parts = volume.stamp->files();
    files_.insert(files_.end(), parts.begin(), parts.end());
}

Status ReadFiles::checkNotReplacedBy(const fs::path& output) const {
    bool isRead = conflictWith(output, files_) != ReadConflict::None;
    for (const fs::path& folder : folders_)
        isRead = isRead || (isFolder(folder) && conflictWithFolder(output, folder) != ReadConflict::None);
    if (!isRead)
        return {};
    return makeError(ErrorCode::InvalidArgument, "is a file that the open volume is read from; choose another name",
                     output);
}

} // namespace isoslider::model
