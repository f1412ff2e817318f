#pragma once

#include <QImage>

namespace isoslider::test {

/// Mean structural similarity (Wang et al. 2004) of the grey values of two pictures of one size, over windows of 8 x 8
/// pixels: 1 for equal ones, 0 when the sizes differ.
double structuralSimilarity(const QImage& a, const QImage& b);

} // namespace isoslider::test
