#include "core/grid/scalar_grid.h"

#include <utility>

#include "core/base/check.h"

namespace isoslider {

ScalarGrid::ScalarGrid(GridGeometry geometry, ScalarType type, std::vector<std::byte> samples)
    : geometry_(geometry), type_(type), samples_(std::move(samples)) {
    ISO_CHECK(samples_.size() == static_cast<std::size_t>(pointCount(geometry_.dims)) * scalarTypeSizeBytes(type_));
}

double ScalarGrid::valueAt(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const std::int64_t index = x + dims()[0] * (y + dims()[1] * z);
    return visit([&](auto values) { return static_cast<double>(values[static_cast<std::size_t>(index)]); });
}

} // namespace isoslider
