#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "core/base/file_system.h"
#include "ui/model/session/saved_session.h"

namespace isoslider::model {

/// Where one running program keeps its session, so that it can be offered again should the program not end as it
/// ought to. Each program has a separate slot: a session file, and beside it a lock that is held as long as the
/// program lives. A session without a holder of its lock is one that was lost. Any thread.
class SessionSlot {
public:
    /// A fresh one. Makes the folder. Errors: those of making files.
    static Result<std::unique_ptr<SessionSlot>> create(const std::filesystem::path& folder);
    /// Those that programs left behind, the newest first, each held from here on: no other program is offered it.
    /// Removes what no session is in.
    static std::vector<std::unique_ptr<SessionSlot>> findLost(const std::filesystem::path& folder);

    const std::filesystem::path& path() const { return path_; }
    /// Whole or not at all: a program killed meanwhile leaves the session before.
    /// Nothing once it is discarded.
    Status save(const SavedSession& session);
    Result<ReadSession> read() const { return readSession(path_); }
    /// Nothing is left to offer. Waits for a save that is running.
    void discard();

private:
    SessionSlot(std::filesystem::path path, std::unique_ptr<WritableFile> lock)
        : path_(std::move(path)), lock_(std::move(lock)) {}

    std::filesystem::path path_;
    std::unique_ptr<WritableFile> lock_;
    std::mutex mutex_;
    bool isDiscarded_ = false;
};

} // namespace isoslider::model
