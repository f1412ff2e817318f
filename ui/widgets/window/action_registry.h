#pragma once

#include <vector>

#include <QHash>
#include <QObject>
#include <QString>

class QAction;
class QWidget;

namespace isoslider::widgets {

/// Every command of the window, declared once: id, text, shortcut, tip and icon. Menus, tool bars,
/// the shortcut sheet and the tests take their actions from here.
class ActionRegistry : public QObject {
    Q_OBJECT
public:
    /// Makes all actions and adds them to `window`, so that shortcuts work anywhere in it.
    explicit ActionRegistry(QWidget* window);

    /// REQUIRES: `id` is declared.
    QAction* action(const char* id) const;
    /// Sets the icons again, in the window's present colours.
    void refreshIcons();

    struct Section {
        QString title;
        std::vector<QAction*> actions;
    };
    /// All actions in the order declared, for the shortcut sheet.
    const std::vector<Section>& sections() const { return sections_; }

private:
    QWidget* window_;
    QHash<QString, QAction*> actions_;
    QHash<QString, QString> iconNames_;
    std::vector<Section> sections_;
};

/// Another text and tip, for what is called otherwise in some volumes. Buttons keep their text.
void nameAction(QAction& action, const QString& text, const QString& tip);

} // namespace isoslider::widgets
