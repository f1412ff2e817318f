#pragma once

#include <vector>

#include <QObject>

#include "ui/model/isovalue/histogram_options.h"
#include "ui/model/observers.h"

class QMenu;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class HistogramPlot;
class SettingsStore;

/// Joins the histogram's actions with its options, which sessions and settings keep, and with the plot; and its menu.
class HistogramActions : public QObject {
    Q_OBJECT
public:
    HistogramActions(model::Session& session, SettingsStore& settings, const ActionRegistry& actions,
                     HistogramPlot& plot);

    /// What concerns the histogram: the end of the Isovalue menu, and the plot's own.
    static void addTo(QMenu& menu, const ActionRegistry& actions);

private:
    void readSettings();
    void showOptions();
    void updateActions();
    void openMenu(const QPoint& place);
    template <class Change>
    void change(Change&& change);

    model::Session& session_;
    SettingsStore& settings_;
    const ActionRegistry& actions_;
    HistogramPlot& plot_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
