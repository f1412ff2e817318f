#pragma once

#include <QOpenGLWidget>

#include "ui/render/scene_thread.h"

namespace isoslider::widgets {

/// What a view of pictures asks its owner.
class PictureSource {
public:
    virtual ~PictureSource() = default;
    /// The newest picture; when it is grabbed, that of all that was set.
    virtual render::SceneThread::Picture pictureToShow(bool isGrabbed) = 0;
    /// It is on the way to the screen.
    virtual void noteShown(const render::SceneThread::Picture& picture) = 0;
};

/// The same of one that composes the window with OpenGL, whose context comes and goes with the window.
class TextureSource : public PictureSource {
public:
    virtual void contextMade() = 0;
    virtual void contextGoes() = 0;
    /// Then nothing is drawn; another context is on its way.
    virtual bool isContextLost() = 0;
    virtual void noteRead(render::Gl& gl) = 0;
};

/// Shows pictures that a card has drawn without taking them off the card.
/// REQUIRES: render::isOpenGlUsable().
class TextureView : public QOpenGLWidget {
    Q_OBJECT
public:
    TextureView(TextureSource& source, QWidget* parent);
    ~TextureView() override;
    /// As Qt does it when the window's surface changes: the context goes, and another comes.
    void renewContext();

protected:
    void initializeGL() override;
    void paintGL() override;
    void paintEvent(QPaintEvent* event) override;

private:
    void releaseGl();
    void showTexture(const render::PictureTexture& texture);

    TextureSource& source_;
    GLuint readFramebuffer_ = 0; ///< through which a picture's texture is read
    bool isPaintEvent_ = false; ///< not a grab
};

/// Shows pictures that the processor has drawn anyway: the window is painted without OpenGL, which would take the
/// processor's time from the drawing, and wait for it.
class ImageView : public QWidget {
    Q_OBJECT
public:
    ImageView(PictureSource& source, QWidget* parent);

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    PictureSource& source_;
};

} // namespace isoslider::widgets
