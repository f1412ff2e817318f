#pragma once

class QWidget;

namespace isoslider::widgets {

class ActionRegistry;

/// Both open beside the window and return at once.
void showShortcutSheet(const ActionRegistry& actions, QWidget* parent);
void showAbout(QWidget* parent);

} // namespace isoslider::widgets
