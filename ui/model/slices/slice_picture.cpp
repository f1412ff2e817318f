#include "ui/model/slices/slice_picture.h"

#include <algorithm>
#include <cmath>

#include "core/extract/slices/trilinear_value.h"

namespace isoslider::model {

SliceShades shadesOf(const extract::SliceSamples& samples, const extract::SlicePlane& plane, const ValueWindow& window,
                     const GridDims& dims) {
    SliceShades shades{plane, std::vector<std::uint32_t>(samples.values.size(), 0)};
    const double perValue = 255.0 / window.width();
    std::size_t pixel = 0;
    for (int row = 0; row < plane.height; ++row)
        for (int column = 0; column < plane.width; ++column, ++pixel) {
            const auto value = static_cast<double>(samples.values[pixel]);
            if (std::isnan(value)) {
                if (extract::cellOf(plane.at(column, row), dims).isInside)
                    shades.pixels[pixel] = kMissingColour;
                continue;
            }
            const auto shade =
                static_cast<std::uint32_t>(std::clamp((value - window.low) * perValue, 0.0, 255.0) + 0.5);
            shades.pixels[pixel] = 0xff000000u | shade * 0x010101u;
        }
    return shades;
}

} // namespace isoslider::model
