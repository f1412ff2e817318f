#pragma once

#include <cstdint>
#include <vector>

namespace isoslider::bench {

/// Milliseconds of a clock that never goes back.
double nowMs();
/// Of all threads of this process, and of processes that it has started and that have ended.
double processorSeconds();

struct Spread {
    double median = 0.0;
    double p95 = 0.0;
    double max = 0.0;
    double min = 0.0;
    double mean = 0.0;
};
/// Zeros for no values.
Spread spreadOf(std::vector<double> values);
/// REQUIRES: every value > 0; 0 for none.
double geometricMean(const std::vector<double>& values);

/// Memory of this process in real pages, now and at its highest. 0 where the system does not state.
std::uint64_t residentBytes();
std::uint64_t peakResidentBytes();

/// How many processors other programs kept busy: a measurement beside them is worth little.
class NoiseWitness {
public:
    NoiseWitness();
    double othersBusy() const;

private:
    double startMs_ = 0.0;
    double startBusy_ = 0.0;
    double startOwn_ = 0.0;
};

} // namespace isoslider::bench
