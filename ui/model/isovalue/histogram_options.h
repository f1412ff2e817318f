#pragma once

#include <string>
#include <vector>

#include "ui/model/isovalue/value_scale.h"
#include "ui/model/options_model.h"

namespace isoslider::model {

/// How the histogram is drawn, and what its handle stops at.
struct HistogramOptions {
    ScaleKind valueScale = ScaleKind::Linear;
    bool hasLogCounts = true;
    bool clipsCounts = true; ///< on a linear axis of counts, a few bins far above all others do not set its height
    bool snapsToSamples = false;
    bool snapsToEvents = false; ///< a drag near the mark of an event goes just past it
    std::vector<std::string> curves; ///< over it, by their names in the settings; unknown ones count for nothing

    bool operator==(const HistogramOptions&) const = default;
};

/// Values from end to end of what is shown.
struct HistogramRange {
    double lower = 0.0, upper = 0.0;

    bool operator==(const HistogramRange&) const = default;
};

class HistogramOptionsModel : public OptionsModel<HistogramOptions> {};

} // namespace isoslider::model
