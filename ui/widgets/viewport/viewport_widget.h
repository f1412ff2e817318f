#pragma once

#include <memory>
#include <optional>

#include <QOpenGLWidget>
#include <QPoint>
#include <QTimer>

#include "core/extract/surface_frame.h"
#include "ui/model/surface/camera.h"
#include "ui/model/surface/view_state.h"

namespace isoslider::render {
class GlDriver;
class SceneRenderer;
} // namespace isoslider::render

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
    void setFrame(std::shared_ptr<const extract::SurfaceFrame> frame, const std::optional<GridGeometry>& volume = {});
    /// Points a place out in the next picture; see render::Spot.
    void setSpot(const std::optional<glm::dvec3>& place, float strength = 1.0f);
    void setOptions(const model::ViewOptions& options);
    const model::Camera& camera() const { return camera_; }
    /// Changes the camera and draws again.
    void changeCamera(const std::function<void(model::Camera&)>& change);
    /// Puts another in the place of the driver, and makes a context again for it. For tests.
    void setDriver(std::shared_ptr<render::GlDriver> driver);
    /// Frames painted so far: lets a caller wait for what it set to be on screen.
    std::uint64_t paintedFrames() const { return paintedFrames_; }
    /// Bytes of surfaces sent to the graphics card so far, in this context.
    std::uint64_t uploadedBytes() const;

Q_SIGNALS:
    void cameraChanged();
    void painted();
    /// The graphics card has no memory for the present surface, which takes so many bytes: it is not drawn.
    void surfaceRefused(quint64 bytes);
    /// The graphics card was reset and has not come back within seconds; it is still waited for.
    void graphicsLost();
    /// The wheel with Ctrl: a step of the isovalue.
    void stepRequested(double rangeFraction);

protected:
    void initializeGL() override;
    void paintGL() override;
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;

private:
    void releaseGl();
    bool isLost();
    void rebuildContext();
    glm::dvec2 toScreen(QPointF point) const;
    double aspect() const;

    std::shared_ptr<render::GlDriver> driver_;
    std::unique_ptr<render::SceneRenderer> renderer_;
    std::shared_ptr<const extract::SurfaceFrame> frame_;
    std::optional<GridGeometry> volume_;
    std::optional<glm::dvec3> spot_;
    float spotStrength_ = 0.0f;
    QTimer rebuildTimer_;
    int rebuilds_ = 0; ///< in a row, without a picture
    bool isRefusalTold_ = false; ///< of frame_
    model::Camera camera_;
    model::ViewOptions options_;
    QPointF lastPoint_;
    QPointF pressPoint_;
    std::uint64_t paintedFrames_ = 0;
};

} // namespace isoslider::widgets
