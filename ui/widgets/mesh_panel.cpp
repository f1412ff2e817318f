#include "ui/widgets/mesh_panel.h"

#include <QAction>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QScrollArea>
#include <QVBoxLayout>

#include "ui/model/number_text.h"
#include "ui/model/session.h"
#include "ui/widgets/action_registry.h"
#include "ui/widgets/small_widgets.h"

namespace isoslider::widgets {
namespace {

constexpr int kCountsIntervalMs = 60;

QString grouped(std::uint64_t value) { return QString::fromStdString(model::groupedText(value)); }
QString number(double value) { return QString::fromStdString(model::valueText(value, 7)); }
// Words, not colour, carry the verdict.
QString yesNo(bool isTrue) { return isTrue ? QStringLiteral("✓ ") + MeshPanel::tr("yes") : QStringLiteral("✗ ") + MeshPanel::tr("no"); }

std::vector<Fact> reportFacts(const mesh::MeshReport& report) {
    const auto tr = [](const char* text) { return MeshPanel::tr(text); };
    return {{tr("Manifold"), yesNo(report.isManifold), tr("Every edge has one or two triangles, every vertex one fan")},
            {tr("Closed"), yesNo(report.isClosed), tr("No boundary edge; a surface that meets the box is open there")},
            {tr("Oriented"), yesNo(report.isOriented), tr("Neighbouring triangles agree on their common edge's direction")},
            {tr("Vertices"), grouped(report.vertices), {}},
            {tr("Edges"), grouped(report.edges), {}},
            {tr("Triangles"), grouped(report.triangles), {}},
            {tr("Components"), grouped(report.components), {}},
            {tr("Euler number"), QString::fromStdString(model::groupedText(report.euler)), tr("Vertices − edges + triangles")},
            {tr("Boundary loops"), grouped(report.boundaryLoops), {}},
            {tr("Genus"), QString::fromStdString(model::groupedText(report.genus)), tr("Tunnels, summed over components")},
            {tr("Degenerate triangles"), grouped(report.degenerateTriangles), tr("Zero area or a repeated vertex")},
            {tr("Duplicate triangles"), grouped(report.duplicateTriangles), {}},
            {tr("Area"), MeshPanel::tr("%1 units²").arg(number(report.area)), tr("In the file's units of length")},
            {tr("Enclosed volume"),
             report.isClosed ? MeshPanel::tr("%1 units³").arg(number(report.enclosedVolume)) : tr("– (the surface is open)"),
             tr("In the file's units of length")}};
}

} // namespace

MeshPanel::MeshPanel(model::Session& session, const ActionRegistry& actions, QWidget* parent)
    : QWidget(parent), session_(session), counts_(new FactForm(this)), state_(new QLabel(this)),
      report_(new FactForm(this)), check_(new QPushButton(tr("Check Mesh"), this)),
      export_(new QPushButton(tr("Export…"), this)), countsThrottle_(kCountsIntervalMs, [this] { showCounts(); }) {
    auto* outer = new QVBoxLayout(this);
    outer->setContentsMargins(0, 0, 0, 0);
    auto* scroll = new QScrollArea(this);
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    auto* page = new QWidget(scroll);
    auto* layout = new QVBoxLayout(page);
    layout->setContentsMargins(10, 8, 10, 8);
    layout->setSpacing(6);
    auto* buttons = new QHBoxLayout;
    check_->setObjectName(QStringLiteral("checkMeshButton"));
    export_->setObjectName(QStringLiteral("exportMeshButton"));
    connect(check_, &QPushButton::clicked, actions.action("mesh.check"), &QAction::trigger);
    connect(export_, &QPushButton::clicked, actions.action("mesh.export"), &QAction::trigger);
    buttons->addWidget(check_);
    buttons->addWidget(export_);
    buttons->addStretch(1);
    state_->setWordWrap(true);
    state_->setForegroundRole(QPalette::PlaceholderText);
    layout->addWidget(makeHeading(tr("Surface on screen"), page));
    layout->addWidget(counts_);
    layout->addLayout(buttons);
    layout->addSpacing(6);
    layout->addWidget(makeHeading(tr("Report"), page));
    layout->addWidget(state_);
    layout->addWidget(report_);
    layout->addStretch(1);
    scroll->setWidget(page);
    outer->addWidget(scroll);
    frameSubscription_ = session_.frameChanged().observe([this] { countsThrottle_.trigger(); });
    reportSubscription_ = session_.meshReportChanged().observe([this] { showReport(); });
    showCounts();
    showReport();
}

void MeshPanel::showCounts() {
    const auto frame = session_.frame();
    const QString none = QStringLiteral("–");
    counts_->setFacts({{tr("Isovalue"), frame ? number(frame->isovalue) : none, {}},
                       {tr("Vertices"), frame ? grouped(frame->stats.activeEdges) : none, tr("One per active edge")},
                       {tr("Triangles"), frame ? grouped(frame->stats.triangles) : none, {}}});
    export_->setEnabled(frame != nullptr);
    showReport();
}

void MeshPanel::showReport() {
    const auto frame = session_.frame();
    const auto& report = session_.meshReport();
    check_->setEnabled(frame && !session_.isCheckingMesh());
    report_->setFacts(report ? reportFacts(*report) : std::vector<Fact>{});
    if (session_.isCheckingMesh())
        state_->setText(tr("Checking…"));
    else if (!report)
        state_->setText(tr("Not checked yet."));
    else if (frame && frame->isovalue != session_.meshReportIsovalue())
        state_->setText(tr("At isovalue %1; the surface has moved since.").arg(number(session_.meshReportIsovalue())));
    else
        state_->setText(tr("At isovalue %1.").arg(number(session_.meshReportIsovalue())));
}

} // namespace isoslider::widgets
