#pragma once

#include "ui/model/session/dataset.h"

namespace isoslider::desktop {

/// Makes the built-in samples "bluntfin" and "shell" with `dims` points; zeros: the size they are
/// usually shown at. Call after the application object is made.
model::SampleLoader makeSampleLoader(const GridDims& dims);

} // namespace isoslider::desktop
