#pragma once

#include <QLabel>
#include <QStringList>
#include <QWidget>

#include <glm/gtc/quaternion.hpp>

namespace isoslider::widgets {

/// The directions of X, Y and Z, or of a patient's left, posterior and superior, as the camera sees them; sits in a
/// corner of the view and lets all pointer events through.
class AxesGlyph : public QWidget {
    Q_OBJECT
public:
    explicit AxesGlyph(QWidget* parent = nullptr);
    void setOrientation(const glm::dquat& cameraToWorld);
    /// Whether the world's axes are a patient's.
    void setPatient(bool isPatient);
    QStringList letters() const;
    /// In darker colours.
    void setOnLight(bool isOnLight);
    /// As it is seen; for pictures that are saved.
    void paint(QPainter& painter) const;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    glm::dquat worldToCamera_{1.0, 0.0, 0.0, 0.0};
    bool isOnLight_ = false;
    bool isPatient_ = false;
};

/// A line or two of text on the view, legible on any picture.
class ViewReadout : public QLabel {
    Q_OBJECT
public:
    explicit ViewReadout(QWidget* parent = nullptr, const QColor& colour = QColor(238, 241, 245));
};

} // namespace isoslider::widgets
