#include "ui/widgets/viewport/viewport_widget.h"

#include <cmath>

#include <QEvent>
#include <QMouseEvent>
#include <QOpenGLContext>
#include <QWheelEvent>

#include "ui/model/isovalue/isovalue_model.h"
#include "ui/render/gl_driver.h"
#include "ui/render/gl_support.h"
#include "ui/render/scene_renderer.h"

namespace isoslider::widgets {
namespace {

constexpr double kOrbitPerHeight = 3.4; // radians for a drag over the view's height
constexpr double kZoomPerHeight = 3.0; // powers of e
constexpr double kZoomPerNotch = 1.15;
constexpr int kFirstRebuildMs = 50; // then twice as long each time
constexpr int kSlowestRebuild = 6; // powers of two: 3.2 s

} // namespace

ViewportWidget::ViewportWidget(QWidget* parent)
    : QOpenGLWidget(parent),
      driver_(std::make_shared<render::GlDriver>()),
      renderer_(std::make_unique<render::SceneRenderer>(driver_)) {
    setObjectName(QStringLiteral("viewport"));
    setFormat(render::viewportFormat());
    setFocusPolicy(Qt::StrongFocus);
    setMinimumSize(120, 60);
    setAccessibleName(tr("3-D view of the isosurface"));
    camera_.reset(1.0);
    rebuildTimer_.setSingleShot(true);
    connect(&rebuildTimer_, &QTimer::timeout, this, &ViewportWidget::rebuildContext);
}

ViewportWidget::~ViewportWidget() {
    releaseGl();
    // The base class destroys the context next, when the renderer is gone already.
    if (context() != nullptr)
        disconnect(context(), nullptr, this, nullptr);
}

void ViewportWidget::releaseGl() {
    makeCurrent();
    // In another context, or in none, the same names would be those of someone else.
    if (context() == nullptr || QOpenGLContext::currentContext() != context())
        return renderer_->abandon();
    renderer_->release();
    doneCurrent();
}

bool ViewportWidget::isLost() {
    if (context() == nullptr || !driver_->isLost(*context()))
        return false;
    if (!rebuildTimer_.isActive())
        rebuildTimer_.start(kFirstRebuildMs << std::min(rebuilds_, kSlowestRebuild));
    return true;
}

void ViewportWidget::rebuildContext() {
    if (++rebuilds_ == kSlowestRebuild)
        Q_EMIT graphicsLost();
    // As Qt does it when the window's surface changes: the context goes, and another comes.
    QEvent goes(QEvent::WindowAboutToChangeInternal);
    QOpenGLWidget::event(&goes);
    QEvent comes(QEvent::WindowChangeInternal);
    QOpenGLWidget::event(&comes);
    update();
}

void ViewportWidget::setDriver(std::shared_ptr<render::GlDriver> driver) {
    releaseGl(); // what the old driver made, it frees
    driver_ = std::move(driver);
    renderer_ = std::make_unique<render::SceneRenderer>(driver_);
    renderer_->setFrame(frame_, volume_);
    rebuildContext();
}

void ViewportWidget::initializeGL() {
    // Called again whenever the widget gets a new context, for instance in another window.
    connect(context(), &QOpenGLContext::aboutToBeDestroyed, this, &ViewportWidget::releaseGl, Qt::UniqueConnection);
    if (!renderer_->initialize())
        qWarning("the viewport's OpenGL context cannot draw the scene");
}

void ViewportWidget::setFrame(std::shared_ptr<const extract::SurfaceFrame> frame,
                              const std::optional<GridGeometry>& volume) {
    isRefusalTold_ = isRefusalTold_ && frame == frame_;
    frame_ = std::move(frame);
    volume_ = volume;
    renderer_->setFrame(frame_, volume_);
    update();
}

std::uint64_t ViewportWidget::uploadedBytes() const { return renderer_->uploadedBytes(); }

void ViewportWidget::setSpot(const std::optional<glm::dvec3>& place, float strength) {
    spot_ = place;
    spotStrength_ = strength;
    update();
}

void ViewportWidget::setOptions(const model::ViewOptions& options) {
    options_ = options;
    update();
}

void ViewportWidget::changeCamera(const std::function<void(model::Camera&)>& change) {
    change(camera_);
    update();
    Q_EMIT cameraChanged();
}

void ViewportWidget::paintEvent(QPaintEvent* event) {
    // Of a context that cannot be made current any more, paintGL would not hear.
    makeCurrent();
    if (!isLost())
        QOpenGLWidget::paintEvent(event);
}

void ViewportWidget::paintGL() {
    if (isLost())
        return;
    rebuilds_ = 0;
    const auto ratio = devicePixelRatioF();
    const glm::ivec2 pixels(std::lround(width() * ratio), std::lround(height() * ratio));
    renderer_->setSpot(spot_ ? std::optional(render::Spot{*spot_, spotStrength_, static_cast<float>(ratio)})
                             : std::nullopt);
    renderer_->draw(camera_, options_, pixels);
    if (renderer_->refusedBytes() > 0 && !std::exchange(isRefusalTold_, true))
        Q_EMIT surfaceRefused(renderer_->refusedBytes());
    ++paintedFrames_;
    Q_EMIT painted();
}

glm::dvec2 ViewportWidget::toScreen(QPointF point) const {
    return {2.0 * point.x() / std::max(1, width()) - 1.0, 1.0 - 2.0 * point.y() / std::max(1, height())};
}

double ViewportWidget::aspect() const { return static_cast<double>(width()) / std::max(1, height()); }

void ViewportWidget::mousePressEvent(QMouseEvent* event) {
    lastPoint_ = pressPoint_ = event->position();
    setFocus(Qt::MouseFocusReason);
}

void ViewportWidget::mouseMoveEvent(QMouseEvent* event) {
    const QPointF moved = event->position() - lastPoint_;
    const double height = std::max(1, this->height());
    const bool isShift = event->modifiers().testFlag(Qt::ShiftModifier);
    const auto buttons = event->buttons();
    if (buttons.testFlag(Qt::MiddleButton) || (buttons.testFlag(Qt::LeftButton) && isShift)) {
        const glm::dvec2 step = toScreen(event->position()) - toScreen(lastPoint_);
        changeCamera([&](model::Camera& camera) { camera.pan(step, aspect()); });
    } else if (buttons.testFlag(Qt::LeftButton)) {
        changeCamera([&](model::Camera& camera) {
            camera.orbit(moved.x() / height * kOrbitPerHeight, -moved.y() / height * kOrbitPerHeight);
        });
    } else if (buttons.testFlag(Qt::RightButton)) {
        changeCamera([&](model::Camera& camera) {
            camera.zoom(std::exp(-moved.y() / height * kZoomPerHeight), toScreen(pressPoint_), aspect());
        });
    }
    lastPoint_ = event->position();
}

void ViewportWidget::wheelEvent(QWheelEvent* event) {
    const QPoint angle = event->angleDelta();
    const double notches = (angle.y() != 0 ? angle.y() : angle.x()) / 120.0;
    const bool isFine = event->modifiers().testFlag(Qt::ShiftModifier);
    if (event->modifiers().testFlag(Qt::ControlModifier))
        Q_EMIT stepRequested(notches * model::kFineStep / (isFine ? model::kPrecisionFactor : 1.0));
    else
        changeCamera([&](model::Camera& camera) {
            camera.zoom(std::pow(kZoomPerNotch, notches), toScreen(event->position()), aspect());
        });
    event->accept();
}

} // namespace isoslider::widgets
