#include "ui/widgets/panels/clip_panel.h"

#include <algorithm>
#include <cmath>

#include <QAction>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/model/session/session.h"
#include "ui/model/surface/axis_names.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/viewport/clip_tool.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

constexpr int kBoxWidth = 64;
constexpr double kOffsetSteps = 100.0; // from the centre to the volume's end

QToolButton* addButton(QHBoxLayout* row, QAction* action, const QString& text, QWidget* parent) {
    action->setIconText(text); // its button takes the text from there, again and again
    QToolButton* button = makeToolButton(action, Qt::ToolButtonTextOnly, parent);
    button->setAccessibleName(action->statusTip());
    row->addWidget(button);
    return button;
}

/// Left alone where it shows that already: somebody may be typing.
template <class Box, class Value>
void showValue(Box* box, Value low, Value high, Value value) {
    const QSignalBlocker blocker(box);
    if (box->minimum() != low || box->maximum() != high)
        box->setRange(low, high);
    if (box->value() != value)
        box->setValue(value);
}

} // namespace

ClipPanel::ClipPanel(model::Session& session, ViewportHost& host, const ActionRegistry& actions, QWidget* parent)
    : QWidget(parent), session_(session), host_(host) {
    const ScrollPage page = fillWithScrollPage(this);
    page.rows->setSpacing(6);
    addCrop(page.rows, actions);
    page.rows->addSpacing(8);
    addPlane(page.rows, actions);
    page.rows->addStretch(1);
    subscriptions_.push_back(host_.viewState().observe([this] { showClipping(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { showClipping(); }));
    if (host_.clipTool() != nullptr)
        for (std::size_t place = 0; place < model::kClipPlanes; ++place)
            subscriptions_.push_back(host_.clipTool()->cap(place).observe([this] { showClipping(); }));
    showClipping();
}

void ClipPanel::addCrop(QVBoxLayout* rows, const ActionRegistry& actions) {
    auto* row = new QHBoxLayout;
    row->addWidget(makeHeading(tr("Crop box"), this));
    row->addStretch(1);
    addButton(row, actions.action("clip.crop"), tr("Crop"), this);
    addButton(row, actions.action("clip.resetCrop"), tr("Reset"), this);
    rows->addLayout(row);
    auto* grid = new QGridLayout;
    grid->setHorizontalSpacing(8);
    grid->setVerticalSpacing(4);
    for (std::size_t line = 0; line < 3; ++line) {
        const QChar letter = QLatin1Char("XYZ"[line]);
        const auto addBox = [&](QSpinBox*& box, bool isHigh) {
            box = new QSpinBox(this);
            box->setObjectName(QLatin1String(isHigh ? "cropHigh" : "cropLow") + letter);
            box->setToolTip(tr("Grid points, counted from 0"));
            box->setMinimumWidth(kBoxWidth);
            box->setKeyboardTracking(false);
            connect(box, &QSpinBox::valueChanged, this, [this, line, isHigh](int point) {
                change([&](model::Clipping& clipping) {
                    const GridGeometry& geometry = session_.dataset()->geometry;
                    const int axis = model::AxisNames(geometry).gridAxisInRow(static_cast<int>(line));
                    clipping.crop = model::withFace(model::cropWithin(clipping.crop, geometry.dims), axis, isHigh,
                                                    point, geometry.dims);
                    clipping.isCropped = true;
                });
            });
        };
        addBox(low_[line], false);
        addBox(high_[line], true);
        axisLabels_[line] = new QLabel(this);
        const int at = static_cast<int>(line);
        grid->addWidget(axisLabels_[line], at, 0);
        grid->addWidget(low_[line], at, 1);
        grid->addWidget(new QLabel(tr("to"), this), at, 2);
        grid->addWidget(high_[line], at, 3);
    }
    grid->setColumnStretch(1, 1);
    grid->setColumnStretch(3, 1);
    rows->addLayout(grid);
}

void ClipPanel::addPlane(QVBoxLayout* rows, const ActionRegistry& actions) {
    auto* row = new QHBoxLayout;
    planeHeading_ = makeHeading(tr("Clip plane"), this);
    row->addWidget(planeHeading_);
    row->addStretch(1);
    addButton(row, actions.action("clip.plane"), tr("Clip"), this);
    addButton(row, actions.action("clip.flip"), tr("Flip"), this);
    addButton(row, actions.action("clip.second"), tr("Second"), this);
    rows->addLayout(row);
    auto* directions = new QHBoxLayout;
    directions->addWidget(new QLabel(tr("Across"), this));
    auto across = across_.begin();
    for (const char* id : {"clip.acrossX", "clip.acrossY", "clip.acrossZ"})
        *across++ = addButton(directions, actions.action(id), {}, this);
    addButton(directions, actions.action("clip.facing"), tr("the View"), this);
    directions->addStretch(1);
    rows->addLayout(directions);
    auto* grid = new QGridLayout;
    grid->setHorizontalSpacing(8);
    grid->setVerticalSpacing(4);
    grid->setColumnStretch(1, 1);
    offset_ = new QDoubleSpinBox(this);
    offset_->setObjectName(QStringLiteral("clipOffset"));
    offset_->setAccessibleName(tr("Distance of the clip plane from the volume's centre"));
    offset_->setToolTip(tr("Distance from the volume's centre, along the arrow"));
    offset_->setMinimumWidth(kBoxWidth);
    offset_->setKeyboardTracking(false);
    cap_ = new QComboBox(this);
    cap_->setObjectName(QStringLiteral("clipCap"));
    cap_->setAccessibleName(tr("What fills the cut"));
    cap_->addItems({tr("Nothing"), tr("A colour"), tr("The samples in grey")}); // by model::Cap
    cap_->setMinimumContentsLength(6);
    cap_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    const auto addRow = [&](int line, const QString& text, QWidget* field) {
        auto* label = new QLabel(text, this);
        label->setBuddy(field);
        grid->addWidget(label, line, 0);
        grid->addWidget(field, line, 1);
    };
    addRow(0, tr("Distance"), offset_);
    addRow(1, tr("Cut filled with"), cap_);
    rows->addLayout(grid);
    problem_ = new QLabel(this);
    problem_->setObjectName(QStringLiteral("clipProblem"));
    problem_->setWordWrap(true);
    problem_->setTextFormat(Qt::PlainText);
    makeQuiet(problem_);
    rows->addWidget(problem_);
    connect(offset_, &QDoubleSpinBox::valueChanged, this, [this](double offset) {
        change([&](model::Clipping& clipping) {
            clipping.plane().offset = offset;
            clipping.plane().isOn = true;
        });
    });
    connect(cap_, &QComboBox::activated, this, [this](int cap) {
        change([&](model::Clipping& clipping) { clipping.plane().cap = static_cast<model::Cap>(cap); });
    });
}

void ClipPanel::change(const std::function<void(model::Clipping&)>& change) {
    if (session_.dataset() == nullptr)
        return;
    auto options = host_.viewState().options();
    change(options.clipping);
    host_.viewState().setOptions(options);
    showClipping(); // what was asked for may be out of bounds
}

void ClipPanel::nameAxes() {
    const auto* dataset = session_.dataset();
    const model::AxisNames names = dataset != nullptr ? model::AxisNames(dataset->geometry) : model::AxisNames();
    for (std::size_t line = 0; line < 3; ++line) {
        const QString name = fromStd(names.nameOf(names.gridAxisInRow(static_cast<int>(line))));
        axisLabels_[line]->setText(name);
        low_[line]->setAccessibleName(tr("First grid point along %1").arg(name));
        high_[line]->setAccessibleName(tr("Last grid point along %1").arg(name));
        across_[line]->defaultAction()->setIconText(name);
        across_[line]->setAccessibleName(tr("Put the clip plane across %1, in the middle").arg(name));
    }
}

void ClipPanel::showClipping() {
    const auto* dataset = session_.dataset();
    const bool isPossible = dataset != nullptr && host_.clipTool() != nullptr;
    const model::Clipping& clipping = host_.viewState().options().clipping;
    nameAxes();
    for (std::size_t line = 0; line < 3; ++line) {
        for (QSpinBox* box : {low_[line], high_[line]})
            box->setEnabled(isPossible);
        if (dataset == nullptr)
            continue;
        const model::CropBox box = model::cropWithin(clipping.crop, dataset->geometry.dims);
        const auto axis =
            static_cast<std::size_t>(model::AxisNames(dataset->geometry).gridAxisInRow(static_cast<int>(line)));
        const auto last = static_cast<int>(dataset->geometry.dims[axis] - 1);
        showValue(low_[line], 0, last - 1, static_cast<int>(box.low[axis]));
        showValue(high_[line], 1, last, static_cast<int>(box.high[axis]));
    }
    // Named apart as soon as there are two.
    planeHeading_->setText(!clipping.planes[1].isOn && clipping.active == 0
                               ? tr("Clip plane")
                               : tr("Clip plane %1").arg(clipping.active + 1));
    offset_->setEnabled(isPossible && clipping.plane().isOn);
    cap_->setEnabled(isPossible && clipping.plane().isOn);
    cap_->setCurrentIndex(static_cast<int>(clipping.plane().cap));
    if (dataset != nullptr) {
        const double reach = model::reachAlong(clipping.plane().normal, dataset->geometry);
        const int decimals = reach > 0.0 ? std::clamp(3 - static_cast<int>(std::floor(std::log10(reach))), 0, 12) : 3;
        const QSignalBlocker blocker(offset_);
        if (offset_->decimals() != decimals)
            offset_->setDecimals(decimals);
        offset_->setSingleStep(reach / kOffsetSteps);
        const QString unit = fromStd(dataset->lengthUnit);
        offset_->setSuffix(unit.isEmpty() ? QString() : QLatin1Char(' ') + unit);
        offset_->setRange(-reach, reach);
        // Rounded, so that a distance with more digits is no other one.
        const double scale = std::pow(10.0, decimals);
        if (std::abs(offset_->value() - clipping.plane().offset) > 0.5 / scale)
            offset_->setValue(clipping.plane().offset);
    }
    const std::string problem = isPossible ? host_.clipTool()->cap(clipping.active).problem() : std::string();
    problem_->setText(fromStd(problem));
    problem_->setVisible(!problem.empty());
}

} // namespace isoslider::widgets
