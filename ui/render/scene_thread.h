#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>

#include <QImage>

#include "ui/render/gl_driver.h"
#include "ui/render/picture_order.h"
#include "ui/render/picture_target.h"
#include "ui/render/scene_view.h"

class QOpenGLContext;
class QThread;

namespace isoslider::render {

/// What a picture is made for.
struct PictureUse {
    bool mustBeWhole = false; ///< no draft of it, and no newer view stops it
    bool asImage = false; ///< besides the texture
};

/// Draws pictures of the scene on a separate thread with a separate context, so that a window never waits for
/// them. Of the views asked for only the newest is drawn. What takes long is drawn as a draft first, and whole as soon
/// as nothing newer is asked for; a whole picture on the way gives way to a newer view. Pictures go from hand to hand
/// in three places: one is shown, one is ready, one is drawn. Every call is of the thread that made it.
class SceneThread {
public:
    struct Picture {
        std::uint64_t serial = 0; ///< of the view it shows; 0: there is none
        bool isDraft = false;
        std::optional<double> isovalue; ///< of its surface, if it has one
        std::uint64_t refusedBytes = 0; ///< of its surface, if the card has no memory for it and it is not drawn
        PictureTexture texture; ///< in the contexts that share
        QImage image; ///< null where none was asked for
    };

    /// `shared`: a context that is to see the textures; null if nobody is, then every picture comes as an image.
    /// `pictureIsReady` is called on the thread. Where the platform allows one thread only, pictures are drawn within
    /// ask().
    SceneThread(QOpenGLContext* shared, std::shared_ptr<GlDriver> driver, std::function<void()> pictureIsReady);
    ~SceneThread();
    SceneThread(const SceneThread&) = delete;
    SceneThread& operator=(const SceneThread&) = delete;

    /// The number of the view, from 1. REQUIRES: it has pixels.
    std::uint64_t ask(SceneView view, PictureUse use = {});
    /// Draws a picture besides, as soon as no view waits: to that it gives way, for a second at most. It is settled
    /// also where nothing can be drawn; the destructor draws what was ordered before.
    void order(std::shared_ptr<PictureOrder> order);
    /// Until the view with this number, or a newer one, is drawn whole, or nothing can be drawn.
    void waitFor(std::uint64_t serial);
    /// The newest picture; it stays as it is until the next call.
    Picture take();
    /// What was taken is read by the calls to OpenGL made so far, and by no later one. REQUIRES: the context that
    /// shares is current.
    void noteRead(Gl& gl);

    /// False once the context cannot draw the scene, or is lost.
    bool isWorking() const;
    /// Whether all that it held is gone, as after a reset of the card: only another one helps.
    bool isLost() const;
    /// Whether a view waits for its first picture.
    bool isBehind() const;
    /// For tests.
    QOpenGLContext* context() const;
    /// Bytes of surfaces sent to the card so far.
    std::uint64_t uploadedBytes() const;

private:
    class Painter;
    struct Asked {
        SceneView view;
        std::uint64_t serial = 0;
        PictureUse use;
    };
    struct Slot {
        Picture picture;
        GLsync read = nullptr; ///< when those who were shown it have read it
    };

    void run();
    struct Ordered {
        std::shared_ptr<PictureOrder> order;
        std::chrono::steady_clock::time_point since;
    };
    struct Work { ///< one of both
        std::optional<Asked> asked;
        std::optional<Ordered> ordered;
    };
    std::optional<Work> nextWork();
    void drawOrdered(Painter& painter, const Ordered& ordered);
    void refuseOrders();
    bool isOvertaken(const Asked& asked, bool isDraft) const;
    bool isStillAfterRest();
    void drawHere(Asked asked);
    void draw(Painter& painter, const Asked& asked);
    void drawPicture(Painter& painter, const Asked& asked, bool isDraft);
    std::size_t freeSlot() const;
    void stopWorking(bool isLost);

    std::function<void()> pictureIsReady_;
    std::unique_ptr<Painter> painter_;
    std::unique_ptr<QThread> thread_; ///< null where the platform allows one only

    std::uint64_t lastSerial_ = 0; ///< of who asks

    mutable std::mutex mutex_; ///< over all below
    std::condition_variable wasAsked_, wasDrawn_;
    std::optional<Asked> asked_;
    std::list<Ordered> orders_;
    std::uint64_t wholeSerial_ = 0; ///< the last that was drawn whole
    std::array<Slot, 3> slots_;
    std::optional<std::size_t> shown_, ready_; ///< places among the slots
    std::uint64_t uploadedBytes_ = 0;
    bool isBusy_ = false; ///< with the first picture of a view
    bool isWorking_ = true;
    bool isLost_ = false;
    bool isStopping_ = false;
};

} // namespace isoslider::render
