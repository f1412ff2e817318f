#include "ui/widgets/plot_style.h"

#include <cmath>

#include "ui/model/number_text.h"

namespace isoslider::widgets {
namespace {

QString compactLabel(double tick) {
    if (tick < 0.0)
        return {};
    const auto text = QString::fromStdString(model::compactText(static_cast<std::uint64_t>(std::llround(tick))));
    // Round ticks need no decimals: "10.0 k" is "10 k".
    return QString(text).remove(QStringLiteral(".00")).remove(QStringLiteral(".0"));
}

bool isDark(const QPalette& palette) { return palette.color(QPalette::Base).lightness() < 128; }

} // namespace

PlotColours plotColours(const QPalette& palette) {
    if (isDark(palette))
        return {QColor(128, 150, 184), QColor(94, 120, 160, 110), QColor(72, 190, 168), QColor(240, 128, 60),
                QColor(24, 20, 16)};
    return {QColor(96, 120, 158), QColor(120, 148, 190, 110), QColor(0, 128, 108), QColor(208, 84, 16),
            QColor(255, 255, 255)};
}

void styleAxis(QCPAxis* axis, const QPalette& palette) {
    QColor line = palette.color(QPalette::Text);
    line.setAlpha(90);
    QColor grid = line;
    grid.setAlpha(28);
    const QColor label = palette.color(QPalette::Active, QPalette::PlaceholderText);
    axis->setBasePen(QPen(line, 1.0));
    axis->setTickPen(QPen(line, 1.0));
    axis->setSubTicks(false);
    axis->setTickLength(0, 4);
    axis->grid()->setPen(QPen(grid, 1.0));
    axis->grid()->setZeroLinePen(QPen(grid, 1.0));
    axis->setTickLabelColor(palette.color(QPalette::Text));
    axis->setLabelColor(label);
    QFont font;
    font.setPointSizeF(std::max(7.5, font.pointSizeF() * 0.88));
    axis->setTickLabelFont(font);
    axis->setLabelFont(font);
    axis->setNumberFormat(QStringLiteral("gb"));
    axis->setNumberPrecision(6);
}

QString CompactTicker::getTickLabel(double tick, const QLocale&, QChar, int) { return compactLabel(tick); }
QString CompactLogTicker::getTickLabel(double tick, const QLocale&, QChar, int) { return compactLabel(tick); }

} // namespace isoslider::widgets
