#include "ui/widgets/viewport/picture_views.h"

#include <cmath>
#include <utility>

#include <QEvent>
#include <QOpenGLContext>
#include <QOpenGLVersionFunctionsFactory>
#include <QPainter>

#include "ui/render/gl_support.h"

namespace isoslider::widgets {
namespace {

const QColor kNoPicture(33, 36, 40); // until the first comes; within the background's colours

// The owner takes the pointer and the keys.
void setUp(QWidget& view) {
    view.setAttribute(Qt::WA_TransparentForMouseEvents);
    view.setFocusPolicy(Qt::NoFocus);
}

} // namespace

TextureView::TextureView(TextureSource& source, QWidget* parent) : QOpenGLWidget(parent), source_(source) {
    QSurfaceFormat format = render::viewportFormat();
    format.setSamples(0); // pictures come averaged
    setFormat(format);
    setUp(*this);
}

TextureView::~TextureView() {
    releaseGl();
    // The base class destroys the context next, when this is no longer what it was.
    if (context() != nullptr)
        disconnect(context(), nullptr, this, nullptr);
}

void TextureView::releaseGl() {
    source_.contextGoes();
    makeCurrent();
    const GLuint framebuffer = std::exchange(readFramebuffer_, 0);
    // In another context, or in none, the same name would be that of someone else.
    if (context() == nullptr || QOpenGLContext::currentContext() != context())
        return;
    if (auto* gl = QOpenGLVersionFunctionsFactory::get<render::Gl>(context()); gl != nullptr && framebuffer != 0)
        gl->glDeleteFramebuffers(1, &framebuffer);
    doneCurrent();
}

void TextureView::renewContext() {
    QEvent goes(QEvent::WindowAboutToChangeInternal);
    QOpenGLWidget::event(&goes);
    QEvent comes(QEvent::WindowChangeInternal);
    QOpenGLWidget::event(&comes);
    update();
}

void TextureView::initializeGL() {
    // Called again whenever the widget gets a new context, for instance in another window.
    connect(context(), &QOpenGLContext::aboutToBeDestroyed, this, &TextureView::releaseGl, Qt::UniqueConnection);
    readFramebuffer_ = 0;
    source_.contextMade();
    makeCurrent();
}

void TextureView::paintEvent(QPaintEvent* event) {
    // Of a context that cannot be made current any more, paintGL would not hear.
    makeCurrent();
    if (source_.isContextLost())
        return;
    isPaintEvent_ = true;
    QOpenGLWidget::paintEvent(event);
    isPaintEvent_ = false;
}

void TextureView::paintGL() {
    if (source_.isContextLost())
        return;
    const auto picture = source_.pictureToShow(!isPaintEvent_);
    makeCurrent(); // where there is one thread only, another context was
    showTexture(picture.texture);
    source_.noteShown(picture);
}

void TextureView::showTexture(const render::PictureTexture& texture) {
    auto* gl = QOpenGLVersionFunctionsFactory::get<render::Gl>(context());
    if (gl == nullptr || !gl->initializeOpenGLFunctions())
        return;
    if (texture.name == 0) {
        const auto shade = [](int value) { return static_cast<float>(value) / 255.0f; };
        gl->glClearColor(shade(kNoPicture.red()), shade(kNoPicture.green()), shade(kNoPicture.blue()), 1.0f);
        return gl->glClear(GL_COLOR_BUFFER_BIT);
    }
    if (readFramebuffer_ == 0)
        gl->glGenFramebuffers(1, &readFramebuffer_);
    gl->glBindFramebuffer(GL_READ_FRAMEBUFFER, readFramebuffer_);
    gl->glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.name, 0);
    const auto ratio = devicePixelRatioF();
    const glm::ivec2 from = texture.pixels, to(std::lround(width() * ratio), std::lround(height() * ratio));
    gl->glBlitFramebuffer(0, 0, from.x, from.y, 0, 0, to.x, to.y, GL_COLOR_BUFFER_BIT,
                          from == to ? GL_NEAREST : GL_LINEAR);
    gl->glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, 0, 0);
    gl->glBindFramebuffer(GL_FRAMEBUFFER, defaultFramebufferObject());
    source_.noteRead(*gl);
}

ImageView::ImageView(PictureSource& source, QWidget* parent) : QWidget(parent), source_(source) {
    setAttribute(Qt::WA_OpaquePaintEvent);
    setUp(*this);
}

void ImageView::paintEvent(QPaintEvent*) {
    const auto picture = source_.pictureToShow(false);
    QPainter painter(this);
    if (picture.image.isNull())
        painter.fillRect(rect(), kNoPicture);
    else
        painter.drawImage(rect(), picture.image); // of another size while the view is resized
    source_.noteShown(picture);
}

} // namespace isoslider::widgets
