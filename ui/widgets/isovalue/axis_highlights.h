#pragma once

#include <optional>
#include <vector>

#include <qcustomplot.h>

#include "core/topology/topology_queries.h"
#include "ui/model/topology/suggested_isovalue.h"

namespace isoslider::widgets {

class HistogramPlot;

/// What is pointed out on the isovalue axis beside events: isovalues that were found, as bands; suggested ones, as
/// stars at the upper edge that can be pressed; the reference, as a thin line with a flag.
class AxisHighlights : public QCPLayerable {
    Q_OBJECT
public:
    /// Is owned by the plot.
    explicit AxisHighlights(HistogramPlot& plot);

    /// Both ends the same: one isovalue.
    void setFound(std::vector<topology::IsovalueInterval> intervals);
    void setSuggestions(std::vector<model::SuggestedIsovalue> suggestions);
    void setReference(std::optional<double> isovalue);

    const std::vector<topology::IsovalueInterval>& found() const { return found_; }
    /// The middle of the star of a suggestion, for tests; nothing if it is not in the visible range.
    std::optional<QPointF> placeOf(std::size_t suggestion) const;
    /// What the pointer would explain at a place of the plot; empty if there is nothing.
    QString tipAt(QPointF place) const;

Q_SIGNALS:
    void suggestionPressed(double isovalue);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;
    void applyDefaultAntialiasingHint(QCPPainter* painter) const override;
    void draw(QCPPainter* painter) override;
    QRect clipRect() const override;

private:
    const model::SuggestedIsovalue* suggestionAt(QPointF place) const;
    void drawFound(QCPPainter* painter);
    void drawReference(QCPPainter* painter);
    void drawStar(QCPPainter* painter, QPointF centre);
    void redraw();

    HistogramPlot& plot_;
    std::vector<topology::IsovalueInterval> found_;
    std::vector<model::SuggestedIsovalue> suggestions_;
    std::optional<double> reference_;
};

} // namespace isoslider::widgets
