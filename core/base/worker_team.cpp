#include "core/base/worker_team.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#if defined(__linux__)
#include <pthread.h>
#include <sched.h>
#endif

namespace isoslider {
namespace {

/// Turns round until `isDone` for a time that a sleep and a wake would cost; whether it has become true.
template <class Condition>
bool spinUntil(const Condition& isDone) {
    constexpr int kTurns = 4000; // some tens of microseconds
    for (int turn = 0; turn < kTurns; ++turn) {
        if (isDone())
            return true;
#if defined(__x86_64__) || defined(__i386__)
        __builtin_ia32_pause();
#endif
    }
    return false;
}

#if defined(__linux__)
/// Which processors sleeping workers are woken on: others than the caller's. Where a program has been idle, as between
/// two moves of a handle, Linux was seen to wake them on the processor that wakes them, which is busy, and to move them
/// a millisecond and a half later: by then a loop is over. Awake they may run anywhere again.
class Placement {
public:
    /// The caller's processors but the one it runs on, for those that wake next.
    void prepare(std::vector<std::thread>& workers) {
        cpu_set_t others;
        const int here = sched_getcpu();
        if (here < 0 || pthread_getaffinity_np(pthread_self(), sizeof allowed_, &allowed_) != 0 ||
            CPU_COUNT(&allowed_) < 2 || CPU_COUNT(&allowed_) > kFew)
            return;
        others = allowed_;
        CPU_CLR(here, &others);
        for (std::thread& worker : workers)
            (void)pthread_setaffinity_np(worker.native_handle(), sizeof others, &others);
        arePlaced_ = true;
    }
    /// For a worker that has been woken. REQUIRES for both: one at a time.
    void freeWorker() const {
        if (arePlaced_)
            (void)pthread_setaffinity_np(pthread_self(), sizeof allowed_, &allowed_);
    }

private:
    static constexpr int kFew = 8; ///< of more, some are idle where the scheduler looks for one
    cpu_set_t allowed_;
    bool arePlaced_ = false;
};
#else
class Placement {
public:
    void prepare(std::vector<std::thread>& /*workers*/) {}
    void freeWorker() const {}
};
#endif

/// One loop while it runs. Lives on its caller's stack: a worker counts itself among `helpers` while it looks at it.
struct Loop {
    std::size_t count, grain;
    void* body;
    detail::RangeCall call;
    int seats; ///< workers that may still join; guarded by the team's mutex
    std::atomic<std::size_t> next{0};
    std::atomic<std::uint32_t> helpers{0};
    std::mutex failureMutex{};
    std::exception_ptr failure{};

    void work() {
        for (;;) {
            const std::size_t begin = next.fetch_add(grain, std::memory_order_relaxed);
            if (begin >= count)
                return;
            try {
                call(body, begin, std::min(count, begin + grain));
            } catch (...) {
                next.store(count, std::memory_order_relaxed);
                const std::lock_guard lock(failureMutex);
                if (!failure)
                    failure = std::current_exception();
            }
        }
    }
};

class Team {
public:
    ~Team() {
        isEnding_.store(true);
        wake();
        for (std::thread& worker : workers_)
            worker.join();
    }

    void run(Loop& loop, int threads) {
        if (threads < 2 || isBusy_.test_and_set(std::memory_order_acquire)) {
            loop.work();
            return;
        }
        start(threads - 1);
        {
            const std::lock_guard lock(loopMutex_);
            loop.seats = threads - 1;
            loop_ = &loop;
            if (sleeping_.load(std::memory_order_relaxed) > 0)
                placement_.prepare(workers_);
        }
        wake();
        loop.work();
        {
            const std::lock_guard lock(loopMutex_);
            loop_ = nullptr;
        }
        const auto isAlone = [&] { return loop.helpers.load(std::memory_order_acquire) == 0; };
        if (!spinUntil(isAlone))
            for (std::uint32_t helpers = loop.helpers.load(std::memory_order_acquire); helpers != 0;
                 helpers = loop.helpers.load(std::memory_order_acquire))
                loop.helpers.wait(helpers);
        {
            const std::lock_guard lock(loopMutex_); // the last helper may still be about to wake us
        }
        isBusy_.clear(std::memory_order_release);
    }

private:
    void start(int count) {
        try {
            while (static_cast<int>(workers_.size()) < count)
                workers_.emplace_back([this] { serve(); });
        } catch (const std::exception&) { // no thread or no memory: then there are fewer
        }
    }
    void wake() {
        calls_.fetch_add(1, std::memory_order_release);
        calls_.notify_all();
    }
    void serve() {
        std::uint32_t seen = 0;
        for (;;) {
            bool hasSlept = false;
            const auto isCalled = [&] { return calls_.load(std::memory_order_acquire) != seen; };
            if (!spinUntil(isCalled)) {
                sleeping_.fetch_add(1, std::memory_order_relaxed);
                calls_.wait(seen, std::memory_order_acquire);
                sleeping_.fetch_sub(1, std::memory_order_relaxed);
                hasSlept = true;
            }
            seen = calls_.load(std::memory_order_acquire);
            if (isEnding_.load())
                return;
            if (Loop* const loop = join(hasSlept)) {
                loop->work();
                leave(*loop);
            }
        }
    }
    Loop* join(bool hasSlept) {
        const std::lock_guard lock(loopMutex_);
        if (hasSlept)
            placement_.freeWorker();
        if (!loop_ || loop_->seats == 0)
            return nullptr;
        --loop_->seats;
        loop_->helpers.fetch_add(1, std::memory_order_relaxed);
        return loop_;
    }
    void leave(Loop& loop) {
        const std::lock_guard lock(loopMutex_); // keeps the loop's owner until it has been woken
        if (loop.helpers.fetch_sub(1, std::memory_order_release) == 1)
            loop.helpers.notify_one();
    }

    std::atomic_flag isBusy_; ///< somebody runs a loop
    std::mutex loopMutex_;
    Loop* loop_ = nullptr;
    Placement placement_; ///< guarded by the mutex, too
    std::atomic<std::uint32_t> calls_{0};
    std::atomic<int> sleeping_{0}; ///< workers
    std::atomic<bool> isEnding_{false};
    std::vector<std::thread> workers_; ///< changed by whoever runs a loop
};

int threadsHere() {
    const auto allowed =
        static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    return std::min(allowed, tbb::this_task_arena::max_concurrency());
}

} // namespace

namespace detail {

void runOnTeam(std::size_t count, std::size_t grain, void* body, RangeCall call) {
    static Team team;
    const std::size_t pieces = (count + grain - 1) / grain;
    Loop loop{count, grain, body, call, 0};
    team.run(loop, static_cast<int>(std::min<std::size_t>(pieces, static_cast<std::size_t>(threadsHere()))));
    if (loop.failure)
        std::rethrow_exception(loop.failure);
}

} // namespace detail

} // namespace isoslider
