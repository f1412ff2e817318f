#include "ui/widgets/panels/surfaces_panel.h"

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
      editor_(new SurfaceEditor(session.surfaces(),
                                {QStringLiteral("surface"), tr("Surfaces of the volume"),
                                 tr("The active surface: it is the one that slides")},
                                this)) {
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(10, 8, 10, 8);
    layout->setSpacing(6);
    auto* row = new QHBoxLayout;
    for (const char* action : {"surfaces.add", "surfaces.remove"})
        row->addWidget(makeToolButton(actions.action(action), Qt::ToolButtonTextOnly, this));
    row->addStretch(1);
    layout->addLayout(row);
    for (const char* action : {"surfaces.add", "surfaces.remove", "surfaces.rename", "second.open"})
        editor_->addTableAction(actions.action(action));
    layout->addWidget(editor_, 1);
    layout->addWidget(new SecondVolumeBox(session, actions, this), 1);
}

QMenu* SurfacesPanel::colourMenu() { return editor_->colourMenu(); }

void SurfacesPanel::editName() { editor_->editName(); }

} // namespace isoslider::widgets
