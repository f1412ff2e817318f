#pragma once

#include <QWidget>

#include "ui/model/observers.h"
#include "ui/widgets/common/throttle.h"

class QLabel;
class QTableView;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class FactForm;
class TextTableModel;

/// The skip levels of the index, and the path that the last move took over them.
class LevelsPanel : public QWidget {
    Q_OBJECT
public:
    explicit LevelsPanel(model::Session& session, QWidget* parent = nullptr);

private:
    QTableView* makeTable(TextTableModel* model, const QString& name);
    void showLevels();
    void showMove();

    model::Session& session_;
    TextTableModel* levels_;
    TextTableModel* walk_;
    QLabel* levelsHint_;
    QLabel* walkHint_;
    QTableView* levelsTable_;
    QTableView* walkTable_;
    FactForm* moveFacts_;
    Throttle moveThrottle_;
    model::Subscription datasetSubscription_;
    model::Subscription frameSubscription_;
};

} // namespace isoslider::widgets
