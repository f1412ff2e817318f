#pragma once

#include <utility>
#include <vector>

#include <QPointF>
#include <QString>
#include <QWidget>

namespace isoslider::widgets {

/// Ticks and numbers outside the box, over the whole view; lets all pointer events through.
class BoxTicksView : public QWidget {
    Q_OBJECT
public:
    struct Edge {
        QString title; ///< "X (mm)"
        QPointF from, to; ///< its ends, in pixels of the view
        QPointF outwards; ///< unit
        std::vector<std::pair<QPointF, QString>> ticks;

        bool operator==(const Edge&) const = default;
    };

    explicit BoxTicksView(QWidget* parent);

    void setEdges(std::vector<Edge> edges, bool isOnLight);
    const std::vector<Edge>& edges() const { return edges_; }
    void paint(QPainter& painter) const;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    void paintEdge(QPainter& painter, const Edge& edge) const;

    std::vector<Edge> edges_;
    bool isOnLight_ = false;
};

} // namespace isoslider::widgets
