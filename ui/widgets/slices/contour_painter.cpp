#include "ui/widgets/slices/contour_painter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace isoslider::widgets {
namespace {

constexpr float kLongestPiece = 12.0f; // pixels: the boxes around the pieces of a slanted line hold less than its own

/// How much of each pixel lines of two widths cover, 0 to 255.
class Coverage {
public:
    Coverage(int width, int height, const ContourStyle& style)
        : width_(width),
          height_(height),
          reach_(static_cast<float>(0.5 * style.width) + 0.5f),
          shadowReach_(static_cast<float>(0.5 * style.shadowWidth) + 0.5f),
          line_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0),
          shadow_(line_) {}

    void add(const QLineF& line) {
        const double length = std::max(std::abs(line.dx()), std::abs(line.dy()));
        const int pieces = std::max(1, static_cast<int>(std::ceil(length / static_cast<double>(kLongestPiece))));
        for (int i = 0; i < pieces; ++i) {
            const QPointF a = line.pointAt(static_cast<double>(i) / pieces);
            const QPointF b = line.pointAt(static_cast<double>(i + 1) / pieces);
            addPiece(static_cast<float>(a.x()), static_cast<float>(a.y()), static_cast<float>(b.x()),
                     static_cast<float>(b.y()));
        }
    }

    void blendRow(QRgb* pixels, int row, const ContourStyle& style) const {
        const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
        for (int x = 0; x < width_; ++x) {
            const std::size_t at = first + static_cast<std::size_t>(x);
            if (shadow_[at] == 0)
                continue;
            const QRgb below = blended(pixels[x], style.shadow, shadow_[at]);
            pixels[x] = blended(below, style.colour, line_[at]);
        }
    }

private:
    static QRgb blended(QRgb below, const QColor& colour, int coverage) {
        const int part = coverage * colour.alpha() / 255;
        const auto mix = [part](int from, int to) { return from + (to - from) * part / 255; };
        return qRgb(mix(qRed(below), colour.red()), mix(qGreen(below), colour.green()),
                    mix(qBlue(below), colour.blue()));
    }

    /// Pixel middles lie at halves.
    void addPiece(float ax, float ay, float bx, float by) {
        const int left = std::max(0, static_cast<int>(std::floor(std::min(ax, bx) - shadowReach_)));
        const int right = std::min(width_ - 1, static_cast<int>(std::floor(std::max(ax, bx) + shadowReach_)));
        const int top = std::max(0, static_cast<int>(std::floor(std::min(ay, by) - shadowReach_)));
        const int bottom = std::min(height_ - 1, static_cast<int>(std::floor(std::max(ay, by) + shadowReach_)));
        const float dx = bx - ax, dy = by - ay;
        const float square = dx * dx + dy * dy, perSquare = square > 0.0f ? 1.0f / square : 0.0f;
        for (int y = top; y <= bottom; ++y) {
            const float py = static_cast<float>(y) + 0.5f - ay;
            for (int x = left; x <= right; ++x) {
                const float px = static_cast<float>(x) + 0.5f - ax;
                const float along = std::clamp((px * dx + py * dy) * perSquare, 0.0f, 1.0f);
                const float ex = px - along * dx, ey = py - along * dy;
                const float away = std::sqrt(ex * ex + ey * ey);
                const std::size_t at =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
                raise(shadow_[at], shadowReach_ - away);
                raise(line_[at], reach_ - away);
            }
        }
    }

    static void raise(std::uint8_t& coverage, float part) {
        const auto value = static_cast<std::uint8_t>(std::clamp(part, 0.0f, 1.0f) * 255.0f);
        coverage = std::max(coverage, value);
    }

    int width_, height_;
    float reach_, shadowReach_;
    std::vector<std::uint8_t> line_, shadow_;
};

} // namespace

void paintContour(QImage& image, const std::vector<QLineF>& lines, const ContourStyle& style) {
    if (lines.empty() || image.isNull())
        return;
    Coverage coverage(image.width(), image.height(), style);
    for (const QLineF& line : lines)
        coverage.add(line);
    for (int row = 0; row < image.height(); ++row)
        coverage.blendRow(reinterpret_cast<QRgb*>(image.scanLine(row)), row, style);
}

} // namespace isoslider::widgets
