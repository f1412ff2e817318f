#include "ui/widgets/panels/surfaces_panel.h"

#include <QScrollArea>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/model/session/session.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/panels/second_volume_box.h"
#include "ui/widgets/panels/surface_editor.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {

SurfacesPanel::SurfacesPanel(model::Session& session, const ActionRegistry& actions, QWidget* parent)
    : QWidget(parent),
      editor_(new SurfaceEditor(
          session.surfaces(),
          {QStringLiteral("surface"), tr("Surfaces of the volume"),
           tr("The active surface: it is the one that slides")},
          [&session] { return spreadOf(session.dataset()); }, this)) {
    // A panel that grew with the second volume would push the other panels, and change the view's size.
    const ScrollPage scroll = fillWithScrollPage(this);
    QWidget* const page = scroll.page;
    auto* const layout = scroll.rows;
    layout->setSpacing(6);
    auto* row = new QHBoxLayout;
    for (const char* action : {"surfaces.add", "surfaces.remove"})
        row->addWidget(makeToolButton(actions.action(action), Qt::ToolButtonTextOnly, page));
    row->addStretch(1);
    layout->addLayout(row);
    editor_->setTableActions({actions.action("surfaces.add"), actions.action("surfaces.remove"),
                              actions.action("surfaces.rename"), actions.action("second.open")});
    layout->addWidget(editor_, 1);
    auto* second = new SecondVolumeBox(session, actions, page);
    layout->addWidget(second, 1);
    connect(second, &SecondVolumeBox::opened, this, [area = scroll.area, second] {
        QTimer::singleShot(0, area, [area, second] { area->ensureWidgetVisible(second); }); // once it has its place
    });
}

QMenu* SurfacesPanel::colourMenu() { return editor_->colourMenu(); }

void SurfacesPanel::editName() { editor_->editName(); }

} // namespace isoslider::widgets
