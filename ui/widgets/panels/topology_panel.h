#pragma once

#include <QWidget>

#include "ui/model/observers.h"

class QComboBox;
class QLabel;
class QProgressBar;
class QSlider;
class QStackedWidget;
class QTableView;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ElidedLabel;
class TopologySorting;
class TopologyTable;

/// The topology's events as a table with filters; before it is there, why it is not.
class TopologyPanel : public QWidget {
    Q_OBJECT
public:
    explicit TopologyPanel(model::Session& session, QWidget* parent = nullptr);

Q_SIGNALS:
    /// A row was clicked, or Enter pressed on it.
    void eventPicked(std::size_t event);

protected:
    void changeEvent(QEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;

private:
    QWidget* makeStatePage();
    QWidget* makeEventsPage();
    void makeTable(QWidget* page);
    void pick(const QModelIndex& index);
    void showTopology();
    void showProgress();
    void showFilters();
    void selectChosen();
    void fitColumns();

    model::Session& session_;
    TopologyTable* table_;
    TopologySorting* sorted_;
    QStackedWidget* pages_ = nullptr;
    QLabel* state_ = nullptr;
    QProgressBar* progress_ = nullptr;
    QComboBox* filter_ = nullptr;
    QSlider* persistence_ = nullptr;
    ElidedLabel* persistenceValue_ = nullptr;
    ElidedLabel* count_ = nullptr;
    QTableView* view_ = nullptr;
    model::Subscription topologySubscription_;
    model::Subscription chosenSubscription_;
    model::Subscription datasetSubscription_;
    model::Subscription jobsSubscription_;
};

} // namespace isoslider::widgets
