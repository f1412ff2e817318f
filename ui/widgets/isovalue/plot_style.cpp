#include "ui/widgets/isovalue/plot_style.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <QRegularExpression>

#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/text_colour.h"

namespace isoslider::widgets {
namespace {

QString compactLabel(double tick) {
    if (tick < 0.0)
        return {};
    const auto text = QString::fromStdString(model::compactText(static_cast<std::uint64_t>(std::llround(tick))));
    // Ticks are round: "10.0 k" is "10 k", "2.50 M" is "2.5 M".
    static const QRegularExpression zeros(QStringLiteral("\\.0+(?!\\d)|(\\.\\d*[1-9])0+(?!\\d)"));
    return QString(text).replace(zeros, QStringLiteral("\\1"));
}

double wholeStep(double step) { return std::max(1.0, std::floor(step)); }

bool isDark(const QPalette& palette) { return palette.color(QPalette::Base).lightness() < 128; }

} // namespace

PlotColours plotColours(const QPalette& palette) {
    if (isDark(palette))
        return {QColor(128, 150, 184), QColor(94, 120, 160, 110), QColor(72, 190, 168), QColor(240, 128, 60),
                QColor(24, 20, 16)};
    return {QColor(96, 120, 158), QColor(120, 148, 190, 110), QColor(0, 128, 108), QColor(208, 84, 16),
            QColor(255, 255, 255)};
}

QColor eventColour(model::EventClass kind, const QPalette& palette) {
    const bool dark = isDark(palette);
    switch (kind) {
        case model::EventClass::PieceComes: return dark ? QColor(112, 184, 255) : QColor(0, 92, 180);
        case model::EventClass::PieceGoes: return dark ? QColor(206, 158, 120) : QColor(112, 56, 18);
        case model::EventClass::PiecesJoin: return dark ? QColor(242, 132, 212) : QColor(172, 22, 128);
        case model::EventClass::PieceSplits: return dark ? QColor(244, 224, 92) : QColor(150, 116, 0);
        case model::EventClass::Other: break;
    }
    return dark ? QColor(176, 180, 186) : QColor(98, 102, 108);
}

QPen curvePen(model::TopologyQuantity quantity, const QPalette& palette) {
    struct Style {
        QColor light, dark;
        Qt::PenStyle line;
    };
    static const std::array<Style, model::kTopologyQuantities> kStyles{
        {{QColor(176, 30, 60), QColor(255, 128, 140), Qt::SolidLine},
         {QColor(96, 56, 176), QColor(186, 154, 255), Qt::SolidLine},
         {QColor(168, 104, 0), QColor(250, 190, 80), Qt::DashLine},
         {QColor(0, 98, 160), QColor(104, 196, 255), Qt::DashLine},
         {QColor(70, 74, 80), QColor(208, 212, 218), Qt::DashDotLine},
         {QColor(62, 112, 0), QColor(168, 220, 96), Qt::DashDotLine}}};
    const Style& style = kStyles[static_cast<std::size_t>(quantity)];
    return QPen(isDark(palette) ? style.dark : style.light, 1.6, style.line);
}

void styleAxis(QCPAxis* axis, const QPalette& palette) {
    QColor line = palette.color(QPalette::Text);
    line.setAlpha(90);
    QColor grid = line;
    grid.setAlpha(28);
    const QColor label = quietTextColour(palette, QPalette::Text, QPalette::Base);
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

double CompactTicker::getTickStep(const QCPRange& range) { return wholeStep(QCPAxisTicker::getTickStep(range)); }

QString CompactTicker::getTickLabel(double tick, const QLocale&, QChar, int) { return compactLabel(tick); }
void ScaleTicker::generate(const QCPRange& range, const QLocale&, QChar, int, QVector<double>& ticks,
                           QVector<double>* subTicks, QVector<QString>* tickLabels) {
    ticks.clear();
    if (subTicks != nullptr)
        subTicks->clear();
    if (tickLabels != nullptr)
        tickLabels->clear();
    for (const auto& tick : scale_.ticks(range.lower, range.upper, tickCount())) {
        ticks.append(tick.place);
        if (tickLabels != nullptr)
            tickLabels->append(QString::fromStdString(tick.label));
    }
}

double CompactLogTicker::getTickStep(const QCPRange& range) { return wholeStep(QCPAxisTickerLog::getTickStep(range)); }

QString CompactLogTicker::getTickLabel(double tick, const QLocale&, QChar, int) { return compactLabel(tick); }

} // namespace isoslider::widgets
