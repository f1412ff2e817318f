#include "tests/bench/timing.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

namespace isoslider::bench {
namespace {

std::uint64_t statusBytes(const std::string& key) {
    std::ifstream status("/proc/self/status");
    std::string word;
    while (status >> word) {
        if (word == key) {
            std::uint64_t kilobytes = 0;
            status >> kilobytes;
            return kilobytes * 1024;
        }
        status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    }
    return 0;
}

// Seconds that all processors together have not been idle.
double busySeconds() {
    std::ifstream stat("/proc/stat");
    std::string word;
    stat >> word;
    double user = 0, nice = 0, system = 0, idle = 0, wait = 0, interrupts = 0, softInterrupts = 0;
    stat >> user >> nice >> system >> idle >> wait >> interrupts >> softInterrupts;
    return (user + nice + system + interrupts + softInterrupts) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

} // namespace

double processorSeconds() {
    double seconds = 0.0;
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        getrusage(who, &usage);
        for (const timeval& time : {usage.ru_utime, usage.ru_stime})
            seconds += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }
    return seconds;
}

double nowMs() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Spread spreadOf(std::vector<double> values) {
    if (values.empty())
        return {};
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    double sum = 0.0;
    for (const double value : values)
        sum += value;
    Spread spread;
    spread.median = 0.5 * (values[n / 2] + values[(n - 1) / 2]);
    spread.p95 = values[static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(n))) - 1];
    spread.max = values.back();
    spread.min = values.front();
    spread.mean = sum / static_cast<double>(n);
    return spread;
}

double geometricMean(const std::vector<double>& values) {
    if (values.empty())
        return 0.0;
    double sum = 0.0;
    for (const double value : values)
        sum += std::log(value);
    return std::exp(sum / static_cast<double>(values.size()));
}

std::uint64_t residentBytes() { return statusBytes("VmRSS:"); }
std::uint64_t peakResidentBytes() { return statusBytes("VmHWM:"); }

NoiseWitness::NoiseWitness() : startMs_(nowMs()), startBusy_(busySeconds()), startOwn_(processorSeconds()) {}

double NoiseWitness::othersBusy() const {
    const double others = busySeconds() - startBusy_ - (processorSeconds() - startOwn_);
    return std::max(0.0, others / std::max(1e-3, 1e-3 * (nowMs() - startMs_)));
}

} // namespace isoslider::bench
