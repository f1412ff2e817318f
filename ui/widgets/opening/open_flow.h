#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include <QObject>
#include <QString>

#include "core/volume_io/volume_reader.h"
#include "ui/model/opening/open_model.h"
#include "ui/model/session/recent_file.h"
#include "ui/model/session/session.h"

class QWidget;

namespace isoslider::widgets {

class FileDialogs;
class SettingsStore;
class VolumeDialog;

/// From a file, a folder or a name to an open volume: asks where it must, and opens at once where it need
/// not. Dialogs are children of `window`; everything given must outlive this.
class OpenFlow : public QObject {
    Q_OBJECT
public:
    /// Where what is to be opened goes.
    struct Target {
        std::function<void(model::OpenRequest)> open;
        const model::Observable<const model::OpenRequest&, const io::VolumeContents&>& choiceNeeded;
        QString title; ///< of the dialog that asks for a file
        std::function<void(const QString&)> openSession; ///< none: sessions are no files to open here
    };
    OpenFlow(Target target, const model::SessionServices& services, SettingsStore& settings, FileDialogs& dialogs,
             QWidget* window);
    ~OpenFlow() override;

    /// Asks for a file, shows it before it is opened, if the user wants that, and opens it.
    void askFile();
    /// Asks for a folder of slices; of several series, asks for one.
    void askFolder();
    /// Asks for a file and how its samples are arranged, whatever its name.
    void askRawFile();

    /// Opens a volume, an index or a folder. Asks only what has to be known: how a headerless file is
    /// arranged, and which of several volumes is meant. `isovalue`: the first one; otherwise a suggested one.
    /// `options`: what of that is known.
    void openPath(const QString& path, std::optional<AskedIsovalue> isovalue = std::nullopt,
                  const io::ReadOptions& options = {});
    /// Opens what was open before, with the choices that were made then. Asks nothing, unless the file has changed
    /// so that they are no longer there.
    void openRecent(const model::RecentFile& file);
    void openSample(const QString& name);
    void setPreviewsFirst(bool isOn);

Q_SIGNALS:
    void opening();
    void previewsFirstChanged(bool isOn);

private:
    void preview(const QString& path);
    void askRawLayout(const QString& path);
    void askChoice(const model::OpenRequest& request, const io::VolumeContents& contents);
    VolumeDialog* showDialog(std::unique_ptr<model::OpenModel> model, std::optional<AskedIsovalue> isovalue);
    void open(model::OpenRequest request);

    Target target_;
    model::VolumeAccess volumes_;
    SettingsStore& settings_;
    FileDialogs& dialogs_;
    QWidget* window_;
    std::shared_ptr<model::BackgroundJobs> jobs_; ///< of the dialogs
    model::Subscription subscription_;
};

} // namespace isoslider::widgets
