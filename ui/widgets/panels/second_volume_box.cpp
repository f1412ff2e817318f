#include "ui/widgets/panels/second_volume_box.h"

#include <algorithm>
#include <cmath>

#include <QAction>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/panels/surface_editor.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

constexpr int kIsovalueSteps = 1000; // from the least to the greatest suggested value

} // namespace

SecondVolumeBox::SecondVolumeBox(model::Session& session, const ActionRegistry& actions, QWidget* parent)
    : QWidget(parent), session_(session), name_(new ElidedLabel(this, Qt::ElideMiddle)), surfaces_(new QWidget(this)) {
    setObjectName(QStringLiteral("secondVolume"));
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->setSpacing(6);
    name_->setObjectName(QStringLiteral("secondName"));
    QFont bold = name_->font();
    bold.setBold(true);
    name_->setFont(bold);
    layout->addWidget(name_);
    layout->addWidget(surfaces_, 1);
    auto* rows = new QVBoxLayout(surfaces_);
    rows->setContentsMargins(0, 0, 0, 0);
    rows->setSpacing(6);
    auto* row = new QHBoxLayout;
    for (const char* action : {"second.addSurface", "second.removeSurface", "second.close"})
        row->addWidget(makeToolButton(actions.action(action), Qt::ToolButtonTextOnly, this));
    row->addStretch(1);
    rows->addLayout(row);
    auto* editor = new SurfaceEditor(
        session.secondVolume().surfaces(),
        {QStringLiteral("secondSurface"), tr("Surfaces of the second volume"),
         tr("The selected surface: isovalue, colour and opacity below are of it")},
        [&session] { return spreadOf(session.secondVolume().dataset()); }, this);
    editor->setTableActions(
        {actions.action("second.addSurface"), actions.action("second.removeSurface"), actions.action("second.close")});
    rows->addWidget(editor, 1);
    makeIsovalue();
    volumeSubscription_ = session_.secondVolume().changed().observe([this] { showVolume(); });
    surfacesSubscription_ = session_.secondVolume().surfaces().observe([this] { showIsovalue(); });
    showVolume();
}

void SecondVolumeBox::makeIsovalue() {
    const SliderRow isovalue = makeSliderRow(tr("Isovalue"), QStringLiteral("-0.00000"), this);
    isovalue_ = isovalue.slider;
    isovalueText_ = isovalue.value;
    isovalue_->setObjectName(QStringLiteral("secondIsovalue"));
    isovalue_->setRange(0, kIsovalueSteps);
    isovalue_->setPageStep(kIsovalueSteps / 20);
    isovalue_->setAccessibleName(tr("Isovalue of the selected surface of the second volume"));
    isovalue_->setToolTip(tr("Isovalue of the selected surface; exact ones are typed in the list"));
    static_cast<QVBoxLayout*>(surfaces_->layout())->addLayout(isovalue.row);
    connect(isovalue_, &QSlider::valueChanged, this, [this](int step) {
        const auto* dataset = session_.secondVolume().dataset();
        if (dataset == nullptr)
            return;
        const model::SuggestedRange range = dataset->suggestedRange();
        const double value = std::lerp(range.min, range.max, static_cast<double>(step) / kIsovalueSteps);
        session_.secondVolume().surfaces().setIsovalue(model::suggestedAs(value, range));
    });
}

void SecondVolumeBox::showVolume() {
    const auto& second = session_.secondVolume();
    const auto* dataset = second.dataset();
    const bool isNew = dataset != nullptr && surfaces_->isHidden();
    surfaces_->setVisible(dataset != nullptr);
    setVisible(dataset != nullptr || !second.opening().empty());
    if (!second.opening().empty())
        name_->setFullText(tr("Opening %1…").arg(fromStd(second.opening())));
    else if (dataset != nullptr)
        name_->setFullText(tr("Second volume: %1").arg(fromStd(dataset->name)) + remark());
    showIsovalue();
    if (isNew)
        emit opened();
}

// What is not as one would expect of it.
QString SecondVolumeBox::remark() const {
    const auto& second = *session_.secondVolume().dataset();
    QString text;
    if (second.coarseStep > 1 && !second.index)
        text += tr(", one of %1 samples along each axis").arg(second.coarseStep);
    if (session_.dataset() != nullptr && model::liesApart(second.geometry, session_.dataset()->geometry))
        text += tr(", which lies apart from the first");
    return text;
}

void SecondVolumeBox::showIsovalue() {
    const auto* dataset = session_.secondVolume().dataset();
    const auto* selected = session_.secondVolume().surfaces().active();
    if (dataset == nullptr || selected == nullptr)
        return;
    const model::SuggestedRange range = dataset->suggestedRange();
    const double share = range.max > range.min ? (selected->isovalue - range.min) / (range.max - range.min) : 0.0;
    const QSignalBlocker blocker(isovalue_); // a typed isovalue may lie between two steps
    isovalue_->setValue(static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * kIsovalueSteps)));
    isovalueText_->setText(fromStd(model::valueText(selected->isovalue, 6)));
}

} // namespace isoslider::widgets
