#pragma once

#include <QWidget>

#include "ui/model/surface/surface_list.h"

class QLabel;
class QMenu;
class QSlider;
class QTableView;
class QToolButton;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class SurfaceTable;

/// The surfaces of the volume in a list, and how the active one looks. A click on a row, or Enter, makes its surface
/// active; a click on the box shows or hides it.
class SurfacesPanel : public QWidget {
    Q_OBJECT
public:
    SurfacesPanel(model::Session& session, const ActionRegistry& actions, QWidget* parent = nullptr);

    /// Colours for the active surface, for the menu bar as well.
    QMenu* colourMenu() { return colours_; }
    /// Lets the user type the name of the active surface. REQUIRES: the panel can be seen.
    void editName();

private:
    void makeTable(const ActionRegistry& actions);
    void makeColours();
    void makeLook();
    void pick(const QModelIndex& index);
    void setColour(const QColor& colour);
    void askColour();
    void showSurfaces();

    model::Session& session_;
    SurfaceTable* table_;
    QTableView* view_ = nullptr;
    QMenu* colours_ = nullptr;
    QToolButton* colour_ = nullptr;
    QSlider* opacity_ = nullptr;
    QLabel* opacityValue_ = nullptr;
    model::SurfaceId shownActive_{};
    model::Subscription subscription_;
};

} // namespace isoslider::widgets
