#pragma once

#include <QElapsedTimer>
#include <QTimer>
#include <QWidget>

#include "ui/model/isovalue/playback_model.h"
#include "ui/model/observers.h"
#include "ui/model/session/dataset.h"

class QAction;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QToolButton;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class CurveOverlay;
class DetailControl;
class HistogramPlot;
class IsovalueNotes;
class IsovalueEdit;
class SettingsStore;

/// The isovalue: histogram with its handle, typed value, animation, and what the last move took.
class IsovaluePanel : public QWidget {
    Q_OBJECT
public:
    IsovaluePanel(model::Session& session, SettingsStore& settings, const ActionRegistry& actions,
                  QWidget* parent = nullptr);

    HistogramPlot& plot() { return *plot_; }
    IsovalueEdit& edit() { return *edit_; }

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    QWidget* makeControls(const ActionRegistry& actions);
    void connectControls(SettingsStore& settings, const ActionRegistry& actions);
    void showDataset();
    void beginVolume();
    void makeRoomForControls();
    void showIsovalue();
    void showTips(const QString& inDeviations);
    void applyStepRule();
    void showPlayback();
    void setPlaying(bool isPlaying);
    void advance();

    model::Session& session_;
    HistogramPlot* plot_ = nullptr;
    CurveOverlay* curves_ = nullptr;
    IsovalueNotes* notes_ = nullptr;
    IsovalueEdit* edit_ = nullptr;
    QLabel* range_ = nullptr;
    DetailControl* detail_ = nullptr;
    QWidget* controls_ = nullptr;
    QWidget* readouts_ = nullptr; ///< at the end of the controls, where there is room
    QLabel* requested_ = nullptr;
    QLabel* displayed_ = nullptr;
    QLabel* elapsed_ = nullptr;
    QComboBox* mode_ = nullptr;
    QDoubleSpinBox* speed_ = nullptr;
    QAction* play_ = nullptr;
    QString playTip_; ///< where it can be done
    model::DatasetGeneration shownDataset_{};
    model::PlaybackModel playback_;
    QTimer playTimer_;
    QElapsedTimer playClock_;
    double playedValue_ = 0.0;
    model::Subscription datasetSubscription_;
    model::Subscription isovalueSubscription_;
    model::Subscription optionsSubscription_;
};

} // namespace isoslider::widgets
