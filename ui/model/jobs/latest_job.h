#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "ui/model/jobs/job_runner.h"

namespace isoslider::model {

/// Worker threads for what a dialog asks. Shared, so that a dialog can close without waiting for the work it
/// began: whoever goes last waits.
class BackgroundJobs {
public:
    explicit BackgroundJobs(MainThread postToMain) : runner_(jobs_, std::move(postToMain)) {}
    JobModel& jobs() { return jobs_; }
    JobRunner& runner() { return runner_; }

private:
    JobModel jobs_;
    JobRunner runner_; // last: stops before the list goes
};

/// Work of which only the newest counts. At most one thread runs; what was asked for meanwhile waits, and
/// takes the place of what waited before. Window thread only; destruction drops results and returns at once.
template <class T>
class LatestJob {
public:
    using Work = std::function<Result<T>(const JobControl&)>;
    using Done = std::function<void(Result<T>)>;

    explicit LatestJob(std::shared_ptr<BackgroundJobs> jobs) : state_(std::make_shared<State>()) {
        state_->jobs = std::move(jobs);
    }
    ~LatestJob() { cancel(); }
    LatestJob(const LatestJob&) = delete;
    LatestJob& operator=(const LatestJob&) = delete;

    /// `done` is called with the result, unless something newer is started or this is cancelled.
    void start(std::string title, Work work, Done done) {
        cancel();
        state_->next = Asked{std::move(title), std::move(work), std::move(done)};
        if (!state_->running)
            launch(state_);
    }
    /// Nothing more is reported of what was started.
    void cancel() {
        state_->next.reset();
        state_->isDropped = true;
        if (state_->running)
            state_->jobs->runner().cancel(*state_->running);
    }
    bool isRunning() const { return state_->next.has_value() || (state_->running && !state_->isDropped); }
    /// 0 to 1.
    double fraction() const {
        const JobEntry* entry =
            state_->running && !state_->isDropped ? state_->jobs->jobs().find(*state_->running) : nullptr;
        return entry != nullptr ? entry->fraction : 0.0;
    }

private:
    struct Asked {
        std::string title;
        Work work;
        Done done;
    };
    struct State {
        std::shared_ptr<BackgroundJobs> jobs;
        std::optional<JobId> running;
        bool isDropped = false;
        std::optional<Asked> next;
    };

    static void launch(const std::shared_ptr<State>& state) {
        Asked asked = std::move(*std::exchange(state->next, std::nullopt));
        state->isDropped = false;
        state->running = state->jobs->runner().template run<T>(
            asked.title, std::move(asked.work),
            [weak = std::weak_ptr<State>(state), done = std::move(asked.done)](Result<T> result) {
                const auto alive = weak.lock();
                if (!alive)
                    return;
                alive->running.reset();
                if (alive->next)
                    launch(alive);
                else if (!alive->isDropped)
                    done(std::move(result));
            });
    }

    std::shared_ptr<State> state_;
};

} // namespace isoslider::model
