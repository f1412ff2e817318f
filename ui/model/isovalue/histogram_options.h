#pragma once

#include "ui/model/isovalue/value_scale.h"
#include "ui/model/options_model.h"

namespace isoslider::model {

/// How the histogram is drawn, and what its handle stops at.
struct HistogramOptions {
    ScaleKind valueScale = ScaleKind::Linear;
    bool hasLogCounts = true;
    bool clipsCounts = true; ///< on a linear axis of counts, a few bins far above all others do not set its height
    bool snapsToSamples = false;

    bool operator==(const HistogramOptions&) const = default;
};

class HistogramOptionsModel : public OptionsModel<HistogramOptions> {};

} // namespace isoslider::model
