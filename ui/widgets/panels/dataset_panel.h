#pragma once

#include <QWidget>

#include "ui/model/observers.h"

class QLabel;
class QPushButton;
class QStackedWidget;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class FactForm;

/// What is known of the open volume and of its index.
class DatasetPanel : public QWidget {
    Q_OBJECT
public:
    DatasetPanel(model::Session& session, const ActionRegistry& actions, QWidget* parent = nullptr);
    QSize sizeHint() const override { return {400, 420}; }

private:
    QWidget* makeEmptyPage(const ActionRegistry& actions);
    QWidget* makeFactsPage(const ActionRegistry& actions);
    void showDataset();

    model::Session& session_;
    QStackedWidget* pages_;
    FactForm* volumeFacts_ = nullptr;
    FactForm* indexFacts_ = nullptr;
    QLabel* indexState_ = nullptr;
    QPushButton* build_ = nullptr;
    model::Subscription subscription_;
};

} // namespace isoslider::widgets
