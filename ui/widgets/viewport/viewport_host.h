#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <QColor>
#include <QImage>
#include <QWidget>

#include "core/extract/surface_frame.h"
#include "ui/model/observers.h"
#include "ui/model/session/dataset.h"
#include "ui/model/surface/view_state.h"
#include "ui/widgets/viewport/picture_choice.h"

namespace isoslider::model {
class ColourModel;
class Session;
} // namespace isoslider::model

namespace isoslider::render {
struct InactiveSurface;
class PictureOrder;
} // namespace isoslider::render

namespace isoslider::widgets {

class ActionRegistry;
class AxesGlyph;
class CameraFlight;
class ClipTool;
class FirstView;
class LoadingCard;
class MeasureTool;
class SceneGuides;
class SettingsStore;
class StartPage;
class ViewReadout;
class ViewportWidget;

/// The middle of the window: the 3-D view, or a word on why there is none, with the start page or
/// the loading state and the readout over it. A preview is always called one.
class ViewportHost : public QWidget {
    Q_OBJECT
public:
    ViewportHost(model::Session& session, SettingsStore& settings, const ActionRegistry& actions,
                 QWidget* parent = nullptr);
    ~ViewportHost() override;

    /// Null without usable OpenGL.
    ViewportWidget* viewport() { return viewport_; }
    /// Of its camera; null with it.
    CameraFlight* flight() { return flight_; }
    /// What is in the view, whole and up to date, with the orientation axes and cube, the scale bar and what is
    /// measured; in pixels of the screen. Null without a view.
    QImage picture();
    /// The same as a picture that is drawn while the window goes on, without the mark of an event. `above` belongs over
    /// it.
    struct OrderedPicture {
        std::shared_ptr<render::PictureOrder> scene; ///< null without a view
        QImage above;
        QColor halo; ///< around what is above, without a background; else not valid
        double haloPixels = 0.0;
    };
    OrderedPicture orderPicture(const PictureChoice& choice);
    /// Of the view; empty without one.
    QSize pictureSize() const;
    /// Crop box and clip plane; null without a view.
    ClipTool* clipTool() { return clip_; }
    StartPage& startPage() { return *startPage_; }
    /// What is drawn beside the surface; the actions and the settings follow.
    model::ViewState& viewState() { return viewState_; }
    /// What surfaces are coloured by.
    model::ColourModel& colours() { return *colours_; }
    QSize sizeHint() const override { return {1100, 640}; }

protected:
    void resizeEvent(QResizeEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    QWidget* makeFallback();
    void connectActions(SettingsStore& settings, const ActionRegistry& actions);
    void connectViews(const ActionRegistry& actions);
    void connectGraphics();
    void showCoarser(std::uint64_t refusedBytes);
    void reportWhatIsDrawn();
    QString standInText() const;
    void showFrame();
    void showReadout();
    void showSurfaces();
    void addSecond(std::vector<render::InactiveSurface>& surfaces);
    void reachSecond();
    void showState();
    void applyOptions();
    void placeOverlays();
    bool fits(const QWidget& overlay) const;
    void paintAbove(QImage& picture);

    model::Session& session_;
    model::ViewState viewState_;
    std::unique_ptr<model::ColourModel> colours_;
    ViewportWidget* viewport_ = nullptr;
    QWidget* view_ = nullptr;
    StartPage* startPage_ = nullptr;
    LoadingCard* loading_ = nullptr;
    ViewReadout* readout_ = nullptr;
    ViewReadout* preview_ = nullptr;
    ViewReadout* legend_ = nullptr; ///< of the colours that mean something
    AxesGlyph* axes_ = nullptr;
    CameraFlight* flight_ = nullptr; ///< one for all: two would stop each other
    FirstView* firstView_ = nullptr;
    SceneGuides* guides_ = nullptr;
    MeasureTool* measure_ = nullptr;
    ClipTool* clip_ = nullptr;
    bool areAxesWanted_ = false;
    bool isReadoutWanted_ = false;
    std::shared_ptr<const extract::SurfaceFrame> drawnPicture_; ///< of the active surface
    std::optional<GridGeometry> drawnVolume_;
    std::int64_t reportedMergedCells_ = 1; ///< the most that was reported since the surface was drawn whole
    model::Subscription datasetSubscription_;
    model::Subscription frameSubscription_;
    model::Subscription surfacesSubscription_;
    model::Subscription inactiveSubscription_;
    std::array<model::Subscription, 2> secondSubscriptions_;
    model::Subscription optionsSubscription_;
    model::Subscription actionsSubscription_;
    model::Subscription coloursSubscription_;
};

} // namespace isoslider::widgets
