#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>

#include <glm/vec3.hpp>

namespace isoslider::widgets {

class ViewportWidget;

/// Points a place out in a view: clearly at first, faintly after 3 s, until it is taken away.
class EventMarker : public QObject {
    Q_OBJECT
public:
    static constexpr int kFadeMs = 3000;
    static constexpr float kFaint = 0.35f;

    explicit EventMarker(ViewportWidget& viewport);

    /// A place in grid index units of the volume.
    void mark(const glm::dvec3& place);
    void clear();
    /// 1 at first, kFaint in the end; 0 without a place.
    float strength() const;

private:
    void fade();

    ViewportWidget& viewport_;
    glm::dvec3 place_{0.0};
    bool isMarked_ = false;
    QElapsedTimer sinceMarked_;
    QTimer timer_;
};

} // namespace isoslider::widgets
