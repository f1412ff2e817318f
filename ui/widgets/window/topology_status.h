#pragma once

#include <vector>

#include <QObject>

#include "ui/model/observers.h"

class QMainWindow;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ElidedLabel;

/// The window's status bar, shown while a volume is open and the window is not low: the counts of the surface that is
/// displayed, once they are known.
class TopologyStatus : public QObject {
    Q_OBJECT
public:
    TopologyStatus(model::Session& session, QMainWindow& window);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void showCounts();
    void showBar();

    model::Session& session_;
    QMainWindow& window_;
    ElidedLabel* counts_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
