#include "core/index/validation/value_thresholds.h"

#include <algorithm>
#include <string>

#include "core/grid/scalar_key.h"

namespace isoslider::index {

ValueThresholds::ValueThresholds(const IndexInfo& info) {
    const std::size_t count = info.histogram.counts.size();
    visitScalarType(info.type, [&](auto sample) {
        using Sample = decltype(sample);
        for (std::size_t b = 0; b < count; ++b) {
            const double at = static_cast<double>(b) / static_cast<double>(count);
            thresholds_.push_back(thresholdOf<Sample>(info.min * (1.0 - at) + info.max * at));
        }
        if (sizeof(KeyOf<Sample>) == 2) {
            table_.resize(std::size_t{1} << 16);
            for (std::size_t key = 0; key < table_.size(); ++key)
                table_[key] = static_cast<std::uint32_t>(std::upper_bound(thresholds_.begin(), thresholds_.end(), key) -
                                                         thresholds_.begin());
        }
    });
}

void ValueThresholds::compareCurve(std::span<const std::int64_t> changes, const IndexInfo& info,
                                   FaultList& faults) const {
    std::int64_t active = 0;
    for (std::size_t b = 0; b < count(); ++b) {
        active += changes[b];
        if (info.activeEdgesPerBin[b] == static_cast<std::uint64_t>(active))
            continue;
        IndexFault fault;
        fault.part = "curve of active edges";
        fault.problem = "states " + std::to_string(info.activeEdgesPerBin[b]) + " at bin " + std::to_string(b) +
                        ", where there are " + std::to_string(active);
        faults.add(std::move(fault));
        return;
    }
}

} // namespace isoslider::index
