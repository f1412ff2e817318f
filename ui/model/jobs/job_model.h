#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ui/model/observers.h"

namespace isoslider::model {

enum class JobId : std::uint64_t {};
enum class JobState { Running, Finished, Failed, Cancelled };

/// One piece of long work as the job list shows it.
struct JobEntry {
    JobId id{};
    std::string title;
    std::string stage;
    double fraction = 0.0; ///< 0 to 1; negative while unknown
    JobState state = JobState::Running;
    bool isCancelling = false;
    std::string errorText;
    double elapsedMs = 0.0;
};

/// The list of running and finished jobs, newest last. Window thread only.
class JobModel {
public:
    static constexpr std::size_t kFinishedKept = 20;

    const std::vector<JobEntry>& entries() const { return entries_; }
    const JobEntry* find(JobId id) const;
    std::size_t runningCount() const;

    JobId add(std::string title);
    void setProgress(JobId id, double fraction, std::string stage, double elapsedMs);
    void setCancelling(JobId id);
    /// Older finished entries beyond kFinishedKept are forgotten.
    void finish(JobId id, JobState state, std::string errorText, double elapsedMs);
    void clearFinished();

    [[nodiscard]] Subscription observe(std::function<void()> function);

private:
    JobEntry* findRunning(JobId id);

    std::vector<JobEntry> entries_;
    std::uint64_t nextId_ = 1;
    ObserverList<> changed_;
};

} // namespace isoslider::model
