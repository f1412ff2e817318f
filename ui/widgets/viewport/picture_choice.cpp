#include "ui/widgets/viewport/picture_choice.h"

#include <algorithm>
#include <cmath>

namespace isoslider::widgets {

QSize PictureChoice::sizeOf(QSize view) const {
    if (view.isEmpty())
        return {};
    double factor = scale > 0 ? scale : static_cast<double>(width) / view.width();
    factor = std::min(factor, static_cast<double>(kMostSide) / std::max(view.width(), view.height()));
    const auto pixels = [factor](int side) {
        return std::clamp(static_cast<int>(std::lround(side * factor)), 1, kMostSide);
    };
    return {pixels(view.width()), pixels(view.height())};
}

} // namespace isoslider::widgets
