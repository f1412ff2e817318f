#include "ui/widgets/window/compact_layout.h"

#include <utility>

#include <QDockWidget>
#include <QEvent>
#include <QGuiApplication>
#include <QLayout>
#include <QMainWindow>

namespace isoslider::widgets {
namespace {

constexpr QSize kRoomForPanels(760, 430);
constexpr int kHistogramHeight = 110;
constexpr int kLowHistogramHeight = 40;
constexpr int kSettleMs = 50;

} // namespace

CompactLayout::CompactLayout(QMainWindow& window, std::vector<QDockWidget*> sidePanels, QWidget& histogram)
    : QObject(&window), window_(window), sidePanels_(std::move(sidePanels)), histogram_(histogram) {
    histogram_.setMinimumHeight(kHistogramHeight);
    window_.installEventFilter(this);
    for (QDockWidget* panel : sidePanels_)
        panel->installEventFilter(this);
    settled_.setSingleShot(true);
    settled_.setInterval(kSettleMs);
    connect(&settled_, &QTimer::timeout, this, &CompactLayout::restoreWidths);
}

bool CompactLayout::eventFilter(QObject* watched, QEvent* event) {
    if (watched != &window_) {
        // Squeezed by the window, or laid out again after it was shown: that may come any time later.
        if (event->type() == QEvent::Resize && !isDragging())
            settled_.start();
        return QObject::eventFilter(watched, event);
    }
    switch (event->type()) {
        case QEvent::Resize:
            fit();
            settled_.start();
            break;
        case QEvent::MouseButtonPress: pressedWidths_ = presentWidths(); break;
        case QEvent::MouseButtonRelease: // of the line beside a panel, it may be, which moves until this is handled
            QMetaObject::invokeMethod(this, &CompactLayout::noteWidths, Qt::QueuedConnection);
            break;
        case QEvent::Close: showPanels(); break; // so that they are saved as shown
        default: break;
    }
    return QObject::eventFilter(watched, event);
}

bool CompactLayout::isDragging() { return QGuiApplication::mouseButtons() != Qt::NoButton; }

void CompactLayout::restart() {
    hidden_.clear();
    wereOnTop_.clear();
    isCompact_ = false;
    fit();
    if (!isCompact_) // of a small window, what its panels were squeezed to was saved
        widths_.clear();
}

void CompactLayout::setWidths(const std::map<QDockWidget*, int>& widths) {
    widths_ = widths;
    restoreWidths();
}

std::map<QDockWidget*, int> CompactLayout::presentWidths() const {
    std::map<QDockWidget*, int> widths;
    for (QDockWidget* panel : sidePanels_)
        if (isBesideView(*panel) && !panel->visibleRegion().isEmpty()) // behind another tab, a panel is not laid out
            widths[panel] = panel->width();
    return widths;
}

void CompactLayout::noteWidths() {
    auto widths = presentWidths();
    if (!widths.empty() && widths != pressedWidths_)
        widths_ = std::move(widths);
}

bool CompactLayout::isBesideView(QDockWidget& panel) const {
    const auto area = window_.dockWidgetArea(&panel);
    return !panel.isHidden() && !panel.isFloating() &&
           (area == Qt::LeftDockWidgetArea || area == Qt::RightDockWidgetArea);
}

void CompactLayout::restoreWidths() {
    if (isCompact_)
        return;
    if (widths_.empty())
        widths_ = presentWidths();
    QList<QDockWidget*> panels;
    QList<int> widths;
    for (const auto& [panel, width] : widths_)
        if (isBesideView(*panel)) {
            panels << panel;
            widths << width;
        }
    if (panels.isEmpty())
        return;
    window_.resizeDocks(panels, widths, Qt::Horizontal);
    window_.layout()->activate();
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
