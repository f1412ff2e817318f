#include "tests/gui/image_likeness.h"

namespace isoslider::test {
namespace {

constexpr int kWindow = 8;
constexpr int kStride = 4;
constexpr double kC1 = 0.01 * 255.0 * 0.01 * 255.0;
constexpr double kC2 = 0.03 * 255.0 * 0.03 * 255.0;

double windowSimilarity(const QImage& a, const QImage& b, int left, int top) {
    double sumA = 0.0, sumB = 0.0, sumAa = 0.0, sumBb = 0.0, sumAb = 0.0;
    for (int y = top; y < top + kWindow; ++y) {
        const uchar* rowA = a.constScanLine(y);
        const uchar* rowB = b.constScanLine(y);
        for (int x = left; x < left + kWindow; ++x) {
            const double valueA = rowA[x], valueB = rowB[x];
            sumA += valueA;
            sumB += valueB;
            sumAa += valueA * valueA;
            sumBb += valueB * valueB;
            sumAb += valueA * valueB;
        }
    }
    constexpr double n = kWindow * kWindow;
    const double meanA = sumA / n, meanB = sumB / n;
    const double varianceA = sumAa / n - meanA * meanA, varianceB = sumBb / n - meanB * meanB;
    const double covariance = sumAb / n - meanA * meanB;
    return (2.0 * meanA * meanB + kC1) * (2.0 * covariance + kC2) /
           ((meanA * meanA + meanB * meanB + kC1) * (varianceA + varianceB + kC2));
}

} // namespace

double structuralSimilarity(const QImage& a, const QImage& b) {
    if (a.size() != b.size() || a.width() < kWindow || a.height() < kWindow)
        return 0.0;
    const QImage greyA = a.convertToFormat(QImage::Format_Grayscale8),
                 greyB = b.convertToFormat(QImage::Format_Grayscale8);
    double sum = 0.0;
    int windows = 0;
    for (int top = 0; top + kWindow <= a.height(); top += kStride)
        for (int left = 0; left + kWindow <= a.width(); left += kStride, ++windows)
            sum += windowSimilarity(greyA, greyB, left, top);
    return sum / windows;
}

} // namespace isoslider::test
