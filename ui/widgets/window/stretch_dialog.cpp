#include "ui/widgets/window/stretch_dialog.h"

#include <cmath>

#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/panels/fact_texts.h"

namespace isoslider::widgets {

StretchDialog::StretchDialog(const model::Session& session, model::ViewState& view, QWidget* parent)
    : QDialog(parent), session_(session), view_(view) {
    setObjectName(QStringLiteral("stretchDialog"));
    setAttribute(Qt::WA_DeleteOnClose);
    setWindowTitle(tr("Stretch Axes"));
    auto* text = new QLabel(tr("Lengths along an axis are drawn longer or shorter. What is measured, counted and "
                               "exported stays as the file has it."),
                            this);
    text->setWordWrap(true);
    makeQuiet(text);
    auto* grid = new QGridLayout;
    for (int row = 0; row < 3; ++row) {
        const auto a = static_cast<std::size_t>(row);
        auto* label = names_[a] = new QLabel(this);
        auto* factor = factors_[a] = new QDoubleSpinBox(this);
        factor->setObjectName(QStringLiteral("stretch%1").arg(QLatin1Char("XYZ"[row])));
        factor->setDecimals(3);
        factor->setRange(1.0 / model::kMostStretch, model::kMostStretch);
        factor->setPrefix(tr("× "));
        factor->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
        factor->setKeyboardTracking(false);
        label->setBuddy(factor);
        sides_[a] = new QLabel(this);
        makeQuiet(sides_[a]);
        grid->addWidget(label, row, 0);
        grid->addWidget(factor, row, 1);
        grid->addWidget(sides_[a], row, 2);
        connect(factor, &QDoubleSpinBox::valueChanged, this, [this, row](double value) {
            glm::dvec3 stretch = view_.options().stage.stretch;
            stretch[axisInRow(row)] = value;
            set(stretch);
        });
    }
    grid->setColumnStretch(2, 1);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, this);
    suggested_ = buttons->addButton(tr("&Suggested"), QDialogButtonBox::ActionRole);
    suggested_->setObjectName(QStringLiteral("stretchSuggested"));
    suggested_->setToolTip(tr("Round factors that make a box to look at of a needle or a plate"));
    none_ = buttons->addButton(tr("&True Lengths"), QDialogButtonBox::ActionRole);
    none_->setObjectName(QStringLiteral("stretchNone"));
    for (auto* button : {suggested_, none_, buttons->button(QDialogButtonBox::Close)})
        button->setAutoDefault(false); // Return takes the number that is being typed
    auto* layout = new QVBoxLayout(this);
    layout->addWidget(text);
    layout->addSpacing(6);
    layout->addLayout(grid);
    layout->addSpacing(6);
    layout->addWidget(buttons);
    setMinimumWidth(400);

    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
    connect(none_, &QPushButton::clicked, this, [this] { set(glm::dvec3(1.0)); });
    connect(suggested_, &QPushButton::clicked, this, [this] {
        const auto* dataset = session_.dataset();
        if (const auto stretch = dataset != nullptr ? model::suggestedStretch(dataset->geometry) : std::nullopt)
            set(*stretch);
    });
    subscriptions_ = {view_.observe([this] { showState(); }),
                      session_.datasetChanged().observe([this] { showState(); })};
    showState();
}

model::AxisNames StretchDialog::axisNames() const {
    const auto* dataset = session_.dataset();
    return dataset != nullptr ? model::AxisNames(dataset->geometry) : model::AxisNames();
}

int StretchDialog::axisInRow(int row) const { return axisNames().gridAxisInRow(row); }

void StretchDialog::set(const glm::dvec3& stretch) {
    auto options = view_.options();
    options.stage.stretch = stretch;
    view_.setOptions(options);
}

void StretchDialog::showState() {
    const auto* dataset = session_.dataset();
    const glm::dvec3& stretch = view_.options().stage.stretch;
    for (int row = 0; row < 3; ++row) {
        const auto a = static_cast<std::size_t>(row);
        const int axis = axisInRow(row);
        const QString name = fromStd(axisNames().nameOf(axis));
        names_[a]->setText(QLatin1Char('&') + name);
        factors_[a]->setAccessibleName(tr("Stretch along %1").arg(name));
        const QSignalBlocker quiet(factors_[a]);
        factors_[a]->setValue(stretch[axis]);
        factors_[a]->setEnabled(dataset != nullptr);
        if (dataset == nullptr) {
            sides_[a]->clear();
            continue;
        }
        const double side = std::abs(dataset->geometry.spacing[axis]) *
                            static_cast<double>(dataset->geometry.dims[static_cast<std::size_t>(axis)] - 1);
        sides_[a]->setText(tr("%1 long").arg(inLengthUnit(fromStd(model::valueText(side, 4)), dataset->lengthUnit)));
    }
    suggested_->setEnabled(dataset != nullptr && model::suggestedStretch(dataset->geometry).has_value());
    none_->setEnabled(dataset != nullptr && model::isStretched(stretch));
}

} // namespace isoslider::widgets
