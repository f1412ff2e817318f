#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "core/base/job_control.h"
#include "ui/model/jobs/job_model.h"
#include "ui/model/jobs/main_thread.h"

namespace isoslider::model {

/// Low: gives way to what the user does meanwhile.
enum class JobPriority { Usual, Low };

/// Runs long work on separate threads, and keeps the JobModel up to date. Used from the window's thread.
/// Destruction asks every job to stop and waits for it; no completion runs after that.
class JobRunner {
public:
    JobRunner(JobModel& model, MainThread postToMain);
    ~JobRunner();

    /// `work` runs on a worker thread; exceptions become errors. `done` runs on the window's thread
    /// with its result, after the model shows the job's end. Threads that help have the same priority.
    template <class T>
    JobId run(const std::string& title, std::function<Result<T>(const JobControl&)> work,
              std::function<void(Result<T>)> done, JobPriority priority = JobPriority::Usual) {
        auto outcome = std::make_shared<std::optional<Result<T>>>();
        return start(
            title,
            [work = std::move(work), outcome](const JobControl& job) -> Status {
                outcome->emplace(work(job));
                return (*outcome)->isOk() ? Status{} : Status{(*outcome)->error()};
            },
            [done = std::move(done), outcome](Status status) {
                if (!status.isOk())
                    return done(Result<T>{status.error()});
                done(std::move(**outcome));
            },
            priority);
    }

    void cancel(JobId id);

private:
    struct Shared;
    struct Job;
    using Work = std::function<Status(const JobControl&)>;
    using Done = std::function<void(Status)>;

    JobId start(const std::string& title, Work work, Done done, JobPriority priority);
    void finish(JobId id, const Status& status, const Done& done);

    JobModel& model_;
    MainThread postToMain_;
    std::shared_ptr<bool> isAlive_;
    std::map<JobId, std::unique_ptr<Job>> jobs_;
};

} // namespace isoslider::model
