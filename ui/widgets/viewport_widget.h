#pragma once

#include <memory>
#include <optional>

#include <QOpenGLWidget>
#include <QPoint>

#include "core/extract/surface_frame.h"
#include "ui/model/camera.h"
#include "ui/model/view_state.h"

namespace isoslider::render {
class SceneRenderer;
}

namespace isoslider::widgets {

/// The 3-D view: owns the OpenGL context and turns pointer moves into camera moves; the drawing is
/// in ui/render. Left drag orbits, middle or Shift+left pans, right drag and the wheel zoom.
/// REQUIRES: render::isOpenGlUsable().
class ViewportWidget : public QOpenGLWidget {
    Q_OBJECT
public:
    explicit ViewportWidget(QWidget* parent = nullptr);
    ~ViewportWidget() override;

    /// See render::SceneRenderer.
    void setFrame(std::shared_ptr<const extract::SurfaceFrame> frame,
                  const std::optional<GridGeometry>& volume = {});
    void setOptions(const model::ViewOptions& options);
    const model::Camera& camera() const { return camera_; }
    /// Changes the camera and draws again.
    void changeCamera(const std::function<void(model::Camera&)>& change);
    /// Frames painted so far: lets a caller wait for what it set to be on screen.
    std::uint64_t paintedFrames() const { return paintedFrames_; }

Q_SIGNALS:
    void cameraChanged();
    void painted();
    /// The wheel with Ctrl: a step of the isovalue.
    void stepRequested(double rangeFraction);

protected:
    void initializeGL() override;
    void paintGL() override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;

private:
    void releaseGl();
    glm::dvec2 toScreen(QPointF point) const;
    double aspect() const;

    std::unique_ptr<render::SceneRenderer> renderer_;
    model::Camera camera_;
    model::ViewOptions options_;
    QPointF lastPoint_;
    QPointF pressPoint_;
    std::uint64_t paintedFrames_ = 0;
};

} // namespace isoslider::widgets
