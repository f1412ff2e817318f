#pragma once

#include <optional>
#include <vector>

#include <qcustomplot.h>

#include "ui/model/surface/surface_list.h"

namespace isoslider::widgets {

class HistogramPlot;

/// The isovalues of the surfaces that do not slide, as bars in their colours across the histogram. A press on one makes
/// its surface active before the plot hears of the press, which therefore drags it.
class SurfaceBars : public QCPLayerable {
    Q_OBJECT
public:
    /// Is owned by the plot.
    explicit SurfaceBars(HistogramPlot& plot);

    void show(const model::SurfaceList& list);
    /// The middle of the grip of a bar, for tests; nothing if it is not in the visible range, or of the active surface.
    std::optional<QPointF> gripOf(model::SurfaceId id) const;
    /// What the pointer would explain at a place of the plot; empty if there is nothing.
    QString tipAt(QPointF place) const;

Q_SIGNALS:
    void pressed(isoslider::model::SurfaceId id);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;
    void applyDefaultAntialiasingHint(QCPPainter* painter) const override;
    void draw(QCPPainter* painter) override;
    QRect clipRect() const override;

private:
    const model::ListedSurface* surfaceAt(QPointF place) const;

    HistogramPlot& plot_;
    std::vector<model::ListedSurface> inactive_;
};

} // namespace isoslider::widgets
