#include "ui/widgets/viewport/viewport_widget.h"

#include <algorithm>
#include <cmath>

#include <QGuiApplication>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QStyleHints>
#include <QWheelEvent>

#include "ui/model/isovalue/isovalue_model.h"
#include "ui/render/gl_driver.h"
#include "ui/render/gl_support.h"
#include "ui/render/scene_renderer.h"

namespace isoslider::widgets {
namespace {

constexpr double kOrbitPerHeight = 3.4; // radians for a drag over the view's height
constexpr double kZoomPerHeight = 3.0; // powers of e
constexpr double kOrbitPerKey = 0.1309; // 7.5 degrees
constexpr double kPanPerKey = 0.1; // of half the height
constexpr double kZoomPerKey = 1.25;
constexpr double kZoomPerNotch = 1.15;
constexpr int kFirstRebuildMs = 50; // then twice as long each time
constexpr int kSlowestRebuild = 6; // powers of two: 3.2 s

} // namespace

ViewportWidget::ViewportWidget(QWidget* parent, PictureWay way)
    : QWidget(parent), driver_(std::make_shared<render::GlDriver>()) {
    setObjectName(QStringLiteral("viewport"));
    setFocusPolicy(Qt::StrongFocus);
    setMinimumSize(120, 60);
    setAccessibleName(tr("3-D view of the isosurface"));
    if (way == PictureWay::Best)
        way = render::isOpenGlSoftware() ? PictureWay::Images : PictureWay::Textures;
    if (way == PictureWay::Textures)
        view_ = textures_ = new TextureView(*this, this);
    else
        view_ = new ImageView(*this, this);
    camera_.reset(1.0);
    rebuildTimer_.setSingleShot(true);
    connect(&rebuildTimer_, &QTimer::timeout, this, &ViewportWidget::rebuildContext);
}

ViewportWidget::~ViewportWidget() {
    disconnect(this, nullptr, nullptr, nullptr); // nobody is told of what follows
    delete view_; // it asks for pictures
}

void ViewportWidget::resizeEvent(QResizeEvent*) {
    view_->setGeometry(rect());
    setStale();
}

void ViewportWidget::contextMade() {
    dropScene(); // of a context that went unnoticed
    makeScene();
}

void ViewportWidget::makeScene() {
    scene_ =
        std::make_unique<render::SceneThread>(textures_ != nullptr ? textures_->context() : nullptr, driver_, [this] {
            QMetaObject::invokeMethod(this, &ViewportWidget::notePicture, Qt::QueuedConnection);
        });
    asked_ = askedOfFrame_ = 0;
    isStale_ = true;
}

void ViewportWidget::contextGoes() { dropScene(); }

void ViewportWidget::dropScene() {
    scene_.reset();
    noteBehind();
    setStale();
}

void ViewportWidget::noteBehind() {
    const bool isBehind = scene_ && scene_->isBehind();
    if (std::exchange(isBehind_, isBehind) != isBehind)
        Q_EMIT behindChanged(isBehind);
}

void ViewportWidget::notePicture() {
    if (!scene_)
        return;
    noteBehind();
    if (scene_->isLost())
        awaitContext();
    else if (!scene_->isWorking())
        qWarning("the viewport's OpenGL context cannot draw the scene");
    else
        view_->update();
}

bool ViewportWidget::isContextLost() {
    if (textures_->context() == nullptr || !driver_->isLost(*textures_->context()))
        return false;
    awaitContext();
    return true;
}

void ViewportWidget::awaitContext() {
    if (!rebuildTimer_.isActive())
        rebuildTimer_.start(kFirstRebuildMs << std::min(rebuilds_, kSlowestRebuild));
}

void ViewportWidget::rebuildContext() {
    if (++rebuilds_ == kSlowestRebuild)
        Q_EMIT graphicsLost();
    if (textures_ != nullptr)
        return textures_->renewContext();
    dropScene();
    view_->update();
}

void ViewportWidget::setDriver(std::shared_ptr<render::GlDriver> driver) {
    dropScene(); // what the old driver made, it frees
    driver_ = std::move(driver);
    if (textures_ != nullptr && textures_->context() == nullptr)
        return; // it comes with the window
    rebuildContext();
}

QOpenGLContext* ViewportWidget::context() const {
    if (textures_ != nullptr)
        return textures_->context();
    return scene_ ? scene_->context() : nullptr;
}

void ViewportWidget::setFrame(std::shared_ptr<const extract::SurfaceFrame> frame,
                              const std::optional<GridGeometry>& volume) {
    isRefusalTold_ = isRefusalTold_ && frame == frame_;
    if (frame != frame_)
        askedOfFrame_ = asked_ + 1;
    frame_ = std::move(frame);
    volume_ = volume;
    setStale();
}

std::uint64_t ViewportWidget::uploadedBytes() const { return scene_ ? scene_->uploadedBytes() : 0; }

void ViewportWidget::setSpot(const std::optional<glm::dvec3>& place, float strength) {
    spot_ = place;
    spotStrength_ = strength;
    setStale();
}

void ViewportWidget::setOptions(const model::ViewOptions& options) {
    options_ = options;
    setStale();
}

void ViewportWidget::setSlices(render::SliceScene slices) {
    slices_ = std::move(slices);
    setStale();
}

void ViewportWidget::setCaps(render::CapScenes caps) {
    caps_ = std::move(caps);
    setStale();
}

void ViewportWidget::setColours(const model::SurfaceColours& colours) {
    if (colours == colours_)
        return;
    colours_ = colours;
    setStale();
}

void ViewportWidget::setSurfaces(const render::SurfaceLook& look, std::vector<render::InactiveSurface> inactive) {
    if (look == look_ && inactive == inactive_)
        return; // nothing is drawn again
    look_ = look;
    const bool isSame = std::equal(
        inactive.begin(), inactive.end(), inactive_.begin(), inactive_.end(),
        [](const render::InactiveSurface& a, const render::InactiveSurface& b) { return a.frame == b.frame; });
    isRefusalTold_ = isRefusalTold_ && isSame;
    inactive_ = std::move(inactive);
    setStale();
}

void ViewportWidget::changeCamera(const std::function<void(model::Camera&)>& change) {
    change(camera_);
    setStale();
    Q_EMIT cameraChanged();
}

// What is set within one event is asked for together.
void ViewportWidget::setStale() {
    if (!std::exchange(isStale_, true))
        QMetaObject::invokeMethod(this, &ViewportWidget::askIfStale, Qt::QueuedConnection);
}

void ViewportWidget::askIfStale() {
    if (isStale_ && isVisible())
        ask();
}

glm::ivec2 ViewportWidget::pixels() const {
    const auto ratio = devicePixelRatioF();
    return {std::lround(width() * ratio), std::lround(height() * ratio)};
}

// One whose pixels can be drawn.
bool ViewportWidget::hasScene() {
    if (!scene_ && textures_ == nullptr)
        makeScene();
    const glm::ivec2 size = pixels();
    return scene_ != nullptr && size.x > 0 && size.y > 0;
}

render::SceneView ViewportWidget::sceneView() const {
    render::SceneView view{frame_,   volume_, {},    slices_,   camera_, options_,
                           pixels(), caps_,   look_, inactive_, colours_};
    view.lineWidth = static_cast<float>(devicePixelRatioF());
    if (spot_)
        view.spot = render::Spot{*spot_, spotStrength_, static_cast<float>(devicePixelRatioF())};
    return view;
}

void ViewportWidget::ask(render::PictureUse use) {
    askedPixels_ = pixels();
    if (!hasScene())
        return;
    isStale_ = false;
    asked_ = scene_->ask(sceneView(), use);
    noteBehind();
}

std::shared_ptr<render::PictureOrder> ViewportWidget::orderPicture(QSize size, bool isTransparent) {
    if (!hasScene())
        return nullptr;
    render::SceneView view = sceneView();
    view.spot.reset(); // it points out something to whoever looks at the window
    view.pixels = {size.width(), size.height()};
    view.lineWidth = static_cast<float>(size.width()) / static_cast<float>(std::max(1, width()));
    auto order = std::make_shared<render::PictureOrder>(std::move(view), isTransparent);
    scene_->order(order);
    return order;
}

render::SceneThread::Picture ViewportWidget::pictureToShow(bool isGrabbed) {
    if (isGrabbed) {
        ask({.mustBeWhole = true});
        if (scene_)
            scene_->waitFor(asked_);
    } else if (isStale_ || pixels() != askedPixels_) {
        ask();
    }
    return scene_ ? scene_->take() : render::SceneThread::Picture();
}

void ViewportWidget::noteShown(const render::SceneThread::Picture& picture) {
    if (picture.serial > 0)
        rebuilds_ = 0;
    if (picture.refusedBytes > 0 && picture.serial >= askedOfFrame_ && !std::exchange(isRefusalTold_, true))
        Q_EMIT surfaceRefused(picture.refusedBytes);
    shownIsovalue_ = picture.isovalue;
    if (picture.serial == asked_ && picture.serial > 0 && !isStale_ && !picture.isDraft)
        ++paintedFrames_;
    Q_EMIT painted();
}

void ViewportWidget::noteRead(render::Gl& gl) {
    if (scene_)
        scene_->noteRead(gl);
}

QImage ViewportWidget::grabFramebuffer() {
    ask({.mustBeWhole = true, .asImage = true});
    render::SceneThread::Picture picture;
    if (scene_) {
        scene_->waitFor(asked_);
        picture = scene_->take();
        noteShown(picture);
        view_->update();
    }
    if (picture.image.isNull()) {
        picture.image = QImage(std::max(1, pixels().x), std::max(1, pixels().y), QImage::Format_RGB32);
        picture.image.fill(Qt::black);
    }
    return picture.image;
}

glm::dvec2 ViewportWidget::toScreen(QPointF point) const {
    return {2.0 * point.x() / std::max(1, width()) - 1.0, 1.0 - 2.0 * point.y() / std::max(1, height())};
}

double ViewportWidget::aspect() const { return static_cast<double>(width()) / std::max(1, height()); }

void ViewportWidget::mousePressEvent(QMouseEvent* event) {
    lastPoint_ = pressPoint_ = event->position();
    farthestFromPress_ = 0.0;
    setFocus(Qt::MouseFocusReason);
}

void ViewportWidget::mouseMoveEvent(QMouseEvent* event) {
    const QPointF moved = event->position() - lastPoint_;
    farthestFromPress_ = std::max(farthestFromPress_, (event->position() - pressPoint_).manhattanLength());
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

void ViewportWidget::mouseReleaseEvent(QMouseEvent* event) {
    if (farthestFromPress_ >= QGuiApplication::styleHints()->startDragDistance())
        return;
    if (event->button() == Qt::RightButton)
        Q_EMIT menuRequested(event->position());
    else if (event->button() == Qt::LeftButton)
        Q_EMIT clicked(event->position());
}

void ViewportWidget::mouseDoubleClickEvent(QMouseEvent* event) {
    mousePressEvent(event);
    if (event->button() == Qt::LeftButton)
        Q_EMIT picked(event->position());
}

void ViewportWidget::keyPressEvent(QKeyEvent* event) {
    if (event->key() == Qt::Key_Menu)
        Q_EMIT menuRequested(QRectF(rect()).center());
    else if (!moveCamera(*event))
        QWidget::keyPressEvent(event);
}

// As the pointer would: the scene goes where the arrow points.
bool ViewportWidget::moveCamera(const QKeyEvent& event) {
    const bool isCtrl = event.modifiers().testFlag(Qt::ControlModifier);
    const bool isShift = event.modifiers().testFlag(Qt::ShiftModifier);
    if (isCtrl == isShift)
        return false;
    glm::dvec2 way(0.0);
    switch (event.key()) {
        case Qt::Key_Left: way.x = -1.0; break;
        case Qt::Key_Right: way.x = 1.0; break;
        case Qt::Key_Up: way.y = 1.0; break;
        case Qt::Key_Down: way.y = -1.0; break;
        case Qt::Key_PageUp:
        case Qt::Key_PageDown:
            if (!isCtrl)
                return false;
            changeCamera([&](model::Camera& camera) {
                camera.zoom(event.key() == Qt::Key_PageUp ? kZoomPerKey : 1.0 / kZoomPerKey, {0.0, 0.0}, aspect());
            });
            return true;
        default: return false;
    }
    changeCamera([&](model::Camera& camera) {
        if (isCtrl)
            camera.orbit(way.x * kOrbitPerKey, way.y * kOrbitPerKey);
        else
            camera.pan(way * kPanPerKey, aspect());
    });
    return true;
}

std::optional<std::pair<glm::dvec3, glm::dvec3>> ViewportWidget::lineOfSight(QPointF point) const {
    if (!frame_)
        return std::nullopt;
    const glm::dmat4 toClip = camera_.projectionMatrix(aspect()) * camera_.viewMatrix() *
                              render::indexToCentredWorld(frame_->geometry, volume_.value_or(frame_->geometry));
    const glm::dmat4 toIndex = glm::inverse(toClip);
    const auto at = [&](double depth) {
        const glm::dvec4 place = toIndex * glm::dvec4(toScreen(point), depth, 1.0);
        return glm::dvec3(place) / place.w;
    };
    return std::pair(at(-1.0), at(1.0));
}

void ViewportWidget::wheelEvent(QWheelEvent* event) {
    const QPoint angle = event->angleDelta();
    const double notches = (angle.y() != 0 ? angle.y() : angle.x()) / 120.0;
    const bool isFine = event->modifiers().testFlag(Qt::ShiftModifier);
    if (event->modifiers().testFlag(Qt::AltModifier))
        Q_EMIT sliceStepRequested(notches);
    else if (event->modifiers().testFlag(Qt::ControlModifier))
        Q_EMIT stepRequested(notches * model::kFineStep / (isFine ? model::kPrecisionFactor : 1.0));
    else
        changeCamera([&](model::Camera& camera) {
            camera.zoom(std::pow(kZoomPerNotch, notches), toScreen(event->position()), aspect());
        });
    event->accept();
}

} // namespace isoslider::widgets
