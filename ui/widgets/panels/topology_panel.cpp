#include "ui/widgets/panels/topology_panel.h"

#include <algorithm>

#include <QAction>
#include <QComboBox>
#include <QDockWidget>
#include <QEvent>
#include <QGridLayout>
#include <QHeaderView>
#include <QLabel>
#include <QProgressBar>
#include <QResizeEvent>
#include <QSignalBlocker>
#include <QSlider>
#include <QStackedWidget>
#include <QTabWidget>
#include <QTableView>
#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/jobs/latest_job.h"
#include "ui/model/session/session.h"
#include "ui/model/topology/question_model.h"
#include "ui/widgets/common/copying.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/panels/compare_page.h"
#include "ui/widgets/panels/find_page.h"
#include "ui/widgets/panels/topology_table.h"

namespace isoslider::widgets {
namespace {

constexpr int kSliderSteps = 600;
constexpr int kLeastWhatWidth = 150;
constexpr int kRowsMeasured = 200; // for the widths of columns

QString countText(const model::TopologyModel& topology) {
    const QString shown = grouped(topology.shown().size()), listed = grouped(topology.events().size());
    return topology.events().size() == topology.eventCount()
               ? TopologyPanel::tr("%1 of %2 events").arg(shown, listed)
               : TopologyPanel::tr("%1 of the %2 most notable of %3 events")
                     .arg(shown, listed, grouped(topology.eventCount()));
}

QString persistenceText(double least) {
    return least > 0.0 ? TopologyPanel::tr("persistence ≥ %1").arg(fromStd(model::valueText(least, 3)))
                       : TopologyPanel::tr("any persistence");
}

} // namespace

TopologyPanel::TopologyPanel(model::Session& session, const ActionRegistry& actions, QWidget* parent)
    : QWidget(parent),
      session_(session),
      question_(std::make_unique<model::QuestionModel>(
          session.topology(), std::make_shared<model::BackgroundJobs>(session.services().postToMain))),
      table_(new TopologyTable(session.topology(), this)),
      sorted_(new TopologySorting(*table_, this)),
      pages_(new QStackedWidget(this)) {
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->addWidget(pages_);
    pages_->addWidget(makeStatePage());
    tabs_ = new QTabWidget(this);
    tabs_->setObjectName(QStringLiteral("topologyTabs"));
    tabs_->setDocumentMode(true);
    find_ = new FindPage(session_, *question_, this);
    auto* compare = new ComparePage(session_, actions, this);
    tabs_->addTab(makeEventsPage(), tr("Events"));
    tabs_->addTab(find_, tr("Isovalues"));
    tabs_->addTab(compare, tr("Compare"));
    pages_->addWidget(tabs_);
    connect(find_, &FindPage::isovaluePicked, this, &TopologyPanel::isovaluePicked);
    connect(compare, &ComparePage::isovaluePicked, this, &TopologyPanel::isovaluePicked);
    table_->setPalette(palette(), devicePixelRatioF());
    auto& topology = session_.topology();
    topologySubscription_ = topology.changed().observe([this] { showTopology(); });
    chosenSubscription_ = topology.chosenChanged().observe([this] { selectChosen(); });
    datasetSubscription_ = session_.datasetChanged().observe([this] { showProgress(); });
    jobsSubscription_ = session_.jobs().observe([this] { showProgress(); });
    showTopology();
}

TopologyPanel::~TopologyPanel() = default;

void TopologyPanel::raiseDock() {
    if (auto* dock = qobject_cast<QDockWidget*>(parentWidget())) {
        dock->show();
        dock->raise();
    }
}

void TopologyPanel::showSearch() {
    raiseDock();
    tabs_->setCurrentIndex(1);
    find_->focusValue();
}

void TopologyPanel::showComparison() {
    raiseDock();
    tabs_->setCurrentIndex(2);
}

QWidget* TopologyPanel::makeStatePage() {
    auto* page = new QWidget(this);
    auto* layout = new QVBoxLayout(page);
    layout->setContentsMargins(10, 8, 10, 8);
    state_ = new QLabel(page);
    state_->setObjectName(QStringLiteral("topologyState"));
    state_->setTextFormat(Qt::PlainText); // of an error names files
    state_->setWordWrap(true);
    makeQuiet(state_);
    progress_ = new QProgressBar(page);
    progress_->setTextVisible(false);
    progress_->setFixedHeight(8);
    layout->addWidget(state_);
    layout->addWidget(progress_);
    layout->addStretch(1);
    return page;
}

QWidget* TopologyPanel::makeEventsPage() {
    auto* page = new QWidget(this);
    auto* layout = new QGridLayout(page);
    layout->setContentsMargins(10, 8, 10, 8);
    layout->setVerticalSpacing(6);
    layout->setColumnStretch(1, 1);
    layout->setColumnMinimumWidth(1, 40);
    filter_ = new QComboBox(page);
    filter_->setObjectName(QStringLiteral("topologyFilter"));
    for (int filter = 0; filter < model::kEventFilters; ++filter)
        filter_->addItem(QLatin1String(model::nameOf(static_cast<model::EventFilter>(filter))));
    persistence_ = new QSlider(Qt::Horizontal, page);
    persistence_->setObjectName(QStringLiteral("topologyPersistence"));
    persistence_->setRange(0, kSliderSteps);
    persistence_->setPageStep(kSliderSteps / 20);
    persistence_->setToolTip(
        tr("Events of less persistence are neither listed here nor marked at the histogram. The scale is logarithmic"));
    persistence_->setAccessibleName(tr("Least persistence"));
    persistence_->setMinimumWidth(40);
    filter_->setSizeAdjustPolicy(QComboBox::AdjustToContents);
    filter_->setMinimumWidth(60); // gives way in a narrow panel
    filter_->setAccessibleName(tr("Kind of event"));
    persistenceValue_ = new ElidedLabel(page);
    persistenceValue_->setObjectName(QStringLiteral("topologyLeastPersistence"));
    count_ = new ElidedLabel(page);
    count_->setObjectName(QStringLiteral("topologyCount"));
    makeQuiet(count_);
    noEvents_ =
        new QLabel(tr("This volume has more events than fit into memory. Pieces, tunnels and voids were counted "
                      "at some thousand isovalues instead: the curves, Isovalues and Compare show them. Events "
                      "and persistence are added when the index is opened where there is more memory."),
                   page);
    noEvents_->setObjectName(QStringLiteral("topologyNoEvents"));
    noEvents_->setWordWrap(true);
    noEvents_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
    makeQuiet(noEvents_);
    layout->addWidget(noEvents_, 2, 0, 1, 3);
    layout->addWidget(filter_, 0, 0);
    layout->addWidget(persistence_, 0, 1);
    layout->addWidget(persistenceValue_, 0, 2);
    layout->addWidget(count_, 1, 0, 1, 3);
    makeTable(page);
    layout->addWidget(view_, 2, 0, 1, 3);
    layout->setRowStretch(2, 1);
    auto& topology = session_.topology();
    connect(filter_, &QComboBox::currentIndexChanged, this,
            [&topology](int index) { topology.setEventFilter(static_cast<model::EventFilter>(index)); });
    connect(persistence_, &QSlider::valueChanged, this, [&topology](int step) {
        topology.setLeastPersistence(topology.persistenceAt(static_cast<double>(step) / kSliderSteps));
    });
    return page;
}

void TopologyPanel::makeTable(QWidget* page) {
    view_ = new QTableView(page);
    view_->setObjectName(QStringLiteral("topologyTable"));
    view_->setAccessibleName(tr("Events of the topology"));
    view_->setModel(sorted_);
    makePlain(*view_);
    view_->setSelectionBehavior(QAbstractItemView::SelectRows);
    view_->setSelectionMode(QAbstractItemView::SingleSelection);
    view_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    view_->setHorizontalScrollMode(QAbstractItemView::ScrollPerPixel);
    view_->setMinimumSize(80, 40);
    // Every row alike: then none is measured.
    view_->verticalHeader()->setSectionResizeMode(QHeaderView::Fixed);
    view_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
    auto* header = view_->horizontalHeader();
    header->setResizeContentsPrecision(kRowsMeasured);
    header->setMinimumSectionSize(40);
    view_->setSortingEnabled(true);
    view_->sortByColumn(TopologyTable::Isovalue, Qt::AscendingOrder);
    view_->viewport()->installEventFilter(this);
    connect(header, &QHeaderView::sortIndicatorChanged, this, &TopologyPanel::fitColumns);
    connect(view_, &QTableView::clicked, this, &TopologyPanel::pick);
    connect(view_, &QTableView::activated, this, &TopologyPanel::pick);
    addMenuActions();
}

// For the row under the pointer, which the right button has made the current one.
void TopologyPanel::addMenuActions() {
    auto* go = new QAction(tr("&Go to Event"), view_);
    go->setObjectName(QStringLiteral("topologyGo"));
    connect(go, &QAction::triggered, this, [this] { pick(view_->currentIndex()); });
    auto* hide = new QAction(tr("&Hide Less Persistent Events"), view_);
    hide->setObjectName(QStringLiteral("topologyHideLess"));
    connect(hide, &QAction::triggered, this, [this] {
        if (const QModelIndex row = sorted_->mapToSource(view_->currentIndex()); row.isValid()) {
            auto& topology = session_.topology();
            topology.setLeastPersistence(topology.persistenceOf(table_->eventOf(row.row())));
        }
    });
    view_->addAction(go);
    view_->addAction(hide);
    offerCopying(*view_);
}

void TopologyPanel::pick(const QModelIndex& index) {
    const QModelIndex row = sorted_->mapToSource(index);
    if (row.isValid())
        Q_EMIT eventPicked(table_->eventOf(row.row()));
}

void TopologyPanel::showTopology() {
    table_->reload();
    showProgress();
    showFilters();
    fitColumns();
    selectChosen();
}

void TopologyPanel::showProgress() {
    const auto& topology = session_.topology();
    const bool hasCounts = topology.state() == model::TopologyState::Ready && topology.hasCounts();
    pages_->setCurrentIndex(hasCounts ? 1 : 0);
    if (hasCounts)
        return;
    const model::JobEntry* job = session_.analysing();
    progress_->setVisible(topology.state() == model::TopologyState::Analysing);
    const bool isKnown = job != nullptr && job->fraction >= 0.0;
    progress_->setRange(0, isKnown ? 1000 : 0);
    if (isKnown)
        progress_->setValue(qRound(job->fraction * 1000.0));
    switch (topology.state()) {
        case model::TopologyState::None:
            state_->setText(session_.dataset() == nullptr ? tr("No volume is open.")
                            : session_.indexState() == model::IndexState::Building
                                ? tr("The index is being built; then the topology is analysed.")
                                : tr("The topology is not known; it is analysed once there is an index."));
            break;
        case model::TopologyState::Analysing:
            state_->setText(isKnown ? tr("Analysing the topology, %1 %…").arg(qRound(job->fraction * 100.0))
                                    : tr("Analysing the topology…"));
            break;
        case model::TopologyState::Failed:
            state_->setText(tr("The topology could not be analysed: %1").arg(fromStd(topology.problem())));
            break;
        case model::TopologyState::Ready:
            state_->setText(tr("The surface has the same topology at every isovalue: there are no events."));
            break;
    }
}

void TopologyPanel::showFilters() {
    const auto& topology = session_.topology();
    const QSignalBlocker noFilter(filter_), noSlider(persistence_);
    noEvents_->setVisible(!topology.hasEvents());
    for (QWidget* part :
         {static_cast<QWidget*>(filter_), static_cast<QWidget*>(persistence_), static_cast<QWidget*>(persistenceValue_),
          static_cast<QWidget*>(count_), static_cast<QWidget*>(view_)})
        part->setVisible(topology.hasEvents());
    filter_->setCurrentIndex(static_cast<int>(topology.eventFilter()));
    const double least = topology.leastPersistence();
    persistence_->setValue(qRound(topology.fractionOf(least) * kSliderSteps));
    persistence_->setEnabled(topology.greatestPersistence() > 0.0);
    persistenceValue_->setFullText(persistenceText(least));
    count_->setFullText(topology.shown().empty() ? tr("%1: none passes these filters").arg(countText(topology))
                                                 : countText(topology));
}

void TopologyPanel::selectChosen() {
    const auto chosen = session_.topology().chosen();
    const auto row = chosen ? table_->rowOf(*chosen) : std::nullopt;
    if (!row)
        return view_->clearSelection();
    const QModelIndex index = sorted_->mapFromSource(table_->index(*row, TopologyTable::Isovalue));
    if (view_->selectionModel()->isRowSelected(index.row(), {}))
        return;
    view_->selectionModel()->setCurrentIndex(index, QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
    view_->scrollTo(index);
}

// What happens gets the room that is left by as many numbers as are in view whole; the others are scrolled to.
void TopologyPanel::fitColumns() {
    auto* header = view_->horizontalHeader();
    int room = view_->viewport()->width() - kLeastWhatWidth;
    bool isInView = true;
    for (int column = 0; column < TopologyTable::kColumns; ++column) {
        if (column == TopologyTable::What)
            continue;
        header->setSortIndicatorShown(column == header->sortIndicatorSection()); // no room for an arrow elsewhere
        view_->resizeColumnToContents(column);
        isInView = isInView && view_->columnWidth(column) <= room;
        room -= isInView ? view_->columnWidth(column) : 0;
    }
    header->setSortIndicatorShown(true);
    view_->setColumnWidth(TopologyTable::What, kLeastWhatWidth + std::max(room, 0));
}

// Its scroll bar comes and goes too.
bool TopologyPanel::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::Resize && watched == view_->viewport() &&
        static_cast<QResizeEvent*>(event)->size().width() != static_cast<QResizeEvent*>(event)->oldSize().width())
        fitColumns();
    return QWidget::eventFilter(watched, event);
}

void TopologyPanel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange && view_ != nullptr)
        table_->setPalette(palette(), devicePixelRatioF());
}

} // namespace isoslider::widgets
