#pragma once

#include <qcustomplot.h>

#include "ui/model/isovalue/value_scale.h"
#include "ui/model/topology/topology_model.h"

namespace isoslider::widgets {

/// Plot colours that read on the palette's base, dark or light.
struct PlotColours {
    QColor counts;
    QColor countsFill;
    QColor curve;
    QColor handle;
    QColor handleText;
};
PlotColours plotColours(const QPalette& palette);
/// Of what happens at an event; also apart by lightness, for those who do not see the hues.
QColor eventColour(model::EventClass kind, const QPalette& palette);
/// Of a curve over the histogram: colour and dashes differ.
QPen curvePen(model::TopologyQuantity quantity, const QPalette& palette);

/// Thin axis without minor ticks, in the palette's colours.
void styleAxis(QCPAxis* axis, const QPalette& palette);

/// Counts as "12.4 k".
class CompactTicker : public QCPAxisTicker {
public:
    CompactTicker() { setTickCount(4); }

protected:
    double getTickStep(const QCPRange& range) override; ///< a whole number, as counts are
    QString getTickLabel(double tick, const QLocale& locale, QChar formatChar, int precision) override;
};

/// Round values on an axis whose coordinates are places of a scale.
class ScaleTicker : public QCPAxisTicker {
public:
    void setScale(const model::ValueScale& scale) { scale_ = scale; }
    void generate(const QCPRange& range, const QLocale& locale, QChar formatChar, int precision, QVector<double>& ticks,
                  QVector<double>* subTicks, QVector<QString>* tickLabels) override;

private:
    model::ValueScale scale_;
};

class CompactLogTicker : public QCPAxisTickerLog {
protected:
    double getTickStep(const QCPRange& range) override; ///< of a range of few decades, whose ticks are linear
    QString getTickLabel(double tick, const QLocale& locale, QChar formatChar, int precision) override;
};

} // namespace isoslider::widgets
