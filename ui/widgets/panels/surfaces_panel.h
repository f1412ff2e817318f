#pragma once

#include <QWidget>

class QMenu;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class SurfaceEditor;

/// The surfaces of the volume, and below them those of a second one while there is one.
class SurfacesPanel : public QWidget {
    Q_OBJECT
public:
    SurfacesPanel(model::Session& session, const ActionRegistry& actions, QWidget* parent = nullptr);

    /// Colours for the active surface, for the menu bar as well.
    QMenu* colourMenu();
    /// Lets the user type the name of the active surface. REQUIRES: the panel can be seen.
    void editName();

private:
    SurfaceEditor* editor_;
};

} // namespace isoslider::widgets
