#pragma once

#include <optional>

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>

#include <glm/vec3.hpp>

namespace isoslider::widgets {

class ViewportWidget;

/// Points a place out in a view: clearly at first, faintly after 3 s, until it is taken away. What is passed on the way
/// is pointed out instead for a moment, and fades.
class EventMarker : public QObject {
    Q_OBJECT
public:
    static constexpr int kFadeMs = 3000;
    static constexpr int kMomentMs = 500; ///< that something passed is clear
    static constexpr int kPassingMs = 1000; ///< that it takes to fade then
    static constexpr float kFaint = 0.35f;

    explicit EventMarker(ViewportWidget& viewport);

    /// A place in grid index units of the volume.
    void mark(const glm::dvec3& place);
    /// The same for a moment.
    void markPassed(const glm::dvec3& place);
    void clear();
    /// The place that is pointed out now.
    std::optional<glm::dvec3> pointedOut() const {
        return hasPassed_ ? std::optional(passed_) : isMarked_ ? std::optional(place_) : std::nullopt;
    }

private:
    void fade();
    void fadePassed();

    ViewportWidget& viewport_;
    glm::dvec3 place_{0.0};
    glm::dvec3 passed_{0.0};
    bool isMarked_ = false, hasPassed_ = false;
    QElapsedTimer sinceMarked_, sincePassed_;
    QTimer timer_, passedTimer_;
};

} // namespace isoslider::widgets
