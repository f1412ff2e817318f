#include "ui/model/jobs/job_model.h"

#include <algorithm>

namespace isoslider::model {

const JobEntry* JobModel::find(JobId id) const {
    const auto found =
        std::find_if(entries_.begin(), entries_.end(), [id](const JobEntry& entry) { return entry.id == id; });
    return found == entries_.end() ? nullptr : &*found;
}

JobEntry* JobModel::findRunning(JobId id) {
    auto* entry = const_cast<JobEntry*>(find(id));
    return entry != nullptr && entry->state == JobState::Running ? entry : nullptr;
}

std::size_t JobModel::runningCount() const {
    return static_cast<std::size_t>(std::count_if(
        entries_.begin(), entries_.end(), [](const JobEntry& entry) { return entry.state == JobState::Running; }));
}

JobId JobModel::add(std::string title) {
    JobEntry entry;
    entry.id = JobId{nextId_++};
    entry.title = std::move(title);
    entries_.push_back(std::move(entry));
    changed_.notify();
    return entries_.back().id;
}

void JobModel::setProgress(JobId id, double fraction, std::string stage, double elapsedMs) {
    JobEntry* entry = findRunning(id);
    if (entry == nullptr)
        return;
    entry->fraction = std::clamp(fraction, 0.0, 1.0);
    entry->stage = std::move(stage);
    entry->elapsedMs = elapsedMs;
    changed_.notify();
}

void JobModel::setCancelling(JobId id) {
    JobEntry* entry = findRunning(id);
    if (entry == nullptr || entry->isCancelling)
        return;
    entry->isCancelling = true;
    changed_.notify();
}

void JobModel::finish(JobId id, JobState state, std::string errorText, double elapsedMs) {
    JobEntry* entry = findRunning(id);
    if (entry == nullptr)
        return;
    entry->state = state;
    entry->errorText = std::move(errorText);
    entry->elapsedMs = elapsedMs;
    if (state == JobState::Finished)
        entry->fraction = 1.0;
    std::size_t finished = entries_.size() - runningCount();
    std::erase_if(entries_, [&finished](const JobEntry& old) {
        return old.state != JobState::Running && finished > kFinishedKept && finished-- > 0;
    });
    changed_.notify();
}

void JobModel::clearFinished() {
    const auto before = entries_.size();
    std::erase_if(entries_, [](const JobEntry& entry) { return entry.state != JobState::Running; });
    if (entries_.size() != before)
        changed_.notify();
}

Subscription JobModel::observe(std::function<void()> function) { return changed_.observe(std::move(function)); }

} // namespace isoslider::model
