#pragma once

#include <optional>
#include <vector>

#include <QColor>
#include <QPainter>
#include <QWidget>

#include <glm/vec3.hpp>

#include "core/grid/grid_geometry.h"
#include "ui/model/surface/clipping.h"

namespace isoslider::widgets {

class ViewportWidget;

/// What can be dragged: a face of the crop box, the clip plane along its normal, or the tip of its normal.
struct ClipHandle {
    enum class Kind { Face, Plane, Normal };
    Kind kind = Kind::Face;
    int axis = 0; ///< of a face
    bool isHigh = false;

    bool operator==(const ClipHandle&) const = default;
};

/// The handles of crop box and clip plane, over the view. Lets all pointer events through.
class ClipHandles : public QWidget {
    Q_OBJECT
public:
    explicit ClipHandles(ViewportWidget& viewport);

    /// None without a volume.
    void show(const model::Clipping& clipping, const std::optional<GridGeometry>& volume);
    /// The one that stands out, and what is stated beside it.
    void highlight(const std::optional<ClipHandle>& handle, const QString& text = {});
    const QString& text() const { return text_; }

    const std::vector<ClipHandle>& handles() const { return handles_; }
    /// World units about the volume's centre. REQUIRES: a volume.
    glm::dvec3 placeOf(const ClipHandle& handle) const;
    /// Where it is in the view; none behind the eye.
    std::optional<QPointF> pointOf(const ClipHandle& handle) const;
    /// The nearest within reach of the pointer.
    std::optional<ClipHandle> handleAt(QPointF point) const;
    /// The line of sight through a point of the view, in world units about the volume's centre.
    std::pair<glm::dvec3, glm::dvec3> lineOfSight(QPointF point) const;
    /// From the middle of the plane to the tip of its normal.
    double normalLength() const;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    std::optional<QPointF> pointOf(const glm::dvec3& place) const;
    /// The crop box, also where the surface hides its lines: handles would be loose points.
    void paintBox(QPainter& painter) const;
    void paintHandle(QPainter& painter, const ClipHandle& handle, QPointF point) const;

    ViewportWidget& viewport_;
    model::Clipping clipping_;
    std::optional<GridGeometry> volume_;
    std::vector<ClipHandle> handles_;
    glm::dvec3 planeMiddle_{0.0};
    std::optional<ClipHandle> highlighted_;
    QString text_;
};

} // namespace isoslider::widgets
