#include "ui/widgets/window/topology_status.h"

#include <QEvent>
#include <QMainWindow>
#include <QStatusBar>

#include "ui/model/session/session.h"
#include "ui/widgets/common/small_widgets.h"

namespace isoslider::widgets {
namespace {

constexpr int kLeastHeight = 430; // of the window; below it, the view needs all there is

} // namespace

TopologyStatus::TopologyStatus(model::Session& session, QMainWindow& window)
    : QObject(&window), session_(session), window_(window), counts_(new ElidedLabel(&window)) {
    QStatusBar* bar = window_.statusBar();
    bar->setSizeGripEnabled(false);
    counts_->setObjectName(QStringLiteral("topologyCounts"));
    counts_->setContentsMargins(8, 0, 8, 0);
    bar->addWidget(counts_, 1);
    window_.installEventFilter(this);
    subscriptions_.push_back(session_.topology().changed().observe([this] { showCounts(); }));
    subscriptions_.push_back(session_.isovalue().observe([this] { showCounts(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { showBar(); }));
    showCounts();
    showBar();
}

void TopologyStatus::showCounts() {
    const auto& isovalue = session_.isovalue();
    const auto counts = isovalue.hasDisplayed() ? session_.topology().countsAt(isovalue.displayed()) : std::nullopt;
    if (window_.statusBar()->currentMessage().isEmpty()) // else it stands in the place of the counts, until it goes
        counts_->setVisible(counts.has_value());
    counts_->setFullText(
        counts ? QString::fromStdString(model::countsText(*counts, session_.topology().areCountsExact())) : QString());
}

// Not only once there are counts: the view would change its height when they come.
void TopologyStatus::showBar() {
    window_.statusBar()->setVisible(session_.dataset() != nullptr && window_.height() >= kLeastHeight);
}

bool TopologyStatus::eventFilter(QObject* watched, QEvent* event) {
    if (watched == &window_ && event->type() == QEvent::Resize)
        showBar();
    return QObject::eventFilter(watched, event);
}

} // namespace isoslider::widgets
