#pragma once

#include <array>
#include <utility>
#include <vector>

#include <QObject>
#include <QStringList>

#include "ui/model/observers.h"
#include "ui/model/topology/topology_model.h"

class QAction;
class QLabel;
class QToolButton;
class QCPAxis;
class QCPGraph;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class HistogramPlot;
class SettingsStore;

/// Curves over the histogram: pieces, tunnels, area, volume above, triangles and gradient against the isovalue, each
/// scaled to its own greatest value. A legend above the plot gives their values at the handle.
class CurveOverlay : public QObject {
    Q_OBJECT
public:
    CurveOverlay(model::Session& session, SettingsStore& settings, HistogramPlot& plot);

    /// A button with a menu of the curves; one that is not known is disabled and states so.
    QToolButton* makeButton(QWidget* parent);
    bool isShown(model::TopologyQuantity quantity) const;

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    struct Curve {
        QAction* action = nullptr;
        QCPGraph* graph = nullptr;
        bool isLogarithmic = false;
    };

    Curve& curveOf(model::TopologyQuantity quantity) { return curves_[static_cast<std::size_t>(quantity)]; }
    void readSettings(const SettingsStore& settings);
    bool isChosen(model::TopologyQuantity quantity) const;
    void makeActions();
    void choose();
    void showChoices(SettingsStore& settings);
    void showCurves();
    void showLegend();
    void placeLegend();
    void applyPalette();
    QString valueText(model::TopologyQuantity quantity, double value) const;

    model::Session& session_;
    HistogramPlot& plot_;
    QCPAxis* axis_; ///< 0 to 1, not drawn
    QLabel* legend_;
    std::array<Curve, model::kTopologyQuantities> curves_;
    QStringList drawn_; ///< as they were chosen
    std::pair<QStringList, int> placed_; ///< of which curves the legend was, and how wide it might be
    int room_ = 0; ///< above the plot, for those
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
