#include "ui/render/scene_thread.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLVersionFunctionsFactory>
#include <QThread>

#include "ui/render/gl_support.h"
#include "ui/render/picture_alpha.h"
#include "ui/render/scene_renderer.h"
#include "ui/render/transparent_layers.h"

namespace isoslider::render {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kSamples = 4;
/// A picture that is expected to take longer is preceded by a draft.
constexpr double kFluentMs = 40.0;
/// A view nothing follows for so long is drawn whole.
constexpr std::chrono::milliseconds kRest(100);
/// So long a picture that was ordered gives way to views, and begins again; then they wait for it.
constexpr std::chrono::milliseconds kLongestGivingWay(1000);

double millisecondsSince(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

bool givesWayNoMore(Clock::time_point ordered) { return Clock::now() - ordered > kLongestGivingWay; }

/// At least so many that what a picture costs without any surface is seen to be small.
double trianglesOf(const SceneView& view) {
    constexpr double kFewTriangles = 10'000.0;
    double triangles = 0.0;
    const auto add = [&](const extract::SurfaceFrame& frame, const SurfaceLook& look) {
        if (look.isVisible)
            triangles += static_cast<double>(frame.stats.triangles) *
                         (look.isOpaque() ? 1 : TransparentLayers::layersFor(look.opacity, false));
    };
    if (view.frame)
        add(*view.frame, view.look);
    for (const InactiveSurface& surface : view.inactive)
        add(*surface.frame, surface.look);
    return std::max(triangles, kFewTriangles);
}

/// Half as many pixels each way.
SceneView draftOf(SceneView view) {
    view.pixels = (view.pixels + 1) / 2;
    if (view.spot)
        view.spot->pixelRatio /= 2.0f;
    view.lineWidth /= 2.0f;
    return view;
}

} // namespace

/// The context and what lives in it.
class SceneThread::Painter {
public:
    Painter(QOpenGLContext* shared, std::shared_ptr<GlDriver> driver)
        : isAlwaysImage_(shared == nullptr), driver_(driver), renderer_(std::move(driver)) {
        context_.setFormat(shared != nullptr ? shared->format() : viewportFormat());
        context_.setShareContext(shared);
        isWorking_ = context_.create();
        surface_.setFormat(context_.format());
        surface_.create();
    }

    void moveTo(QThread* thread) { context_.moveToThread(thread); }
    /// Where it was made and is destroyed.
    QThread* home() const { return home_; }

    bool begin() {
        isWorking_ = isWorking_ && context_.makeCurrent(&surface_);
        if (!isWorking_)
            return false;
        gl_ = QOpenGLVersionFunctionsFactory::get<Gl>(&context_);
        isWorking_ = gl_ != nullptr && gl_->initializeOpenGLFunctions() && renderer_.initialize();
        if (isWorking_) {
            whole_.emplace(*gl_, kSamples);
            draft_.emplace(*gl_, 0);
        }
        return isWorking_;
    }
    void end(std::array<Slot, 3>& places) {
        if (!makeCurrent()) {
            for (auto* target : {&whole_, &draft_})
                if (*target)
                    (*target)->abandon();
            return renderer_.abandon();
        }
        for (Slot& slot : places) {
            if (slot.read != nullptr)
                gl_->glDeleteSync(slot.read);
            gl_->glDeleteTextures(1, &slot.picture.texture.name);
            slot.read = nullptr;
            slot.picture = {};
        }
        gl_->glDeleteTextures(1, &ordered_.name);
        ordered_ = {};
        whole_.reset();
        draft_.reset();
        renderer_.release();
        context_.doneCurrent();
    }
    /// Of one thread: whose context is current changes between calls.
    bool makeCurrent() { return gl_ != nullptr && context_.makeCurrent(&surface_); }

    void waitUntilRead(GLsync& read) {
        if (read == nullptr)
            return;
        gl_->glWaitSync(read, 0, GL_TIMEOUT_IGNORED);
        gl_->glDeleteSync(std::exchange(read, nullptr));
    }

    /// Of a context that is shared the other side asks.
    bool isLost() { return isAlwaysImage_ && driver_->isLost(context_); }
    QOpenGLContext& context() { return context_; }

    /// False if it was stopped.
    bool draw(const Asked& asked, bool isDraft, Picture& picture, const std::function<bool()>& isStopped) {
        const SceneView view = isDraft ? draftOf(asked.view) : asked.view;
        PictureTarget& target = isDraft ? *draft_ : *whole_;
        if (!target.bind(view.pixels))
            return true; // there is no memory left for anything: nothing can be said in a picture
        const auto begin = Clock::now();
        if (!renderer_.draw(view, isDraft ? SceneRenderer::Detail::Coarse : SceneRenderer::Detail::Whole, isStopped))
            return false;
        target.resolve(picture.texture);
        if (isAlwaysImage_ || asked.use.asImage)
            picture.image = target.read(picture.texture, asked.view.pixels);
        gl_->glFinish(); // the texture is read in another context
        if (!isDraft)
            msPerTriangle_ = millisecondsSince(begin) / trianglesOf(view);
        return true;
    }
    /// A whole picture that nobody is shown; none if it was stopped, a null one without memory for it.
    std::optional<QImage> draw(const PictureOrder& order, const std::function<bool()>& isStopped) {
        SceneView view = order.view();
        if (order.isTransparent())
            view.plainBackground = glm::vec3(0.0f);
        auto picture = draw(view, isStopped);
        if (picture && !picture->isNull() && order.isTransparent()) {
            view.plainBackground = glm::vec3(1.0f);
            const auto onWhite = draw(view, isStopped);
            if (!onWhite || onWhite->isNull())
                return onWhite;
            picture = withoutBackground(*picture, *onWhite);
        }
        gl_->glDeleteTextures(1, &ordered_.name); // it may be larger than any that is shown
        ordered_ = {};
        return picture;
    }
    /// Of a whole picture, from the last one.
    double expectedMs(const SceneView& view) const { return msPerTriangle_ * trianglesOf(view); }
    double expectedMs(const PictureOrder& order) const {
        return (order.isTransparent() ? 2.0 : 1.0) * expectedMs(order.view());
    }

    std::uint64_t refusedBytes() const { return renderer_.refusedBytes(); }
    std::uint64_t uploadedBytes() const { return renderer_.uploadedBytes(); }

private:
    std::optional<QImage> draw(const SceneView& view, const std::function<bool()>& isStopped) {
        if (!whole_->bind(view.pixels))
            return QImage();
        if (!renderer_.draw(view, SceneRenderer::Detail::Whole, isStopped))
            return std::nullopt;
        forgetErrors(*gl_);
        whole_->resolve(ordered_);
        QImage picture = whole_->read(ordered_, view.pixels);
        return gl_->glGetError() == GL_NO_ERROR ? std::move(picture) : QImage(); // no memory for it
    }

    QThread* home_ = QThread::currentThread();
    bool isAlwaysImage_;
    std::shared_ptr<GlDriver> driver_;
    QOpenGLContext context_;
    QOffscreenSurface surface_;
    SceneRenderer renderer_;
    Gl* gl_ = nullptr;
    std::optional<PictureTarget> whole_, draft_;
    PictureTexture ordered_;
    double msPerTriangle_ = 0.0; ///< whole picture
    bool isWorking_ = false;
};

SceneThread::SceneThread(QOpenGLContext* shared, std::shared_ptr<GlDriver> driver, std::function<void()> pictureIsReady)
    : pictureIsReady_(std::move(pictureIsReady)), painter_(std::make_unique<Painter>(shared, std::move(driver))) {
    if (!QOpenGLContext::supportsThreadedOpenGL()) {
        isWorking_ = painter_->begin();
        return;
    }
    thread_.reset(QThread::create([this] { run(); }));
    thread_->setObjectName(QStringLiteral("scene"));
    painter_->moveTo(thread_.get());
    thread_->start();
}

SceneThread::~SceneThread() {
    if (!thread_) {
        refuseOrders();
        painter_->end(slots_);
        return;
    }
    {
        const std::lock_guard lock(mutex_);
        isStopping_ = true;
    }
    wasAsked_.notify_all();
    thread_->wait();
}

void SceneThread::run() {
    if (!painter_->begin())
        stopWorking(false);
    while (const auto work = nextWork()) {
        if (work->asked)
            draw(*painter_, *work->asked);
        else
            drawOrdered(*painter_, *work->ordered);
    }
    refuseOrders();
    painter_->end(slots_);
    painter_->moveTo(painter_->home());
}

// Of what was ordered nothing is lost at the end: it is for a file that someone has asked for.
std::optional<SceneThread::Work> SceneThread::nextWork() {
    std::unique_lock lock(mutex_);
    wasAsked_.wait(lock, [this] { return isStopping_ || ((asked_ || !orders_.empty()) && isWorking_); });
    const bool isOrderDue = !orders_.empty() && (isStopping_ || !asked_ || givesWayNoMore(orders_.front().since));
    if (isOrderDue && isWorking_)
        return Work{{}, orders_.front()};
    isBusy_ = !isStopping_;
    if (isStopping_)
        return std::nullopt;
    return Work{std::exchange(asked_, std::nullopt), std::nullopt};
}

void SceneThread::drawOrdered(Painter& painter, const Ordered& ordered) {
    const auto& order = ordered.order;
    order->begin(painter.expectedMs(*order));
    const auto isStopped = [&] {
        const std::lock_guard lock(mutex_);
        return order->isCancelled() || (asked_ && !isStopping_ && !givesWayNoMore(ordered.since));
    };
    if (painter.isLost())
        return stopWorking(true); // and refuses it
    auto picture = order->isCancelled() ? std::optional(QImage()) : painter.draw(*order, isStopped);
    if (!picture && !order->isCancelled())
        return; // to the view that is asked for, and once more
    {
        const std::lock_guard lock(mutex_);
        orders_.pop_front();
        uploadedBytes_ = painter.uploadedBytes();
    }
    order->settle(picture ? std::move(*picture) : QImage());
}

void SceneThread::refuseOrders() {
    std::list<Ordered> orders;
    {
        const std::lock_guard lock(mutex_);
        orders.swap(orders_);
    }
    for (const Ordered& ordered : orders)
        ordered.order->settle(QImage());
}

void SceneThread::order(std::shared_ptr<PictureOrder> order) {
    const Ordered ordered{std::move(order), Clock::now()};
    {
        const std::lock_guard lock(mutex_);
        if (isWorking_)
            orders_.push_back(ordered);
        else
            ordered.order->settle(QImage());
    }
    wasAsked_.notify_all();
    if (!thread_ && isWorking() && painter_->makeCurrent())
        drawOrdered(*painter_, ordered);
}

// A draft is always finished: else nothing would be seen of a view that changes fast.
bool SceneThread::isOvertaken(const Asked& asked, bool isDraft) const {
    const std::lock_guard lock(mutex_);
    return isStopping_ || (asked_ && !isDraft && !asked.use.mustBeWhole);
}

bool SceneThread::isStillAfterRest() {
    std::unique_lock lock(mutex_);
    return !wasAsked_.wait_for(lock, kRest, [this] { return isStopping_ || asked_; });
}

void SceneThread::stopWorking(bool isLost) {
    {
        const std::lock_guard lock(mutex_);
        isWorking_ = false;
        isLost_ = isLost;
    }
    refuseOrders();
    wasDrawn_.notify_all();
    pictureIsReady_();
}

void SceneThread::draw(Painter& painter, const Asked& asked) {
    if (painter.isLost())
        return stopWorking(true);
    if (!asked.use.mustBeWhole && painter.expectedMs(asked.view) > kFluentMs) {
        drawPicture(painter, asked, true);
        if (!isStillAfterRest())
            return;
    }
    drawPicture(painter, asked, false);
}

void SceneThread::drawPicture(Painter& painter, const Asked& asked, bool isDraft) {
    std::size_t place = 0;
    Slot slot;
    {
        const std::lock_guard lock(mutex_);
        place = freeSlot();
        slot = std::exchange(slots_[place], {});
    }
    painter.waitUntilRead(slot.read);
    slot.picture.image = {};
    const bool isDrawn = painter.draw(asked, isDraft, slot.picture, [&] { return isOvertaken(asked, isDraft); });
    slot.picture.serial = asked.serial;
    slot.picture.isDraft = isDraft;
    slot.picture.isovalue = asked.view.frame ? std::optional(asked.view.frame->isovalue) : std::nullopt;
    slot.picture.refusedBytes = painter.refusedBytes();
    {
        const std::lock_guard lock(mutex_);
        uploadedBytes_ = painter.uploadedBytes();
        slots_[place] = std::move(slot);
        isBusy_ = false; // what follows gives way
        if (!isDrawn)
            return;
        ready_ = place;
        if (!isDraft)
            wholeSerial_ = asked.serial;
    }
    wasDrawn_.notify_all();
    pictureIsReady_();
}

std::size_t SceneThread::freeSlot() const {
    std::size_t place = 0;
    while (place == shown_ || place == ready_)
        ++place;
    return place;
}

std::uint64_t SceneThread::ask(SceneView view, PictureUse use) {
    Asked asked{std::move(view), 0, use};
    const std::uint64_t serial = asked.serial = ++lastSerial_;
    if (!thread_) {
        drawHere(std::move(asked));
        return serial;
    }
    {
        const std::lock_guard lock(mutex_);
        asked_ = std::move(asked);
    }
    wasAsked_.notify_all();
    return serial;
}

// Without a thread nothing would draw it whole later.
void SceneThread::drawHere(Asked asked) {
    asked.use.mustBeWhole = true;
    if (!isWorking())
        return;
    if (painter_->makeCurrent())
        draw(*painter_, asked);
    else
        stopWorking(false);
}

void SceneThread::waitFor(std::uint64_t serial) {
    std::unique_lock lock(mutex_);
    wasDrawn_.wait(lock, [&] { return !isWorking_ || wholeSerial_ >= serial; });
}

SceneThread::Picture SceneThread::take() {
    const std::lock_guard lock(mutex_);
    if (ready_)
        shown_ = std::exchange(ready_, std::nullopt);
    return shown_ ? slots_[*shown_].picture : Picture{};
}

void SceneThread::noteRead(Gl& gl) {
    const std::lock_guard lock(mutex_);
    if (!shown_)
        return;
    GLsync& read = slots_[*shown_].read;
    if (read != nullptr)
        gl.glDeleteSync(read);
    read = gl.glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.glFlush(); // another context waits for it
}

bool SceneThread::isWorking() const {
    const std::lock_guard lock(mutex_);
    return isWorking_;
}

bool SceneThread::isLost() const {
    const std::lock_guard lock(mutex_);
    return isLost_;
}

bool SceneThread::isBehind() const {
    const std::lock_guard lock(mutex_);
    return isWorking_ && (asked_ || isBusy_);
}

QOpenGLContext* SceneThread::context() const { return &painter_->context(); }

std::uint64_t SceneThread::uploadedBytes() const {
    const std::lock_guard lock(mutex_);
    return uploadedBytes_;
}

} // namespace isoslider::render
