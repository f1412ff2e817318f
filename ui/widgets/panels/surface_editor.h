#pragma once

#include <QList>
#include <QWidget>

#include "ui/model/surface/surface_list.h"
#include "ui/widgets/panels/surface_table.h"

class QLabel;
class QMenu;
class QSlider;
class QTableView;
class QToolButton;

namespace isoslider::widgets {

/// The surfaces of a volume in a list, and how the active one looks. A click on a row, or Enter, makes its surface
/// active; a click on the box shows or hides it.
class SurfaceEditor : public QWidget {
    Q_OBJECT
public:
    struct Texts {
        QString objectNames; ///< what those of its parts begin with
        QString accessibleName; ///< of the list
        QString activeTip; ///< of the active surface's row
    };
    /// The model must outlive it.
    SurfaceEditor(model::SurfacesModel& surfaces, const Texts& texts, SurfaceTable::SpreadSource spread,
                  QWidget* parent);

    /// Of its context menu, before those that copy. Called once.
    void setTableActions(const QList<QAction*>& actions);
    /// Colours for the active surface.
    QMenu* colourMenu() { return colours_; }
    /// Lets the user type the name of the active surface. REQUIRES: the widget can be seen.
    void editName();

private:
    void makeTable(const Texts& texts);
    void makeColours();
    void makeLook();
    void pick(const QModelIndex& index);
    void setColour(const QColor& colour);
    void askColour();
    void showSurfaces();

    model::SurfacesModel& surfaces_;
    QString objectNames_;
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
