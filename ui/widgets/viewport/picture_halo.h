#pragma once

#include <QColor>
#include <QImage>

namespace isoslider::widgets {

/// What is drawn over a picture, with a rim around it, `pixels` wide, so that it is legible on whatever the picture is
/// laid upon. `drawn` has an alpha channel.
QImage withHalo(const QImage& drawn, const QColor& colour, double pixels);

} // namespace isoslider::widgets
