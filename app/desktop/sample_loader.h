#pragma once

#include "ui/model/dataset.h"

namespace isoslider::desktop {

/// Makes the built-in samples "bluntfin" and "shell".
model::SampleLoader makeSampleLoader();

} // namespace isoslider::desktop
