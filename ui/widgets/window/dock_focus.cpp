#include "ui/widgets/window/dock_focus.h"

#include <QDockWidget>
#include <QVariant>

namespace isoslider::widgets {
namespace {

constexpr const char* kPolicyWhenSeen = "focusPolicyWhenSeen";

void setTabStops(const QDockWidget& dock, bool areWanted) {
    for (auto* widget : dock.findChildren<QWidget*>()) {
        const QVariant kept = widget->property(kPolicyWhenSeen);
        const Qt::FocusPolicy policy = widget->focusPolicy();
        if (areWanted && kept.isValid()) {
            widget->setFocusPolicy(static_cast<Qt::FocusPolicy>(kept.toInt()));
            widget->setProperty(kPolicyWhenSeen, QVariant());
        } else if (!areWanted && (policy & Qt::TabFocus) != 0 && widget->focusProxy() == nullptr) {
            widget->setProperty(kPolicyWhenSeen, static_cast<int>(policy));
            widget->setFocusPolicy(static_cast<Qt::FocusPolicy>(policy & ~Qt::TabFocus));
        }
    }
}

} // namespace

void passByWhileCovered(QDockWidget& dock) {
    QObject::connect(&dock, &QDockWidget::visibilityChanged, &dock,
                     [&dock](bool isSeen) { setTabStops(dock, isSeen); });
    setTabStops(dock, false); // until it is shown
}

} // namespace isoslider::widgets
