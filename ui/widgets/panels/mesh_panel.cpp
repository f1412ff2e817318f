#include "ui/widgets/panels/mesh_panel.h"

#include <QAction>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/axis_names.h"
#include "ui/model/surface/view_state.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/panels/shown_note.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

constexpr int kCountsIntervalMs = 60;

QString number(double value) { return fromStd(model::valueText(value, 7)); }
// Words, not colour, carry the verdict.
QString yesNo(bool isTrue) {
    return isTrue ? QStringLiteral("✓ ") + MeshPanel::tr("yes") : QStringLiteral("✗ ") + MeshPanel::tr("no");
}

QString placeName(mesh::OpenAt place, const model::AxisNames& names) {
    switch (place) {
        case mesh::OpenAt::Missing: return MeshPanel::tr("missing values");
        case mesh::OpenAt::Elsewhere: return MeshPanel::tr("cracks");
        default: {
            const int face = static_cast<int>(place);
            return fromStd(names.nameOf(face / 2)).toLower() + QString::number(face % 2);
        }
    }
}

// Lines break between places, not within one.
QString unbroken(QString text) { return text.replace(QLatin1Char(' '), QChar(QChar::Nbsp)); }

QString surfaceText(const mesh::Certificate& certificate) {
    const model::AxisNames names(certificate.geometry);
    QStringList places;
    for (std::size_t i = 0; i < certificate.openings.size(); ++i) {
        const auto& opening = certificate.openings[i];
        const auto place = placeName(static_cast<mesh::OpenAt>(i), names);
        if (opening.loops == 1)
            places << unbroken(MeshPanel::tr("%1 (1 loop)").arg(place));
        else if (opening.loops > 1)
            places << unbroken(MeshPanel::tr("%1 (%2 loops)").arg(place, grouped(opening.loops)));
    }
    if (certificate.report.triangles == 0)
        return MeshPanel::tr("none at this isovalue");
    if (places.isEmpty())
        return MeshPanel::tr("closed");
    const QString text = MeshPanel::tr("open at %1").arg(places.join(QStringLiteral(", ")));
    if (certificate.sharedLoops == 0)
        return text;
    const QString which = places.size() == 2 ? MeshPanel::tr("both") : MeshPanel::tr("several of these");
    return text + (certificate.sharedLoops == 1
                       ? MeshPanel::tr("; 1 loop meets %1").arg(which)
                       : MeshPanel::tr("; %1 loops meet %2").arg(grouped(certificate.sharedLoops), which));
}

QString nudgeText(const mesh::Nudge& nudge, const std::string& unit) {
    if (nudge.vertices == 0)
        return grouped(0);
    const auto length = [](double value) { return QString::fromStdString(model::valueText(value, 3)); };
    return MeshPanel::tr("%1, by at most %2 %3")
        .arg(grouped(nudge.vertices), unbroken(MeshPanel::tr("%1 cells").arg(length(nudge.largestCells))),
             QStringLiteral("(%1)").arg(inLengthUnit(length(nudge.largestWorld), unit)));
}

QString verdict(const mesh::Certificate& certificate) {
    if (certificate.report.triangles == 0)
        return MeshPanel::tr("– (no surface)");
    QStringList faults;
    for (const auto& fault : mesh::faultsOf(certificate))
        faults << QString::fromStdString(fault);
    return faults.isEmpty() ? yesNo(true)
                            : MeshPanel::tr("%1: %2").arg(yesNo(false), faults.join(QStringLiteral(", ")));
}

std::vector<Fact> factsOf(const mesh::Certificate& certificate, const std::string& unit) {
    const auto tr = [](const char* text) { return MeshPanel::tr(text); };
    const mesh::MeshReport& report = certificate.report;
    const QString unitTip =
        unit.empty() ? tr("In the units of the volume's spacing, which its file does not name") : QString();
    const model::AxisNames names(certificate.geometry);
    const bool hasGenus = report.isManifold && report.isOriented;
    return {
        {tr("Sound"), verdict(certificate),
         tr("An oriented manifold, open only where it meets the box or a missing value")},
        {tr("Surface"), surfaceText(certificate),
         tr("%1 is the box's face of the first grid points along %2, %3 that of the last")
             .arg(placeName(mesh::OpenAt::X0, names), fromStd(names.nameOf(0)).toLower(),
                  placeName(mesh::OpenAt::X1, names))},
        {tr("Manifold"), yesNo(report.isManifold), tr("Every edge has one or two triangles, every vertex one fan")},
        {tr("Oriented"), yesNo(report.isOriented),
         tr("Neighbouring triangles agree; all are counter-clockwise seen from the side below the isovalue")},
        {tr("Vertices"), grouped(report.vertices), {}},
        {tr("Inner vertices"), grouped(certificate.innerVertices), tr("Vertices inside cells, on no grid edge")},
        {tr("Edges"), grouped(report.edges), {}},
        {tr("Triangles"), grouped(report.triangles), {}},
        {tr("Components"), grouped(report.components), {}},
        {tr("Euler number"), grouped(report.euler), tr("Vertices − edges + triangles")},
        {tr("Boundary loops"), grouped(report.boundaryLoops), {}},
        {tr("Genus"), hasGenus ? grouped(report.genus) : QStringLiteral("–"), tr("Tunnels, summed over components")},
        {tr("Area"), inLengthUnit(fromStd(model::measureText(report.area)), unit, 2), unitTip},
        {tr("Enclosed volume"),
         report.isClosed ? inLengthUnit(fromStd(model::measureText(report.enclosedVolume)), unit, 3) : tr("– (open)"),
         tr("Inside a closed mesh. The volume above the isovalue, which the sides of the box may bound as well, is among "
            "the counts") +
             (unit.empty() ? QLatin1Char('\n') + unitTip : QString())},
        {tr("Degenerate triangles"), grouped(report.degenerateTriangles), tr("Zero area or a repeated vertex")},
        {tr("Duplicate triangles"), grouped(report.duplicateTriangles), {}},
        {tr("Nudged vertices"), nudgeText(certificate.nudge, unit),
         tr("Held off grid points that have the isovalue, along their edges, so that no triangle has zero area")},
        {tr("Grid"), certificate.geometry.isLeftHanded() ? tr("left-handed") : tr("right-handed"),
         tr("Triangles of a left-handed grid are turned, so that they face the same side in space")}};
}

} // namespace

MeshPanel::MeshPanel(model::Session& session, model::ViewState& view, const ActionRegistry& actions, QWidget* parent)
    : QWidget(parent),
      session_(session),
      view_(view),
      counts_(new FactForm(this)),
      shown_(new QLabel(this)),
      state_(new QLabel(this)),
      report_(new FactForm(this)),
      check_(new QPushButton(tr("Check Mesh"), this)),
      export_(new QPushButton(tr("Export…"), this)),
      countsThrottle_(kCountsIntervalMs, [this] { showCounts(); }) {
    const auto [scroll, page, layout] = fillWithScrollPage(this);
    layout->setSpacing(6);
    auto* buttons = new QHBoxLayout;
    check_->setObjectName(QStringLiteral("checkMeshButton"));
    export_->setObjectName(QStringLiteral("exportMeshButton"));
    connect(check_, &QPushButton::clicked, actions.action("mesh.check"), &QAction::trigger);
    connect(export_, &QPushButton::clicked, actions.action("mesh.export"), &QAction::trigger);
    buttons->addWidget(check_);
    buttons->addWidget(export_);
    buttons->addStretch(1);
    for (FactForm* form : {counts_, report_})
        form->reserveNameWidth(tr("Degenerate triangles"));
    counts_->setObjectName(QStringLiteral("countsForm"));
    report_->setObjectName(QStringLiteral("certificateForm"));
    shown_->setObjectName(QStringLiteral("meshShown"));
    for (QLabel* label : {shown_, state_}) {
        label->setWordWrap(true);
        makeQuiet(label);
    }
    layout->addWidget(makeHeading(tr("Whole Surface"), page));
    layout->addWidget(counts_);
    layout->addWidget(shown_);
    layout->addLayout(buttons);
    layout->addSpacing(6);
    layout->addWidget(makeHeading(tr("Certificate"), page));
    layout->addWidget(state_);
    layout->addWidget(report_);
    layout->addStretch(1);
    frameSubscription_ = session_.frameChanged().observe([this] { countsThrottle_.trigger(); });
    surfacesSubscription_ = session_.surfaces().observe([this] { countsThrottle_.trigger(); });
    viewSubscription_ = view_.observe([this] { countsThrottle_.trigger(); });
    reportSubscription_ = session_.certificateChanged().observe([this] { showReport(); });
    showCounts();
    showReport();
}

void MeshPanel::showCounts() {
    const auto frame = session_.frame();
    const QString none = QStringLiteral("–");
    counts_->setFacts(
        {{tr("Isovalue"), frame ? number(frame->isovalue) : none, {}},
         {tr("Active edges"), frame ? countText(*frame, frame->stats.activeEdges) : none, tr("One vertex on each")},
         {tr("Triangles"), frame ? countText(*frame, frame->stats.triangles) : none, {}}});
    shown_->setText(shownNote(session_, view_.options()));
    shown_->setVisible(!shown_->text().isEmpty());
    export_->setEnabled(frame != nullptr);
    showReport();
}

void MeshPanel::showReport() {
    const auto frame = session_.frame();
    const auto& certificate = session_.certificate();
    check_->setEnabled(frame && !session_.isCheckingMesh());
    report_->setFacts(certificate ? factsOf(*certificate, session_.dataset()->lengthUnit) : std::vector<Fact>{});
    if (session_.isCheckingMesh())
        state_->setText(tr("Checking…"));
    else if (session_.isPreview())
        state_->setText(tr("A preview is neither checked nor exported."));
    else if (!certificate)
        state_->setText(tr("Not checked yet."));
    else if (frame && frame->isovalue != certificate->isovalue)
        state_->setText(tr("At isovalue %1; the surface has moved since.").arg(number(certificate->isovalue)));
    else
        state_->setText(certificate->report.triangles > 0
                            ? tr("At isovalue %1.").arg(number(certificate->isovalue))
                            : tr("There is no surface at isovalue %1, so no triangle was checked.")
                                  .arg(number(certificate->isovalue)));
}

} // namespace isoslider::widgets
