#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <QPixmap>
#include <qcustomplot.h>

#include "ui/model/isovalue/value_scale.h"
#include "ui/model/topology/event_words.h"

namespace isoslider::widgets {

/// One event as the histogram shows it.
struct EventMark {
    std::size_t event = 0; ///< for whoever made the mark
    double isovalue = 0.0;
    double justPast = 0.0; ///< the least isovalue at which the event has happened
    double share = 0.0; ///< persistence over the greatest: 0 to 1
    model::EventClass kind = model::EventClass::Other;
};

/// Draws `kind` with its middle at `centre`; the same shapes in the histogram and in the table.
void drawEventGlyph(QPainter& painter, model::EventClass kind, QPointF centre, double radius, const QPalette& palette);
QPixmap eventGlyph(model::EventClass kind, int size, qreal devicePixelRatio, const QPalette& palette);

/// Marks that stand on the isovalue axis: height by persistence, shape and colour by what happens. Where they crowd,
/// the most persistent ones are drawn, the others once there is room: zoomed in. O(marks) when marks, range or palette
/// change; what is drawn is kept until then.
class EventMarks : public QCPLayerable {
    Q_OBJECT
public:
    /// Draws on the layer of that name, which must be there and is buffered.
    EventMarks(QCustomPlot& plot, const QString& layer);

    /// Ascending by isovalue.
    void setMarks(std::vector<EventMark> marks);
    /// How values stand along the axis.
    void setScale(const model::ValueScale& scale);
    /// Drawn in any case, and larger.
    void setChosen(std::optional<std::size_t> event);

    /// The mark drawn at a place of the widget; null if there is none.
    const EventMark* markAt(QPointF place) const;
    /// The mark drawn nearest to a column of pixels, within `reach`; null if there is none.
    const EventMark* markNear(double pixel, double reach) const;
    /// The middle of the symbol of the mark of an event, for tests; nothing if it is not drawn.
    std::optional<QPointF> placeOf(std::size_t event) const;
    std::size_t drawnCount() const;

protected:
    void applyDefaultAntialiasingHint(QCPPainter* painter) const override;
    void draw(QCPPainter* painter) override;
    QRect clipRect() const override;

private:
    struct Drawn {
        std::size_t mark; ///< place in marks_
        double pixel;
        double top;
    };
    /// What is drawn, left to right, at the present range and size.
    const std::vector<Drawn>& drawn() const;
    void thinOut() const;
    double shareOf(const Drawn& one) const { return std::clamp(marks_[one.mark].share, 0.0, 1.0); }

    std::vector<EventMark> marks_;
    std::optional<std::size_t> chosen_;
    model::ValueScale scale_;
    mutable std::vector<Drawn> drawn_;
    mutable QCPRange drawnRange_;
    mutable QRect drawnRect_;
    mutable bool isDrawnKnown_ = false;
};

} // namespace isoslider::widgets
