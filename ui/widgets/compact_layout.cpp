#include "ui/widgets/compact_layout.h"

#include <QDockWidget>
#include <QEvent>
#include <QMainWindow>

namespace isoslider::widgets {
namespace {

constexpr QSize kRoomForPanels(760, 430);
constexpr int kHistogramHeight = 110;
constexpr int kLowHistogramHeight = 40;

} // namespace

CompactLayout::CompactLayout(QMainWindow& window, std::vector<QDockWidget*> sidePanels, QWidget& histogram)
    : QObject(&window), window_(window), sidePanels_(std::move(sidePanels)), histogram_(histogram) {
    histogram_.setMinimumHeight(kHistogramHeight);
    window_.installEventFilter(this);
}

bool CompactLayout::eventFilter(QObject* watched, QEvent* event) {
    switch (event->type()) {
        case QEvent::Resize: fit(); break;
        case QEvent::Close: showPanels(); break; // so that they are saved as shown
        default: break;
    }
    return QObject::eventFilter(watched, event);
}

void CompactLayout::startAnew() {
    hidden_.clear();
    wereOnTop_.clear();
    isCompact_ = false;
    fit();
}

void CompactLayout::fit() {
    const bool isCompact = window_.width() < kRoomForPanels.width() || window_.height() < kRoomForPanels.height();
    if (std::exchange(isCompact_, isCompact) == isCompact)
        return;
    histogram_.setMinimumHeight(isCompact ? kLowHistogramHeight : kHistogramHeight);
    isCompact ? hidePanels() : showPanels();
}

void CompactLayout::hidePanels() {
    for (QDockWidget* panel : sidePanels_) {
        if (panel->isHidden() || panel->isFloating())
            continue;
        hidden_.emplace_back(panel);
        if (!panel->visibleRegion().isEmpty())
            wereOnTop_.emplace_back(panel);
    }
    for (const auto& panel : hidden_)
        panel->hide();
}

void CompactLayout::showPanels() {
    for (const auto& panel : std::exchange(hidden_, {}))
        if (panel)
            panel->show();
    for (const auto& panel : std::exchange(wereOnTop_, {}))
        if (panel)
            panel->raise();
    isCompact_ = false;
}

} // namespace isoslider::widgets
