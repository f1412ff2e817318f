#include "ui/widgets/window/compact_layout.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <QDockWidget>
#include <QEvent>
#include <QGuiApplication>
#include <QLayout>
#include <QMainWindow>
#include <QMouseEvent>

namespace isoslider::widgets {
namespace {

constexpr QSize kRoomForPanels(760, 430);
constexpr int kHistogramHeight = 110;
constexpr int kLowHistogramHeight = 40;
constexpr double kMostOfHeight = 0.45; // of the window, that the isovalue's panel gets back
constexpr int kSettleMs = 50;

} // namespace

CompactLayout::CompactLayout(QMainWindow& window, std::vector<QDockWidget*> sidePanels, QDockWidget& isovaluePanel,
                             QWidget& histogram)
    : QObject(&window),
      window_(window),
      sidePanels_(std::move(sidePanels)),
      isovaluePanel_(isovaluePanel),
      histogram_(histogram) {
    histogram_.setMinimumHeight(kHistogramHeight);
    window_.installEventFilter(this);
    for (QDockWidget* panel : sidePanels_)
        panel->installEventFilter(this);
    isovaluePanel_.installEventFilter(this);
    settled_.setSingleShot(true);
    settled_.setInterval(kSettleMs);
    connect(&settled_, &QTimer::timeout, this, &CompactLayout::restoreExtents);
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
        case QEvent::MouseButtonPress:
            pressedExtents_ = presentExtents();
            isPressed_ = static_cast<QMouseEvent*>(event)->button() == Qt::LeftButton;
            break;
        case QEvent::Leave: // who lets go elsewhere is not heard of
        case QEvent::WindowDeactivate: isPressed_ = false; break;
        case QEvent::MouseButtonRelease: // of the line beside a panel, it may be, which moves until this is handled
            QMetaObject::invokeMethod(this, &CompactLayout::noteExtents, Qt::QueuedConnection);
            break;
        case QEvent::Close: showPanels(); break; // so that they are saved as shown
        default: break;
    }
    return QObject::eventFilter(watched, event);
}

bool CompactLayout::isDragging() const { return isPressed_ || QGuiApplication::mouseButtons() != Qt::NoButton; }

void CompactLayout::restart() {
    hidden_.clear();
    wereOnTop_.clear();
    isCompact_ = false;
    fit();
    if (!isCompact_) // of a small window, what its panels were squeezed to was saved
        extents_.clear();
}

void CompactLayout::setExtents(const std::map<QDockWidget*, int>& extents) {
    extents_ = extents;
    restoreExtents();
}

std::map<QDockWidget*, int> CompactLayout::presentExtents() const {
    std::map<QDockWidget*, int> extents;
    for (QDockWidget* panel : sidePanels_)
        if (isBesideView(*panel) && !panel->visibleRegion().isEmpty()) // behind another tab, a panel is not laid out
            extents[panel] = panel->width();
    if (isBelowOrAboveView(isovaluePanel_) && !isovaluePanel_.visibleRegion().isEmpty())
        extents[&isovaluePanel_] = isovaluePanel_.height();
    return extents;
}

// Only what the mouse has changed: the others may be squeezed. Panels that share an edge change together.
void CompactLayout::noteExtents() {
    isPressed_ = false;
    const auto present = presentExtents();
    for (const bool isHeight : {false, true}) {
        const auto isOfThese = [&](const auto& entry) { return (entry.first == &isovaluePanel_) == isHeight; };
        const bool hasChanged = std::any_of(present.begin(), present.end(), [&](const auto& entry) {
            const auto pressed = pressedExtents_.find(entry.first);
            return isOfThese(entry) && pressed != pressedExtents_.end() && pressed->second != entry.second;
        });
        if (!hasChanged)
            continue;
        std::erase_if(extents_, isOfThese);
        std::copy_if(present.begin(), present.end(), std::inserter(extents_, extents_.end()), isOfThese);
    }
}

bool CompactLayout::isBesideView(QDockWidget& panel) const {
    const auto area = window_.dockWidgetArea(&panel);
    return !panel.isHidden() && !panel.isFloating() &&
           (area == Qt::LeftDockWidgetArea || area == Qt::RightDockWidgetArea);
}

bool CompactLayout::isBelowOrAboveView(QDockWidget& panel) const {
    const auto area = window_.dockWidgetArea(&panel);
    return !panel.isHidden() && !panel.isFloating() &&
           (area == Qt::BottomDockWidgetArea || area == Qt::TopDockWidgetArea);
}

void CompactLayout::restoreExtents() {
    if (isDragging())
        return settled_.start();
    if (isCompact_)
        return;
    if (extents_.empty())
        extents_ = presentExtents();
    QList<QDockWidget*> panels;
    QList<int> widths;
    for (const auto& [panel, extent] : extents_) {
        if (panel == &isovaluePanel_) {
            const int most = static_cast<int>(kMostOfHeight * window_.height());
            if (isBelowOrAboveView(*panel))
                window_.resizeDocks({panel}, {std::min(extent, most)}, Qt::Vertical);
        } else if (isBesideView(*panel)) {
            panels << panel;
            widths << extent;
        }
    }
    if (!panels.isEmpty())
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
