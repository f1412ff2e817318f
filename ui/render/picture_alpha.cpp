#include "ui/render/picture_alpha.h"

#include <algorithm>

#include "core/base/check.h"

namespace isoslider::render {
namespace {

QRgb pixelWithoutBackground(QRgb black, QRgb white) {
    // What of the background comes through each channel; where they differ by rounding, the least.
    const int through =
        std::min({qRed(white) - qRed(black), qGreen(white) - qGreen(black), qBlue(white) - qBlue(black)});
    const int alpha = 255 - std::clamp(through, 0, 255);
    return qRgba(std::min(qRed(black), alpha), std::min(qGreen(black), alpha), std::min(qBlue(black), alpha), alpha);
}

} // namespace

QImage withoutBackground(const QImage& onBlack, const QImage& onWhite) {
    ISO_CHECK(onBlack.size() == onWhite.size());
    QImage result(onBlack.size(), QImage::Format_ARGB32_Premultiplied);
    if (result.isNull())
        return result;
    const QImage black = onBlack.convertToFormat(QImage::Format_RGB32);
    const QImage white = onWhite.convertToFormat(QImage::Format_RGB32);
    for (int y = 0; y < result.height(); ++y) {
        const auto* b = reinterpret_cast<const QRgb*>(black.constScanLine(y));
        const auto* w = reinterpret_cast<const QRgb*>(white.constScanLine(y));
        auto* out = reinterpret_cast<QRgb*>(result.scanLine(y));
        for (int x = 0; x < result.width(); ++x)
            out[x] = pixelWithoutBackground(b[x], w[x]);
    }
    return result;
}

} // namespace isoslider::render
