#pragma once

#include <QWidget>

#include "ui/model/observers.h"
#include "ui/model/session/dataset.h"
#include "ui/model/surface/view_state.h"

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class AxesGlyph;
class LoadingCard;
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

    /// Null without usable OpenGL.
    ViewportWidget* viewport() { return viewport_; }
    StartPage& startPage() { return *startPage_; }
    /// What is drawn beside the surface; the actions and the settings follow.
    model::ViewState& viewState() { return viewState_; }
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
    void showState();
    void applyOptions();
    void placeOverlays();
    bool fits(const QWidget& overlay) const;

    model::Session& session_;
    model::ViewState viewState_;
    ViewportWidget* viewport_ = nullptr;
    QWidget* view_ = nullptr;
    StartPage* startPage_ = nullptr;
    LoadingCard* loading_ = nullptr;
    ViewReadout* readout_ = nullptr;
    ViewReadout* preview_ = nullptr;
    ViewReadout* legend_ = nullptr; ///< of the levels of merged cells
    AxesGlyph* axes_ = nullptr;
    bool areAxesWanted_ = false;
    bool isReadoutWanted_ = false;
    model::DatasetGeneration framedDataset_{};
    std::int64_t reportedMergedCells_ = 1; ///< the most that was reported since the surface was drawn whole
    model::Subscription datasetSubscription_;
    model::Subscription frameSubscription_;
    model::Subscription optionsSubscription_;
    model::Subscription actionsSubscription_;
};

} // namespace isoslider::widgets
