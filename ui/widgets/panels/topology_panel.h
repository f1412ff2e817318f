#pragma once

#include <memory>

#include <QWidget>

#include "ui/model/observers.h"

class QComboBox;
class QLabel;
class QProgressBar;
class QSlider;
class QStackedWidget;
class QTabWidget;
class QTableView;

namespace isoslider::model {
class QuestionModel;
class Session;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;
class ElidedLabel;
class FindPage;
class TopologySorting;
class TopologyTable;

/// The topology's events as a table with filters, a search for isovalues, and a comparison of two; before it is there,
/// why it is not.
class TopologyPanel : public QWidget {
    Q_OBJECT
public:
    TopologyPanel(model::Session& session, const ActionRegistry& actions, QWidget* parent = nullptr);
    ~TopologyPanel() override;

    /// Which isovalues are looked for.
    model::QuestionModel& question() { return *question_; }
    /// Brings the search up, ready to be typed in; the same of the comparison, wherever the focus is.
    void showSearch();
    void showComparison();

Q_SIGNALS:
    /// A row was clicked, or Enter pressed on it.
    void eventPicked(std::size_t event);
    /// One that was suggested, found or compared.
    void isovaluePicked(double isovalue);

protected:
    void changeEvent(QEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    QWidget* makeStatePage();
    QWidget* makeEventsPage();
    void makeTable(QWidget* page);
    void addMenuActions();
    void pick(const QModelIndex& index);
    void showTopology();
    void showProgress();
    void showFilters();
    void selectChosen();
    void fitColumns();
    void raiseDock();

    model::Session& session_;
    std::unique_ptr<model::QuestionModel> question_;
    TopologyTable* table_;
    TopologySorting* sorted_;
    QStackedWidget* pages_ = nullptr;
    QTabWidget* tabs_ = nullptr;
    FindPage* find_ = nullptr;
    QLabel* state_ = nullptr;
    QProgressBar* progress_ = nullptr;
    QComboBox* filter_ = nullptr;
    QSlider* persistence_ = nullptr;
    ElidedLabel* persistenceValue_ = nullptr;
    ElidedLabel* count_ = nullptr;
    QTableView* view_ = nullptr;
    QLabel* noEvents_ = nullptr; ///< instead of all these
    model::Subscription topologySubscription_;
    model::Subscription chosenSubscription_;
    model::Subscription datasetSubscription_;
    model::Subscription jobsSubscription_;
};

} // namespace isoslider::widgets
