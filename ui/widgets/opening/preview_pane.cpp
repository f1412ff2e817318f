#include "ui/widgets/opening/preview_pane.h"

#include <algorithm>

#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QVBoxLayout>

#include <qcustomplot.h>

#include "ui/model/isovalue/histogram_model.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/isovalue/plot_style.h"
#include "ui/widgets/opening/slice_view.h"
#include "ui/widgets/panels/fact_texts.h"

namespace isoslider::widgets {
namespace {

constexpr std::size_t kMostBins = 256;

QString describe(const model::VolumePreview& volume) {
    const QString range = volume.missingSamples == volume.samples ? PreviewPane::tr("every sample is missing")
                                                                  : PreviewPane::tr("values %1 … %2")
                                                                        .arg(fromStd(model::valueText(volume.min, 8)),
                                                                             fromStd(model::valueText(volume.max, 8)));
    QString text = PreviewPane::tr("All samples: %1").arg(range);
    if (volume.isResampled)
        text = PreviewPane::tr("Resampled to %1 for this preview: %2").arg(dimsText(volume.info.geometry.dims), range);
    else if (volume.coarseStep > 1)
        text = PreviewPane::tr("One of %1 samples along each axis: %2").arg(volume.coarseStep).arg(range);
    if (volume.missingSamples > 0 && volume.missingSamples < volume.samples)
        text += PreviewPane::tr(", %1 missing (violet)").arg(fromStd(model::groupedText(volume.missingSamples)));
    return text;
}

} // namespace

PreviewPane::PreviewPane(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("previewPane"));
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->setSpacing(10);
    auto* row = new QHBoxLayout;
    row->setSpacing(8);
    for (std::size_t i = 0; i < slices_.size(); ++i)
        row->addWidget(slices_[i] = new SliceView(2 - static_cast<int>(i), this), 1);
    layout->addLayout(row, 3);
    makePlot();
    layout->addWidget(plot_, 2);
    progress_ = new QProgressBar(this);
    progress_->setObjectName(QStringLiteral("previewProgress"));
    progress_->setAccessibleName(tr("Reading the preview"));
    progress_->setTextVisible(false);
    progress_->setFixedHeight(6);
    QSizePolicy policy = progress_->sizePolicy();
    policy.setRetainSizeWhenHidden(true); // nothing may jump when reading begins or ends
    progress_->setSizePolicy(policy);
    status_ = new QLabel(this);
    status_->setObjectName(QStringLiteral("previewStatus"));
    status_->setTextFormat(Qt::PlainText);
    status_->setWordWrap(true);
    status_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    status_->setMinimumWidth(1); // a word as long as a file's name makes no wide dialog
    status_->setMinimumHeight(2 * fontMetrics().height() + 2);
    status_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
    layout->addWidget(status_);
    layout->addWidget(progress_);
}

void PreviewPane::makePlot() {
    plot_ = new QCustomPlot(this);
    plot_->setObjectName(QStringLiteral("previewHistogram"));
    plot_->setAccessibleName(tr("Histogram"));
    plot_->setMinimumHeight(110);
    plot_->plotLayout()->setMargins(QMargins(0, 0, 4, 0));
    plot_->axisRect()->setRangeDrag(Qt::Orientations());
    plot_->axisRect()->setMinimumMargins(QMargins(44, 4, 10, 0));
    counts_ = plot_->addGraph();
    counts_->setLineStyle(QCPGraph::lsStepLeft);
    applyPalette();
    plot_->xAxis->ticker()->setTickCount(6);
    plot_->xAxis->setLabel(tr("value"));
    plot_->yAxis->setLabel(tr("samples, logarithmic"));
    plot_->yAxis->setScaleType(QCPAxis::stLogarithmic);
    plot_->yAxis->setTicker(QSharedPointer<CompactLogTicker>::create());
    clearVolume();
}

void PreviewPane::applyPalette() {
    const auto colours = plotColours(palette());
    plot_->setBackground(palette().color(QPalette::Window));
    plot_->axisRect()->setBackground(palette().color(QPalette::Base));
    counts_->setPen(QPen(colours.counts, 1.0));
    counts_->setBrush(colours.countsFill);
    for (QCPAxis* axis : {plot_->xAxis, plot_->yAxis})
        styleAxis(axis, palette());
}

void PreviewPane::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() != QEvent::PaletteChange || counts_ == nullptr || status_ == nullptr)
        return;
    applyPalette();
    plot_->replot(QCustomPlot::rpQueuedReplot);
    setStatus(status_->text(), isError_);
}

void PreviewPane::showPreview(const model::PreviewModel& preview) {
    using State = model::PreviewModel::State;
    const bool isLoading = preview.state() == State::Loading;
    const auto* volume = preview.preview();
    if (volume == nullptr)
        clearVolume();
    else if (!isLoading)
        showVolume(*volume);
    for (auto* slice : slices_)
        slice->setStale(isLoading);
    progress_->setVisible(isLoading);
    progress_->setRange(0, preview.fraction() > 0.0 ? 1000 : 0);
    progress_->setValue(qRound(preview.fraction() * 1000.0));
    if (isLoading)
        setStatus(tr("Reading a preview…"), false);
    else if (preview.state() == State::Failed)
        setStatus(fromStd(preview.error().line()), true);
    else
        setStatus(volume != nullptr ? describe(*volume) : QString(), false);
}

void PreviewPane::showProblem(const QString& text) {
    clearVolume();
    progress_->setVisible(false);
    setStatus(text, true);
}

void PreviewPane::showVolume(const model::VolumePreview& volume) {
    for (std::size_t i = 0; i < slices_.size(); ++i)
        slices_[i]->setSlice(volume.slices[i], model::AxisNames(volume.info.geometry));
    showHistogram(volume);
}

void PreviewPane::showHistogram(const model::VolumePreview& volume) {
    const auto& histogram = volume.histogram;
    const auto bins = std::min(kMostBins, model::drawableBins(histogram, volume.info.type));
    const auto outline = model::outlineOf(histogram, bins);
    QVector<double> values(outline.values.begin(), outline.values.end());
    QVector<double> counts(outline.counts.begin(), outline.counts.end());
    if (!counts.isEmpty()) {
        values.append(histogram.max);
        counts.append(counts.last());
    }
    counts_->setData(values, counts, true);
    const double most = counts.isEmpty() ? 1.0 : *std::max_element(counts.begin(), counts.end());
    const double margin = histogram.max > histogram.min ? 0.0 : 0.5;
    plot_->xAxis->setRange(histogram.min - margin, histogram.max + margin);
    plot_->yAxis->setRange(0.7, std::max(2.0, most * 2.0));
    for (QCPAxis* axis : {plot_->xAxis, plot_->yAxis})
        axis->setVisible(!counts.isEmpty());
    plot_->replot(QCustomPlot::rpQueuedReplot);
}

void PreviewPane::clearVolume() {
    for (auto* slice : slices_)
        slice->clear();
    counts_->data()->clear();
    for (QCPAxis* axis : {plot_->xAxis, plot_->yAxis})
        axis->setVisible(false);
    plot_->replot(QCustomPlot::rpQueuedReplot);
}

void PreviewPane::setStatus(const QString& text, bool isError) {
    isError_ = isError;
    status_->setText(text);
    QPalette colours = palette();
    const bool isDark = colours.color(QPalette::Window).lightness() < 128;
    if (isError)
        colours.setColor(QPalette::WindowText, isDark ? QColor(255, 138, 122) : QColor(176, 32, 20));
    status_->setPalette(colours);
}

QString PreviewPane::statusText() const { return status_->text(); }

} // namespace isoslider::widgets
