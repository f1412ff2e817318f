#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <QImage>
#include <QPoint>
#include <QTimer>
#include <QWidget>

#include "core/extract/surface_frame.h"
#include "ui/model/surface/camera.h"
#include "ui/model/surface/view_state.h"
#include "ui/render/scene_thread.h"
#include "ui/widgets/viewport/picture_views.h"

namespace isoslider::widgets {

/// How pictures come into the window: as textures that it is composed of by OpenGL, or as images.
enum class PictureWay { Best, Textures, Images };

/// The 3-D view: shows pictures that a separate thread draws (ui/render/scene_thread), so that nothing here waits for
/// a large surface, and turns pointer moves into camera moves. What is grabbed is whole and up to date. Left drag
/// orbits, middle or Shift+left pans, right drag and the wheel zoom.
/// REQUIRES: render::isOpenGlUsable().
class ViewportWidget : public QWidget, private TextureSource {
    Q_OBJECT
public:
    /// Best: as images where the processor draws, in place of a card.
    explicit ViewportWidget(QWidget* parent = nullptr, PictureWay way = PictureWay::Best);
    ~ViewportWidget() override;

    /// See render::SceneView.
    void setFrame(std::shared_ptr<const extract::SurfaceFrame> frame, const std::optional<GridGeometry>& volume = {});
    /// Points a place out in the next picture; see render::Spot.
    void setSpot(const std::optional<glm::dvec3>& place, float strength = 1.0f);
    void setOptions(const model::ViewOptions& options);
    void setSlices(render::SliceScene slices);
    void setCaps(render::CapScenes caps);
    void setColours(const model::SurfaceColours& colours);
    /// How the frame is drawn, and the surfaces beside it.
    void setSurfaces(const render::SurfaceLook& look, std::vector<render::InactiveSurface> inactive);
    const model::Camera& camera() const { return camera_; }
    /// Changes the camera and draws again.
    void changeCamera(const std::function<void(model::Camera&)>& change);
    /// The stretch of the line of sight through a point of the widget that can be seen, nearest end first; grid index
    /// units of the frame. None without a frame.
    std::optional<std::pair<glm::dvec3, glm::dvec3>> lineOfSight(QPointF point) const;
    /// Puts another in the place of the driver, and makes a context again for it. For tests.
    void setDriver(std::shared_ptr<render::GlDriver> driver);
    /// Whole, of all that was set, in pixels of the screen.
    QImage grabFramebuffer();
    /// The same in so many pixels, with or without the background, drawn while the window goes on; null without a view
    /// to draw. REQUIRES: the pixels are not empty.
    std::shared_ptr<render::PictureOrder> orderPicture(QSize size, bool isTransparent);
    /// Of the view on its screen.
    glm::ivec2 pixels() const;
    /// Brings the newest picture to the screen once more.
    void showAgain() { view_->update(); }
    /// The widget that shows the pictures, and the context of it or, with images, of them. For tests.
    QWidget& view() { return *view_; }
    QOpenGLContext* context() const;
    /// Paints so far that showed all that was set until then, whole: lets a caller wait for what it set to be on
    /// screen.
    std::uint64_t paintedFrames() const { return paintedFrames_; }
    /// Of the surface in the picture on screen, which may be behind the frame; none without one.
    std::optional<double> shownIsovalue() const { return shownIsovalue_; }
    /// Bytes of surfaces sent to the graphics card so far, in this context.
    std::uint64_t uploadedBytes() const;

Q_SIGNALS:
    void cameraChanged();
    /// What is set waits for its picture, or no longer does.
    void behindChanged(bool isBehind);
    /// Another picture may be on screen.
    void painted();
    /// The graphics card has no memory for the present surface, which takes so many bytes: it is not drawn.
    void surfaceRefused(quint64 bytes);
    /// The graphics card was reset and has not come back within seconds; it is still waited for.
    void graphicsLost();
    /// The wheel with Ctrl: a step of the isovalue.
    void stepRequested(double rangeFraction);
    /// The wheel with Alt: so many slices away from the viewer.
    void sliceStepRequested(double notches);
    /// A click with the left button that moved nothing.
    void clicked(QPointF point);
    /// A double click with the left button.
    void picked(QPointF point);
    /// A click with the right button that moved nothing, or the menu key (then in the middle).
    void menuRequested(QPointF point);

protected:
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;

private:
    /// By Ctrl or Shift and a key; false for any other.
    bool moveCamera(const QKeyEvent& event);
    render::SceneThread::Picture pictureToShow(bool isGrabbed) override;
    void noteShown(const render::SceneThread::Picture& picture) override;
    void contextMade() override;
    void contextGoes() override;
    bool isContextLost() override;
    void noteRead(render::Gl& gl) override;

    void makeScene();
    void dropScene();
    void noteBehind();
    void awaitContext();
    void rebuildContext();
    void setStale();
    void askIfStale();
    bool hasScene();
    render::SceneView sceneView() const;
    void ask(render::PictureUse use = {});
    void notePicture();
    glm::dvec2 toScreen(QPointF point) const;
    double aspect() const;

    std::shared_ptr<render::GlDriver> driver_;
    TextureView* textures_ = nullptr; ///< null where pictures come as images
    QWidget* view_ = nullptr;
    std::unique_ptr<render::SceneThread> scene_; ///< null without a context
    bool isBehind_ = false;
    bool isStale_ = false; ///< something was set that no picture was asked for yet
    std::uint64_t asked_ = 0; ///< the last number of a view
    glm::ivec2 askedPixels_{0};
    std::uint64_t askedOfFrame_ = 0; ///< the first with frame_
    std::optional<double> shownIsovalue_;
    std::shared_ptr<const extract::SurfaceFrame> frame_;
    std::optional<GridGeometry> volume_;
    std::optional<glm::dvec3> spot_;
    float spotStrength_ = 0.0f;
    QTimer rebuildTimer_;
    int rebuilds_ = 0; ///< in a row, without a picture
    bool isRefusalTold_ = false; ///< of frame_
    model::Camera camera_;
    model::ViewOptions options_;
    render::SliceScene slices_;
    render::CapScenes caps_;
    model::SurfaceColours colours_;
    render::SurfaceLook look_;
    std::vector<render::InactiveSurface> inactive_;
    QPointF lastPoint_;
    QPointF pressPoint_;
    double farthestFromPress_ = 0.0;
    std::uint64_t paintedFrames_ = 0;
};

} // namespace isoslider::widgets
