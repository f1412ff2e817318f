#pragma once

#include <QImage>

namespace isoslider::render {

/// A picture without its background, from two pictures of the same over black and over white: what is the same in both
/// covers the background, what differs lets it through. Exact to a step of 256, whatever blends and antialiasing made
/// it. REQUIRES: both have one size.
QImage withoutBackground(const QImage& onBlack, const QImage& onWhite);

} // namespace isoslider::render
