#include "ui/widgets/isovalue/detail_control.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>

#include "ui/model/session/session.h"
#include "ui/widgets/common/small_widgets.h"

namespace isoslider::widgets {

using Measure = model::DetailModel::Measure;

DetailControl::DetailControl(model::Session& session, QWidget* parent)
    : QWidget(parent), session_(session), slider_(new QSlider(Qt::Horizontal, this)), measure_(new QComboBox(this)) {
    auto* layout = new QHBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->setSpacing(6);
    auto* name = new QLabel(tr("Error"), this);
    name->setBuddy(slider_);
    layout->addWidget(name);
    layout->addWidget(slider_);
    value_ = new QLabel(this);
    value_->setObjectName(QStringLiteral("detailValue"));
    value_->setMinimumWidth(fontMetrics().horizontalAdvance(tr("0.25 cells")) + 4);
    layout->addWidget(value_);
    layout->addWidget(measure_);
    slider_->setObjectName(QStringLiteral("detailSlider"));
    slider_->setAccessibleName(tr("Error"));
    slider_->setRange(0, static_cast<int>(model::DetailModel::choices(Measure::Distance).size()) - 1);
    slider_->setPageStep(1);
    slider_->setFixedWidth(84);
    measure_->setObjectName(QStringLiteral("detailMeasure"));
    measure_->setAccessibleName(tr("Error in"));
    measure_->setToolTip(tr("Error in cells of the grid, or in percent of the value range"));
    measure_->addItem(tr("cells"), static_cast<int>(Measure::Distance));
    measure_->addItem(tr("%"), static_cast<int>(Measure::Scalar));
    connect(slider_, &QSlider::valueChanged, this, [this] { request(); });
    connect(measure_, &QComboBox::currentIndexChanged, this, [this] { request(); });
    errorSubscription_ = session_.detail().observe([this] { showError(); });
    datasetSubscription_ = session_.datasetChanged().observe([this] { showWhetherPossible(); });
    frameSubscription_ = session_.frameChanged().observe([this] { showWhetherPossible(); });
    showError();
    showWhetherPossible();
}

QWidget* DetailControl::measure() { return measure_; }

void DetailControl::request() {
    const auto measure = static_cast<Measure>(measure_->currentData().toInt());
    session_.detail().setError(
        {measure, model::DetailModel::choices(measure)[static_cast<std::size_t>(slider_->value())]});
}

void DetailControl::showError() {
    const auto& error = session_.detail().error();
    const QSignalBlocker slider(slider_), measure(measure_);
    measure_->setCurrentIndex(measure_->findData(static_cast<int>(error.measure)));
    slider_->setValue(static_cast<int>(model::DetailModel::nearestChoice(error)));
    setReadout(value_, QString::fromStdString(model::DetailModel::text(error)));
}

void DetailControl::showWhetherPossible() {
    const auto frame = session_.frame();
    setEnabled(frame != nullptr && !frame->isWholeExtraction);
    setToolTip(tr("How far the surface may differ for the sake of fewer triangles: cells are merged where the samples "
                  "allow it. Pieces and tunnels stay as they are."));
}

} // namespace isoslider::widgets
