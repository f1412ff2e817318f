#include "ui/widgets/opening/open_flow.h"

#include <utility>

#include <QDir>
#include <QFileInfo>

#include "ui/model/opening/raw_guess.h"
#include "ui/model/session/saved_session.h"
#include "ui/widgets/opening/file_dialogs.h"
#include "ui/widgets/opening/file_filters.h"
#include "ui/widgets/opening/raw_import_dialog.h"
#include "ui/widgets/opening/volume_dialog.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

constexpr const char* kFolderSetting = "files/openFolder";
constexpr const char* kPreviewSetting = "files/previewsFirst";

std::filesystem::path absolutePath(const QString& path) {
    return std::filesystem::path(QDir::cleanPath(QFileInfo(path).absoluteFilePath()).toStdU16String());
}

bool isHeaderlessFile(const QString& path) {
    return model::isHeaderlessSuffix(path.toStdString()) && QFileInfo(path).isFile();
}

} // namespace

OpenFlow::OpenFlow(Target target, const model::SessionServices& services, SettingsStore& settings, FileDialogs& dialogs,
                   QWidget* window)
    : QObject(window),
      target_(std::move(target)),
      volumes_(services.volumes),
      settings_(settings),
      dialogs_(dialogs),
      window_(window),
      jobs_(std::make_shared<model::BackgroundJobs>(services.postToMain)) {
    subscription_ =
        target_.choiceNeeded.observe([this](const model::OpenRequest& request, const io::VolumeContents& contents) {
            askChoice(request, contents);
        });
}

OpenFlow::~OpenFlow() = default;

void OpenFlow::askFile() {
    dialogs_.askOpen(window_, target_.title, settings_.text(kFolderSetting),
                     target_.openSession ? volumeAndSessionFilters() : volumeFilters(), [this](const QString& path) {
                         settings_.set(kFolderSetting, QFileInfo(path).path());
                         preview(path);
                     });
}

void OpenFlow::askFolder() {
    dialogs_.askFolder(window_, tr("Open Folder of Slices"), settings_.text(kFolderSetting),
                       [this](const QString& path) {
                           settings_.set(kFolderSetting, QFileInfo(path).path());
                           preview(path);
                       });
}

void OpenFlow::askRawFile() {
    dialogs_.askOpen(window_, tr("Import Raw Samples"), settings_.text(kFolderSetting), rawFilters(),
                     [this](const QString& path) {
                         settings_.set(kFolderSetting, QFileInfo(path).path());
                         askRawLayout(path);
                     });
}

void OpenFlow::preview(const QString& path) {
    const auto file = absolutePath(path);
    if (target_.openSession && model::isSessionFile(file))
        return target_.openSession(path);
    if (model::isIndexFile(file) || isHeaderlessFile(path) || !settings_.boolean(kPreviewSetting))
        return openPath(path);
    auto* dialog = showDialog(std::make_unique<model::OpenModel>(file, jobs_, volumes_), std::nullopt);
    dialog->offerPreviewsFirst(true);
    connect(dialog, &VolumeDialog::previewsFirstToggled, this, &OpenFlow::setPreviewsFirst);
}

void OpenFlow::openPath(const QString& path, std::optional<AskedIsovalue> isovalue, const io::ReadOptions& options) {
    if (isHeaderlessFile(path))
        return askRawLayout(path);
    model::OpenRequest request;
    request.path = absolutePath(path);
    request.isovalue = isovalue;
    request.readOptions = options;
    request.asksForChoice = true;
    open(std::move(request));
}

void OpenFlow::openRecent(const model::RecentFile& file) {
    if (!file.hasChoices())
        return openPath(QString::fromStdU16String(file.path.u16string()));
    model::OpenRequest request;
    request.path = file.path;
    request.readOptions = file.options;
    request.asksForChoice = !file.options.raw;
    open(std::move(request));
}

void OpenFlow::openSample(const QString& name) {
    model::OpenRequest request;
    request.sampleName = name.toStdString();
    open(std::move(request));
}

void OpenFlow::setPreviewsFirst(bool isOn) {
    if (settings_.boolean(kPreviewSetting) == isOn)
        return;
    settings_.set(kPreviewSetting, isOn);
    Q_EMIT previewsFirstChanged(isOn);
}

void OpenFlow::open(model::OpenRequest request) {
    Q_EMIT opening();
    target_.open(std::move(request));
}

void OpenFlow::askRawLayout(const QString& path) {
    const QFileInfo file(path);
    auto* dialog =
        new RawImportDialog(std::make_unique<model::RawImportModel>(
                                absolutePath(path), static_cast<std::uint64_t>(file.size()), jobs_, volumes_),
                            window_);
    connect(dialog, &RawImportDialog::openRequested, this,
            [this](const QString& chosen, const io::ReadOptions& options) {
                model::OpenRequest request;
                request.path = std::filesystem::path(chosen.toStdU16String());
                request.readOptions = options;
                open(std::move(request));
            });
    dialog->open();
}

void OpenFlow::askChoice(const model::OpenRequest& request, const io::VolumeContents& contents) {
    showDialog(std::make_unique<model::OpenModel>(request.path, contents, jobs_, volumes_), request.isovalue);
}

VolumeDialog* OpenFlow::showDialog(std::unique_ptr<model::OpenModel> model, std::optional<AskedIsovalue> isovalue) {
    auto* dialog = new VolumeDialog(std::move(model), window_);
    connect(dialog, &VolumeDialog::openRequested, this,
            [this, isovalue](const QString& chosen, const io::ReadOptions& options) {
                model::OpenRequest request;
                request.path = std::filesystem::path(chosen.toStdU16String());
                request.readOptions = options;
                request.isovalue = isovalue;
                open(std::move(request));
            });
    dialog->open();
    return dialog;
}

} // namespace isoslider::widgets
