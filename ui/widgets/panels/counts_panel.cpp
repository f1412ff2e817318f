#include "ui/widgets/panels/counts_panel.h"

#include <cmath>

#include <QLabel>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/view_state.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/panels/shown_note.h"

namespace isoslider::widgets {
namespace {

using model::TopologyQuantity;

constexpr int kShowIntervalMs = 60;

std::vector<Fact> surfaceFacts(const model::Session& session) {
    const auto frame = session.frame();
    if (!frame)
        return {};
    return {{CountsPanel::tr("Isovalue"), fromStd(model::exactText(frame->isovalue)), {}},
            {CountsPanel::tr("Triangles"), countText(*frame, frame->stats.triangles), {}},
            {CountsPanel::tr("Active edges"), countText(*frame, frame->stats.activeEdges),
             CountsPanel::tr("Grid edges that the surface crosses: one vertex on each")}};
}

// Where they are not exact, pieces and loops are at least as many as stated, and tunnels are not known.
std::vector<Fact> countFacts(const topology::SurfaceCounts& counts, bool areExact) {
    const auto atLeast = [areExact](std::int64_t count) {
        return (areExact ? QString() : QStringLiteral("≥ ")) + grouped(count);
    };
    return {{CountsPanel::tr("Pieces"), atLeast(counts.components), CountsPanel::tr("Parts that do not touch")},
            {CountsPanel::tr("Tunnels"), areExact ? grouped(counts.handles()) : CountsPanel::tr("not known"),
             CountsPanel::tr("Handles of all pieces together, the genus of a closed surface")},
            {CountsPanel::tr("Voids"), grouped(counts.voids),
             CountsPanel::tr("Closed hollows: parts below the isovalue that do not reach the volume's sides")},
            {CountsPanel::tr("Boundary loops"), atLeast(counts.loops),
             CountsPanel::tr("Closed lines where the surface ends: at the volume's sides, or at missing values")},
            {CountsPanel::tr("Euler number"), grouped(counts.euler),
             CountsPanel::tr("Vertices less edges plus triangles")}};
}

std::vector<Fact> measureFacts(const model::Session& session, double isovalue) {
    const auto& topology = session.topology();
    const std::string& unit = session.dataset()->lengthUnit;
    std::vector<Fact> facts;
    const auto add = [&](TopologyQuantity quantity, const QString& name, int power, const QString& tip) {
        const auto value = topology.valueAt(quantity, isovalue);
        if (!value)
            return;
        const QString number = fromStd(model::estimateText(*value));
        facts.push_back({name, power > 0 ? inLengthUnit(number, unit, power) : perLengthUnit(number, unit), tip});
    };
    add(TopologyQuantity::Area, CountsPanel::tr("Area"), 2,
        CountsPanel::tr("Without merged cells, to some tenths of a percent; Check Mesh measures the mesh"));
    add(TopologyQuantity::Volume, CountsPanel::tr("Volume above"), 3,
        CountsPanel::tr(
            "Of the region where samples are above the isovalue, up to the volume's sides, to some tenths of "
            "a percent; Check Mesh measures what a closed surface encloses"));
    add(TopologyQuantity::Gradient, CountsPanel::tr("Mean gradient"), 0,
        CountsPanel::tr("Change of the value per unit of length, on the surface: the larger, the sharper its border"));
    return facts;
}

QString hintOf(const model::Session& session) {
    using model::TopologyState;
    if (session.dataset() == nullptr)
        return CountsPanel::tr("No volume is open.");
    switch (session.topology().state()) {
        case TopologyState::Ready: return {};
        case TopologyState::Analysing: return CountsPanel::tr("Being counted for all isovalues…");
        case TopologyState::Failed: return fromStd(session.topology().problem());
        case TopologyState::None: break;
    }
    return CountsPanel::tr("Counted once the index is built.");
}

// What counts stand for.
QString noteOf(const model::TopologyModel& topology) {
    if (!topology.areCountsExact())
        return CountsPanel::tr("Samples are missing: pieces and boundary loops are at least as many as stated.");
    if (!topology.hasEvents())
        return CountsPanel::tr("Counted at some thousand isovalues: these are the counts at the next of them.");
    return {};
}

} // namespace

CountsPanel::CountsPanel(model::Session& session, model::ViewState& view, QWidget* parent)
    : QWidget(parent),
      session_(session),
      view_(view),
      surface_(new FactForm(this)),
      shown_(new QLabel(this)),
      counts_(new FactForm(this)),
      measures_(new FactForm(this)),
      hint_(new QLabel(this)),
      measuresHeading_(makeHeading(tr("Measures"), this)),
      throttle_(kShowIntervalMs, [this] { show(); }) {
    const auto [scroll, page, rows] = fillWithScrollPage(this);
    rows->setSpacing(6);
    surface_->setObjectName(QStringLiteral("surfaceFacts"));
    counts_->setObjectName(QStringLiteral("surfaceCounts"));
    measures_->setObjectName(QStringLiteral("surfaceMeasures"));
    hint_->setObjectName(QStringLiteral("surfaceHint"));
    shown_->setObjectName(QStringLiteral("countsShown"));
    for (QLabel* label : {shown_, hint_}) {
        label->setWordWrap(true);
        makeQuiet(label);
    }
    for (FactForm* form : {surface_, counts_, measures_})
        form->reserveNameWidth(tr("Boundary loops"));
    rows->addWidget(makeHeading(tr("Whole Surface"), page));
    rows->addWidget(surface_);
    rows->addWidget(shown_);
    rows->addSpacing(6);
    rows->addWidget(makeHeading(tr("Topology"), page));
    rows->addWidget(hint_);
    rows->addWidget(counts_);
    rows->addSpacing(6);
    rows->addWidget(measuresHeading_);
    rows->addWidget(measures_);
    rows->addStretch(1);
    subscriptions_.push_back(session_.datasetChanged().observe([this] { throttle_.trigger(); }));
    subscriptions_.push_back(session_.frameChanged().observe([this] { throttle_.trigger(); }));
    subscriptions_.push_back(session_.surfaces().observe([this] { throttle_.trigger(); }));
    subscriptions_.push_back(view_.observe([this] { throttle_.trigger(); }));
    subscriptions_.push_back(session_.topology().changed().observe([this] { throttle_.trigger(); }));
    show();
}

void CountsPanel::show() {
    surface_->setFacts(surfaceFacts(session_));
    shown_->setText(shownNote(session_, view_.options()));
    shown_->setVisible(!shown_->text().isEmpty());
    const auto frame = session_.frame();
    const auto counts = frame ? session_.topology().countsAt(frame->isovalue) : std::nullopt;
    const bool areExact = session_.topology().areCountsExact();
    counts_->setFacts(counts ? countFacts(counts.value_or(topology::SurfaceCounts()), areExact) : std::vector<Fact>{});
    const auto measures = counts ? measureFacts(session_, frame->isovalue) : std::vector<Fact>{};
    measures_->setFacts(measures);
    measuresHeading_->setVisible(!measures.empty());
    const QString hint = counts ? noteOf(session_.topology()) : hintOf(session_);
    hint_->setText(hint);
    hint_->setVisible(!hint.isEmpty());
}

} // namespace isoslider::widgets
