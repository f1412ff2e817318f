#pragma once

namespace isoslider::widgets {

class HistogramPlot;

/// Makes histogram plots sliders for assistive technology: role, value, range and step.
/// Any number of calls.
void installIsovalueAccessibility();
/// Reports assistive technology, if any listens, that the plot's isovalue changed.
void announceValue(HistogramPlot& plot);

} // namespace isoslider::widgets
