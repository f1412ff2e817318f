#include "ui/widgets/panels/dataset_panel.h"

#include <QAction>
#include <QDir>
#include <QLabel>
#include <QPushButton>
#include <QScrollArea>
#include <QStackedWidget>
#include <QVBoxLayout>

#include "core/volume_io/sources/coarse_reader.h"
#include "ui/model/isovalue/deviation_text.h"
#include "ui/model/isovalue/isovalue_words.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

/// A name without blanks, such as that of a DICOM series, cannot be broken into lines.
QString shortened(const QString& name) {
    constexpr qsizetype kMost = 36;
    return name.size() <= kMost ? name : name.left(kMost / 2) + QStringLiteral("…") + name.right(kMost / 2);
}

/// What is known of the samples: of all, or of those of the preview.
std::vector<Fact> sampleFactsOf(const model::Dataset& dataset, bool isPreview, bool isInMemory) {
    using model::groupedText;
    const auto seen = [isPreview](const QString& text) {
        return isPreview ? DatasetPanel::tr("%1 in the preview").arg(text) : text;
    };
    std::vector<Fact> facts;
    facts.push_back(
        {DatasetPanel::tr("Values"),
         seen(QStringLiteral("%1 … %2").arg(fromStd(model::isovalueText(dataset.min, dataset.min, dataset.max, 8)),
                                            fromStd(model::isovalueText(dataset.max, dataset.min, dataset.max, 8)))),
         {}});
    if (!dataset.values->isEmpty()) {
        const ValueSpread& spread = dataset.values->spread;
        facts.push_back({DatasetPanel::tr("Mean ± deviation"), seen(fromStd(model::spreadText(spread))),
                         spread.isExact
                             ? DatasetPanel::tr("Mean and standard deviation of all samples; an isovalue may be typed "
                                                "in deviations from the mean, as “2.5 sigma”")
                             : DatasetPanel::tr("Mean and standard deviation, estimated from some of the samples")});
    }
    if (dataset.distinctValues > 0)
        facts.push_back({DatasetPanel::tr("Distinct values"), fromStd(groupedText(dataset.distinctValues)), {}});
    facts.push_back(
        {DatasetPanel::tr("Missing samples"),
         seen(dataset.missingSamples == 0 ? DatasetPanel::tr("none") : fromStd(groupedText(dataset.missingSamples))),
         DatasetPanel::tr("NaN and infinite samples make no surface")});
    facts.push_back({DatasetPanel::tr("Sample data"),
                     QStringLiteral("%1, %2").arg(fromStd(model::bytesText(dataset.sampleBytes())),
                                                  isInMemory && !isPreview ? DatasetPanel::tr("in memory")
                                                                           : DatasetPanel::tr("not in memory")),
                     {}});
    return facts;
}

/// For people, with the name that the file knows it by in the tip.
std::optional<Fact> fieldFactOf(const model::Dataset& dataset) {
    const QString name = fromStd(dataset.fieldName);
    if (!dataset.fieldTitle.empty())
        return Fact{DatasetPanel::tr("Field"), fromStd(dataset.fieldTitle), name};
    if (!name.isEmpty())
        return Fact{DatasetPanel::tr("Field"), shortened(name), name};
    return std::nullopt;
}

std::vector<Fact> volumeFactsOf(const model::Dataset& dataset, bool isPreview, bool isInMemory) {
    using model::groupedText;
    const auto& geometry = dataset.geometry;
    const QString path = fromStd(dataset.path.string());
    std::vector<Fact> facts;
    facts.push_back({DatasetPanel::tr("File"), shortened(fromStd(dataset.name)), QDir::toNativeSeparators(path)});
    facts.push_back({DatasetPanel::tr("Format"), fromStd(dataset.format), {}});
    if (const auto fact = fieldFactOf(dataset))
        facts.push_back(*fact);
    facts.push_back(
        {DatasetPanel::tr("Grid points"),
         QStringLiteral("%1 = %2").arg(dimsText(geometry.dims), fromStd(groupedText(pointCount(geometry.dims)))),
         {}});
    if (isPreview)
        facts.push_back({DatasetPanel::tr("Preview"),
                         DatasetPanel::tr("%1, at 1:%2")
                             .arg(dimsText(io::coarseDims(geometry.dims, dataset.coarseStep)))
                             .arg(dataset.coarseStep),
                         DatasetPanel::tr("One of %1 samples along each axis").arg(dataset.coarseStep)});
    for (auto& fact : placeFactsOf(geometry, dataset.lengthUnit, model::isPatientSpace(dataset)))
        facts.push_back(std::move(fact));
    facts.push_back({DatasetPanel::tr("Sample type"), typeText(dataset.type), {}});
    for (auto& fact : sampleFactsOf(dataset, isPreview, isInMemory))
        facts.push_back(std::move(fact));
    for (auto& fact : resamplingFactsOf(dataset.resampling))
        facts.push_back(std::move(fact));
    for (const auto& note : dataset.notes)
        facts.push_back({DatasetPanel::tr("Note"), fromStd(note), {}});
    return facts;
}

std::vector<Fact> indexFactsOf(const model::Dataset& dataset) {
    const auto& info = *dataset.index;
    const QString path = fromStd(dataset.indexPath.string());
    const bool isEdges = info.kind == index::IndexKind::Edges;
    return {
        {DatasetPanel::tr("File"), shortened(fromStd(dataset.indexPath.filename().string())),
         QDir::toNativeSeparators(path)},
        {DatasetPanel::tr("Kind"), isEdges ? DatasetPanel::tr("edges") : DatasetPanel::tr("metacells"),
         isEdges ? DatasetPanel::tr("The samples, compressed, and the changes of every grid edge, by value")
                 : DatasetPanel::tr("The samples, compressed, and when each brick of them is active")},
        {DatasetPanel::tr("Size"),
         DatasetPanel::tr("%1, %2 bytes per voxel")
             .arg(fromStd(model::bytesText(info.indexBytes)), fromStd(model::valueText(dataset.bytesPerVoxel(), 4))),
         DatasetPanel::tr("%1 bytes").arg(fromStd(model::groupedText(info.indexBytes)))}};
}

QString indexStateText(model::IndexState state, bool isPreview) {
    switch (state) {
        case model::IndexState::None: return DatasetPanel::tr("No index yet.");
        case model::IndexState::Building:
            return isPreview ? DatasetPanel::tr("Being built from the file; until then a preview is shown.")
                             : DatasetPanel::tr("Being built; until then the samples in memory are used.");
        case model::IndexState::Ready: return {};
        case model::IndexState::Failed:
            return isPreview ? DatasetPanel::tr("Could not be built; the preview stays.")
                             : DatasetPanel::tr("Could not be built; the samples in memory are used.");
        case model::IndexState::Cancelled:
            return isPreview ? DatasetPanel::tr("Cancelled; the preview stays.")
                             : DatasetPanel::tr("Cancelled; the samples in memory are used.");
    }
    return {};
}

} // namespace

DatasetPanel::DatasetPanel(model::Session& session, const ActionRegistry& actions, QWidget* parent)
    : QWidget(parent), session_(session), pages_(new QStackedWidget(this)) {
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->addWidget(pages_);
    pages_->addWidget(makeEmptyPage(actions));
    pages_->addWidget(makeFactsPage(actions));
    subscription_ = session_.datasetChanged().observe([this] { showDataset(); });
    showDataset();
}

QWidget* DatasetPanel::makeEmptyPage(const ActionRegistry& actions) {
    auto* page = new QWidget(this);
    auto* layout = new QVBoxLayout(page);
    auto* text = new QLabel(tr("No volume is open."), page);
    text->setAlignment(Qt::AlignCenter);
    makeQuiet(text);
    auto* open = new QPushButton(actions.action("file.open")->icon(), tr("Open Volume…"), page);
    connect(open, &QPushButton::clicked, actions.action("file.open"), &QAction::trigger);
    layout->addStretch(1);
    layout->addWidget(text);
    layout->addWidget(open, 0, Qt::AlignHCenter);
    layout->addStretch(1);
    return page;
}

QWidget* DatasetPanel::makeFactsPage(const ActionRegistry& actions) {
    const auto [scroll, page, layout] = makeScrollPage(this);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    layout->setSpacing(6);
    volumeFacts_ = new FactForm(page);
    volumeFacts_->setObjectName(QStringLiteral("datasetForm"));
    indexFacts_ = new FactForm(page);
    for (FactForm* form : {volumeFacts_, indexFacts_})
        form->reserveNameWidth(tr("Mean ± deviation"));
    indexState_ = new QLabel(page);
    indexState_->setWordWrap(true);
    build_ = new QPushButton(tr("Build Index"), page);
    connect(build_, &QPushButton::clicked, actions.action("index.build"), &QAction::trigger);
    layout->addWidget(makeHeading(tr("Volume"), page));
    layout->addWidget(volumeFacts_);
    layout->addSpacing(8);
    layout->addWidget(makeHeading(tr("Index"), page));
    layout->addWidget(indexState_);
    layout->addWidget(indexFacts_);
    layout->addWidget(build_, 0, Qt::AlignLeft);
    layout->addStretch(1);
    return scroll;
}

void DatasetPanel::showDataset() {
    const auto* dataset = session_.dataset();
    pages_->setCurrentIndex(dataset != nullptr ? 1 : 0);
    if (dataset == nullptr)
        return;
    const auto state = session_.indexState();
    volumeFacts_->setFacts(volumeFactsOf(*dataset, session_.isPreview(), state != model::IndexState::Ready));
    indexFacts_->setFacts(dataset->index ? indexFactsOf(*dataset) : std::vector<Fact>{});
    const QString text = indexStateText(state, session_.isPreview());
    indexState_->setText(text);
    indexState_->setVisible(!text.isEmpty());
    build_->setVisible(state == model::IndexState::Failed || state == model::IndexState::Cancelled);
}

} // namespace isoslider::widgets
