#include "app/desktop/sample_loader.h"

#include <cmath>

namespace isoslider::desktop {

model::SampleLoader makeSampleLoader() {
    return [](const std::string& name, const JobControl&) -> Result<std::shared_ptr<const ScalarGrid>> {
        return makeError(ErrorCode::NotFound, "no such sample volume", name);
    };
}

} // namespace isoslider::desktop
