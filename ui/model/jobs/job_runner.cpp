#include "ui/model/jobs/job_runner.h"

#include <chrono>

#include <tbb/task_arena.h>

#include "core/base/guarded.h"
#include "core/base/helper_priority.h"
#include "core/base/machine.h"

namespace isoslider::model {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kProgressInterval = std::chrono::milliseconds(40);

double millisecondsSince(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

Status runGuarded(const std::function<Status(const JobControl&)>& work, const JobControl& job) {
    const ThrownErrors errors{"not enough memory; close other programs or use a smaller volume"};
    return guarded(errors, [&] { return work(job); });
}

} // namespace

struct JobRunner::Job {
    Clock::time_point begin = Clock::now();
    std::jthread thread; // last: joins before anything above goes
};

JobRunner::JobRunner(JobModel& model, MainThread postToMain)
    : model_(model), postToMain_(std::move(postToMain)), isAlive_(std::make_shared<bool>(true)) {}

JobRunner::~JobRunner() {
    isAlive_.reset();
    for (auto& [id, job] : jobs_)
        job->thread.request_stop();
}

JobId JobRunner::start(const std::string& title, Work work, Done done, JobPriority priority) {
    const JobId id = model_.add(title);
    auto job = std::make_unique<Job>();
    const auto begin = job->begin;
    const std::weak_ptr<bool> alive = isAlive_;

    auto reportProgress = [this, id, begin, alive, post = postToMain_,
                           last = std::make_shared<Clock::time_point>()](double fraction, std::string_view stage) {
        const auto now = Clock::now();
        if (now - *last < kProgressInterval)
            return;
        *last = now;
        post([this, id, begin, alive, fraction, stage = std::string(stage)] {
            if (alive.lock())
                model_.setProgress(id, fraction, stage, millisecondsSince(begin));
        });
    };
    job->thread = std::jthread([this, id, alive, post = postToMain_, work = std::move(work), done = std::move(done),
                                reportProgress, priority](std::stop_token stop) {
        if (priority == JobPriority::Low)
            lowerThreadPriority();
        tbb::task_arena arena;
        const HelperPriority ofHelpers(arena);
        JobControl control;
        control.stop = stop;
        control.progress = reportProgress;
        Status status = arena.execute([&] { return runGuarded(work, control); });
        post([this, id, alive, done, status = std::move(status)] {
            if (alive.lock())
                finish(id, status, done);
        });
    });
    jobs_.emplace(id, std::move(job));
    return id;
}

void JobRunner::finish(JobId id, const Status& status, const Done& done) {
    const auto node = jobs_.extract(id);
    if (node.empty())
        return;
    const double elapsedMs = millisecondsSince(node.mapped()->begin);
    if (status.isOk())
        model_.finish(id, JobState::Finished, {}, elapsedMs);
    else if (status.isCancelled())
        model_.finish(id, JobState::Cancelled, {}, elapsedMs);
    else
        model_.finish(id, JobState::Failed, status.error().line(), elapsedMs);
    done(status);
}

void JobRunner::cancel(JobId id) {
    const auto found = jobs_.find(id);
    if (found == jobs_.end())
        return;
    model_.setCancelling(id);
    found->second->thread.request_stop();
}

} // namespace isoslider::model
