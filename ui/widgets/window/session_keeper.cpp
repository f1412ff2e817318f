#include "ui/widgets/window/session_keeper.h"

#include <utility>

#include <QAction>
#include <QDateTime>
#include <QDir>
#include <QFileInfo>
#include <QLocale>

#include "core/base/folders.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/pieces/piece_places.h"
#include "ui/model/session/session.h"
#include "ui/model/slices/slice_model.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/opening/file_dialogs.h"
#include "ui/widgets/opening/file_filters.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::widgets {
namespace fs = std::filesystem;
namespace {

using Severity = model::Notice::Severity;

constexpr std::size_t kMostProblemsShown = 4;

QString textOf(const fs::path& path) { return QString::fromStdU16String(path.u16string()); }
fs::path pathOf(const QString& text) { return fs::path(text.toStdU16String()); }

QString nameOf(const model::SavedSession& saved) {
    return saved.volume.empty() ? QString::fromStdString(saved.sampleName) : textOf(saved.volume.filename());
}

} // namespace

SessionKeeper::SessionKeeper(model::Session& session, ViewportHost& host, model::SliceModel& slices,
                             const ActionRegistry& actions, FileDialogs& dialogs, MessageBar& messageBar,
                             MessageBar& recoveryBar, QWidget* window)
    : QObject(window),
      session_(session),
      host_(host),
      slices_(slices),
      actions_(actions),
      dialogs_(dialogs),
      messageBar_(messageBar),
      recoveryBar_(recoveryBar),
      window_(window),
      jobs_(std::make_shared<model::BackgroundJobs>(session.services().postToMain)),
      saving_(jobs_) {
    timer_.setSingleShot(true);
    connect(&timer_, &QTimer::timeout, this, &SessionKeeper::autosave);
    subscriptions_.push_back(session_.datasetChanged().observe([this] { noteChange(); }));
    subscriptions_.push_back(session_.frameChanged().observe([this] { showView(); }));
    if (host_.viewport() != nullptr)
        connect(host_.viewport(), &ViewportWidget::cameraChanged, this, &SessionKeeper::noteChange);
    subscriptions_.push_back(host_.viewState().observe([this] { noteChange(); }));
    subscriptions_.push_back(session_.detail().observe([this] { noteChange(); }));
    subscriptions_.push_back(session_.isovalue().observe([this] { noteChange(); })); // its reference
    subscriptions_.push_back(session_.surfaces().observe([this] { noteChange(); }));
    subscriptions_.push_back(session_.secondVolume().changed().observe([this] { noteChange(); }));
    subscriptions_.push_back(session_.secondVolume().surfaces().observe([this] { noteChange(); }));
    subscriptions_.push_back(session_.histogramOptions().observe([this] { noteChange(); }));
    subscriptions_.push_back(slices_.observe([this] { noteChange(); }));
}

SessionKeeper::~SessionKeeper() {
    saving_.cancel();
    if (slot_)
        slot_->discard(); // the program ends as it ought to
}

model::SavedSession SessionKeeper::capture() const {
    model::SavedSession saved;
    const auto* dataset = session_.dataset();
    if (dataset == nullptr)
        return saved;
    std::error_code ignored;
    if (!dataset->path.empty())
        saved.volume = fs::absolute(dataset->path, ignored).lexically_normal();
    saved.sampleName = dataset->sampleName;
    saved.readOptions = dataset->readOptions;
    saved.isovalue = session_.isovalue().requested();
    saved.surfaces = session_.surfaces().list();
    saved.second = session_.secondVolume().state();
    saved.reference = session_.isovalue().reference();
    saved.error = session_.detail().error();
    if (host_.viewport() != nullptr)
        saved.camera = host_.viewport()->camera().pose();
    saved.view = host_.viewState().options();
    for (model::ListedSurface& surface : saved.surfaces.surfaces)
        surface.hiddenPieces = model::awaited(surface.hiddenPieces, session_.piecesOf(surface.id).get());
    if (const auto* active = saved.surfaces.find(saved.surfaces.active))
        saved.view->pieces.hiddenPieces() = active->hiddenPieces;
    saved.histogram = session_.histogramOptions().options();
    if (plot_ != nullptr)
        saved.histogramRange = plot_->chosenRange();
    saved.slices = slices_.options();
    return saved;
}

void SessionKeeper::setPlot(HistogramPlot& plot) {
    plot_ = &plot;
    connect(&plot, &HistogramPlot::viewChanged, this, &SessionKeeper::noteChange);
}

void SessionKeeper::askSave() {
    const auto* dataset = session_.dataset();
    if (dataset == nullptr)
        return;
    const QString stem = QString::fromStdString(model::fileStem(*dataset));
    const QDir folder = dataset->path.empty() ? QDir::home() : QFileInfo(textOf(dataset->path)).absoluteDir();
    const QString proposed = file_.isEmpty() ? folder.filePath(stem + QStringLiteral(".isosession")) : file_;
    dialogs_.askSave(window_, tr("Save Session"), proposed, sessionFilters(),
                     [this, saved = capture()](const QString& path) { save(saved, path); });
}

void SessionKeeper::save(const model::SavedSession& saved, const QString& path) {
    jobs_->runner().run<bool>(
        "Save session",
        [saved, path](const JobControl&) -> Result<bool> {
            ISO_TRY(model::writeSession(saved, pathOf(path)));
            return true;
        },
        [this, path, of = session_.datasetGeneration()](const Result<bool>& written) {
            if (written.isOk() && of == session_.datasetGeneration())
                file_ = path;
            if (written.isOk())
                messageBar_.showNotice({Severity::Information, tr("Session saved").toStdString(),
                                        QDir::toNativeSeparators(path).toStdString()});
            else
                messageBar_.showNotice({Severity::Error, tr("The session was not saved").toStdString(),
                                        written.error().line(), written.error().code});
        });
}

void SessionKeeper::askOpen() {
    dialogs_.askOpen(window_, tr("Open Session"), {}, sessionFilters(), [this](const QString& path) { open(path); });
}

void SessionKeeper::open(const QString& path) {
    auto read = model::readSession(pathOf(path));
    if (!read.isOk())
        return session_.post({Severity::Error, tr("The session could not be opened").toStdString(), read.error().line(),
                              read.error().code});
    restore({std::move(read.value().session), QFileInfo(path).fileName(), QFileInfo(path).absoluteFilePath()},
            std::move(read.value().problems));
}

void SessionKeeper::restore(const Restored& restored, std::vector<std::string> problems) {
    const model::SavedSession& saved = restored.saved;
    if (!saved.volume.empty() && !isPresent(saved.volume))
        return askWhereVolumeIs(restored, problems);
    Q_EMIT opening();
    if (saved.hasVolume()) {
        model::OpenRequest request;
        request.path = saved.volume;
        request.sampleName = saved.sampleName;
        request.readOptions = saved.readOptions;
        request.isovalue = saved.isovalue;
        request.asksForChoice = true;
        pending_ = restored;
        session_.open(std::move(request));
    }
    tellProblems(restored.name, problems);
}

void SessionKeeper::askWhereVolumeIs(const Restored& restored, const std::vector<std::string>& problems) {
    const model::SavedSession& saved = restored.saved;
    const auto locate = [this, restored, problems] {
        dialogs_.askOpen(window_, tr("Where is %1?").arg(nameOf(restored.saved)),
                         textOf(restored.saved.volume.parent_path()), {},
                         [this, restored, problems](const QString& path) {
                             auto found = restored;
                             found.saved.volume = pathOf(path);
                             restore(found, problems);
                         });
    };
    const model::Notice notice{
        Severity::Error, tr("The volume of %1 is not where it was").arg(restored.name).toStdString(),
        QDir::toNativeSeparators(textOf(saved.volume)).toStdString() + ": no such file", ErrorCode::NotFound};
    session_.post(notice); // for those that watch without a user; the bar shows the offer
    messageBar_.showOffer(notice, {{tr("Locate…"), locate}});
}

// The view has been set for a volume that is new by now: it hears of frames before this. Then the one that was kept
// takes its place.
void SessionKeeper::showView() {
    const bool isNew = session_.dataset() != nullptr &&
                       std::exchange(shownDataset_, session_.datasetGeneration()) != session_.datasetGeneration();
    if (isNew)
        file_.clear();
    if (isNew && pending_) {
        const Restored restored = *std::exchange(pending_, std::nullopt);
        const model::SavedSession& saved = restored.saved;
        const auto* dataset = session_.dataset();
        if (dataset->path != saved.volume || dataset->sampleName != saved.sampleName)
            return noteChange(); // another volume was opened meanwhile
        file_ = restored.file;
        session_.isovalue().setReference(saved.reference);
        session_.surfaces().restore(saved.surfaces);
        session_.secondVolume().setState(saved.second);
        if (saved.error)
            session_.detail().setError(*saved.error);
        if (saved.histogram)
            session_.histogramOptions().setOptions(*saved.histogram);
        if (plot_ != nullptr && saved.histogramRange)
            plot_->showRange(*saved.histogramRange);
        if (saved.slices)
            slices_.setOptions(*saved.slices);
        if (saved.view) {
            auto view = *saved.view; // with what the active surface hides
            if (!saved.hasStage)
                view.stage = host_.viewState().options().stage;
            if (!saved.hasColouring)
                view.colouring = host_.viewState().options().colouring;
            host_.viewState().setOptions(view);
        }
        if (saved.camera) {
            actions_.action("view.perspective")->setChecked(saved.camera->isPerspective);
            if (host_.viewport() != nullptr)
                host_.viewport()->changeCamera([&](model::Camera& camera) { camera.setPose(*saved.camera); });
        }
    }
    noteChange();
}

void SessionKeeper::tellProblems(const QString& name, const std::vector<std::string>& problems) {
    if (problems.empty())
        return;
    QStringList lines;
    for (const auto& problem : problems)
        lines << QString::fromStdString(problem);
    const auto more = lines.size() - static_cast<qsizetype>(kMostProblemsShown);
    lines = lines.mid(0, kMostProblemsShown);
    if (more > 0)
        lines << tr("and %1 more").arg(more);
    messageBar_.showNotice({Severity::Error, tr("Not all of %1 could be used").arg(name).toStdString(),
                            lines.join(QStringLiteral("\n")).toStdString()});
}

void SessionKeeper::keepIn(const fs::path& folder, std::chrono::milliseconds interval) {
    lost_ = model::SessionSlot::findLost(folder);
    auto slot = model::SessionSlot::create(folder);
    if (slot.isOk())
        slot_ = std::move(slot).value();
    else
        messageBar_.showNotice({Severity::Error,
                                tr("This session cannot be restored should the program fail").toStdString(),
                                slot.error().line(), slot.error().code});
    timer_.setInterval(interval);
    offerLost();
    noteChange();
}

void SessionKeeper::noteChange() {
    if (slot_ && !timer_.isActive())
        timer_.start();
}

// The disk may take its time: it is a worker that waits for it.
void SessionKeeper::autosave() {
    if (session_.isLoading())
        return noteChange();
    saving_.start(
        "Keep the session",
        [slot = slot_, saved = capture()](const JobControl&) -> Result<bool> {
            if (saved.hasVolume())
                ISO_TRY(slot->save(saved));
            return true;
        },
        [](Result<bool>) {}); // what cannot be kept now may be the next time; nobody is bothered
}

void SessionKeeper::offerLost() {
    model::SavedSession saved;
    while (!lost_.empty() && !saved.hasVolume()) {
        if (const auto read = lost_.front()->read(); read.isOk())
            saved = read.value().session;
        if (!saved.hasVolume()) {
            lost_.front()->discard();
            lost_.erase(lost_.begin());
        }
    }
    recoveryBar_.hide();
    if (lost_.empty())
        return;
    const QDateTime time = QFileInfo(textOf(lost_.front()->path())).lastModified();
    const QString isovalue = saved.isovalue
                                 ? tr(", isovalue %1").arg(QString::fromStdString(model::valueText(*saved.isovalue, 6)))
                                 : QString();
    const auto forget = [this] {
        lost_.front()->discard();
        lost_.erase(lost_.begin());
        offerLost();
    };
    recoveryBar_.showOffer({Severity::Information, tr("ISOSLIDER did not end properly").toStdString(),
                            tr("%1%2, as of %3")
                                .arg(nameOf(saved), isovalue, QLocale().toString(time, QLocale::ShortFormat))
                                .toStdString()},
                           {{tr("Restore"),
                             [this, saved, forget] {
                                 restore({saved, tr("the session"), {}}, {});
                                 forget();
                             }},
                            {tr("Discard"), forget}});
}

} // namespace isoslider::widgets
