#include "ui/model/session/session_slot.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <system_error>

#include "core/base/folders.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

constexpr int kMostTries = 100;
/// A lock without a session is of a program that has just begun, or of one that never came to save.
constexpr auto kOrphanAge = std::chrono::minutes(10);

fs::path lockOf(fs::path session) { return session.replace_extension(".lock"); }

void removeOrphan(const fs::path& lock) {
    const fs::path session = fs::path(lock).replace_extension(kSessionSuffix);
    if (lock.extension() != ".lock" || isPresent(session) ||
        modifiedAt(lock) > fs::file_time_type::clock::now() - kOrphanAge)
        return;
    if (!defaultFileSystem().create(lock).isOk()) // somebody holds it
        return;
    for (const fs::path& file : {partialPath(session), lock})
        static_cast<void>(defaultFileSystem().removeFile(file));
}

} // namespace

Result<std::unique_ptr<SessionSlot>> SessionSlot::create(const fs::path& folder) {
    ISO_TRY(makeFolders(folder));
    const auto start = std::chrono::system_clock::now().time_since_epoch().count();
    for (int attempt = 0;; ++attempt) {
        const std::string name =
            std::to_string(::getpid()) + "-" + std::to_string(start) + "-" + std::to_string(attempt);
        const fs::path path = folder / (name + std::string(kSessionSuffix));
        if (isPresent(lockOf(path)) && attempt < kMostTries)
            continue; // another slot of this very program and moment
        auto lock = defaultFileSystem().create(lockOf(path));
        if (lock.isOk())
            return std::unique_ptr<SessionSlot>(new SessionSlot(path, std::move(lock).value()));
        if (lock.error().code != ErrorCode::InvalidArgument || attempt >= kMostTries)
            return lock.error();
    }
}

std::vector<std::unique_ptr<SessionSlot>> SessionSlot::findLost(const fs::path& folder) {
    std::vector<std::pair<fs::file_time_type, std::unique_ptr<SessionSlot>>> found;
    const auto files = listFiles(folder);
    for (const fs::path& file : files.isOk() ? files.value() : std::vector<fs::path>()) {
        if (!isSessionFile(file)) {
            removeOrphan(file);
            continue;
        }
        auto lock = defaultFileSystem().create(lockOf(file));
        if (lock.isOk())
            found.emplace_back(modifiedAt(file),
                               std::unique_ptr<SessionSlot>(new SessionSlot(file, std::move(lock).value())));
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<std::unique_ptr<SessionSlot>> slots;
    for (auto& [time, slot] : found)
        slots.push_back(std::move(slot));
    return slots;
}

Status SessionSlot::save(const SavedSession& session) {
    const std::lock_guard lock(mutex_);
    return isDiscarded_ ? Status() : writeSession(session, path_);
}

void SessionSlot::discard() {
    const std::lock_guard lock(mutex_);
    isDiscarded_ = true;
    (void)defaultFileSystem().removeFile(path_);
    (void)defaultFileSystem().removeFile(partialPath(path_));
    (void)defaultFileSystem().removeFile(lockOf(path_));
}

} // namespace isoslider::model
