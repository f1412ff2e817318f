#include "preprocess/volume_facts.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/grid/classification.h"
#include "core/grid/distinct_keys.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::preprocess {
namespace {

constexpr std::size_t kSlabBytes = std::size_t{8} << 20;
constexpr std::size_t kSpan = 4096; // what DistinctKeys likes best

template <class Sample>
struct Extremes {
    Sample min = std::numeric_limits<Sample>::max();
    Sample max = std::numeric_limits<Sample>::lowest();
    std::uint64_t finite = 0;
    SpreadSum sum;

    void add(std::span<const Sample> samples) {
        for (const Sample sample : samples) {
            const bool isFinite = !isMissing(sample);
            min = isFinite && sample < min ? sample : min;
            max = isFinite && sample > max ? sample : max;
            finite += isFinite ? 1u : 0u;
        }
        sum.add(samples);
    }
};

template <class Sample>
class FactFinder {
public:
    FactFinder(io::VolumeSource& source, std::uint64_t memoryBytes, const JobControl& job)
        : source_(source), dims_(source.info().geometry.dims), job_(job), distinct_(memoryBytes) {}

    Result<VolumeFacts> run() {
        tbb::enumerable_thread_specific<Extremes<Sample>> extremes;
        ISO_TRY(forEachSpan("reading", [&](std::span<const Sample> samples) {
            extremes.local().add(samples);
            distinct_.add(samples);
        }));
        while (!distinct_.endPass())
            ISO_TRY(forEachSpan("counting values", [&](std::span<const Sample> samples) { distinct_.add(samples); }));
        Extremes<Sample> all;
        for (const Extremes<Sample>& part : extremes) {
            all.min = std::min(all.min, part.min);
            all.max = std::max(all.max, part.max);
            all.finite += part.finite;
            all.sum.merge(part.sum);
        }
        VolumeFacts facts;
        facts.min = all.finite > 0 ? static_cast<double>(all.min) + 0.0 : std::numeric_limits<double>::quiet_NaN();
        facts.max = all.finite > 0 ? static_cast<double>(all.max) + 0.0 : std::numeric_limits<double>::quiet_NaN();
        if (all.finite > 0)
            facts.spread = all.sum.spread();
        facts.distinctValues = distinct_.count();
        facts.missingSamples = static_cast<std::uint64_t>(pointCount(dims_)) - all.finite;
        return facts;
    }

private:
    template <class Work>
    Status forEachSpan(std::string_view stage, const Work& work) {
        const auto plane = static_cast<std::size_t>(dims_[0] * dims_[1]);
        const auto step = static_cast<std::int64_t>(std::max<std::size_t>(1, kSlabBytes / (plane * sizeof(Sample))));
        slab_.resize(plane * static_cast<std::size_t>(std::min(step, dims_[2])));
        for (std::int64_t z = 0; z < dims_[2]; z += step) {
            if (job_.isStopRequested())
                return cancelledError();
            job_.report(static_cast<double>(z) / static_cast<double>(dims_[2]), stage);
            const std::int64_t end = std::min(z + step, dims_[2]);
            const auto samples = std::span(slab_).first(plane * static_cast<std::size_t>(end - z));
            ISO_TRY(source_.readSlab(z, end, std::as_writable_bytes(samples)));
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (samples.size() + kSpan - 1) / kSpan),
                              [&](const auto& spans) {
                                  for (std::size_t i = spans.begin(); i < spans.end(); ++i)
                                      work(std::span<const Sample>(samples).subspan(
                                          i * kSpan, std::min(kSpan, samples.size() - i * kSpan)));
                              });
        }
        return {};
    }

    io::VolumeSource& source_;
    GridDims dims_;
    const JobControl& job_;
    DistinctKeys<Sample> distinct_;
    std::vector<Sample> slab_;
};

} // namespace

Result<VolumeFacts> findFacts(io::VolumeSource& source, std::uint64_t memoryBytes, const JobControl& job) {
    try {
        ISO_TRY(source.prepare(job));
        return visitScalarType(source.info().type, [&](auto sample) -> Result<VolumeFacts> {
            return FactFinder<decltype(sample)>(source, memoryBytes, job).run();
        });
    } catch (const std::bad_alloc&) {
        return makeError(ErrorCode::OutOfSpace, "not enough memory to read the volume");
    }
}

} // namespace isoslider::preprocess
