#include "ui/widgets/window/picture_flow.h"

#include <filesystem>
#include <utility>

#include <QDir>
#include <QFileInfo>
#include <QPointer>

#include "ui/model/session/read_files.h"
#include "ui/model/session/session.h"
#include "ui/widgets/opening/file_dialogs.h"
#include "ui/widgets/viewport/picture_file.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/message_bar.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {

PictureFlow::PictureFlow(model::Session& session, const Parts& parts, QWidget* window)
    : QObject(window), session_(session), parts_(parts), window_(window) {}

PictureChoice PictureFlow::lastChoice() const {
    PictureChoice choice;
    choice.scale = parts_.settings.text("picture/scale").toInt(); // 0 of "width"
    choice.width = static_cast<int>(parts_.settings.number("picture/width"));
    choice.isTransparent = parts_.settings.boolean("picture/transparent");
    return choice;
}

void PictureFlow::remember(const PictureChoice& choice) {
    parts_.settings.set("picture/scale", choice.scale > 0 ? QString::number(choice.scale) : QStringLiteral("width"));
    parts_.settings.set("picture/width", static_cast<double>(choice.width));
    parts_.settings.set("picture/transparent", choice.isTransparent);
}

void PictureFlow::ask() {
    if (parts_.host.viewport() == nullptr || session_.dataset() == nullptr)
        return;
    parts_.dialogs.askPicture(window_, lastChoice(), parts_.host.pictureSize(), [this](const PictureChoice& choice) {
        remember(choice);
        askName(choice);
    });
}

void PictureFlow::askName(const PictureChoice& choice) {
    if (session_.dataset() == nullptr) // closed meanwhile
        return;
    const QString stem = QString::fromStdString(model::fileStem(*session_.dataset()));
    parts_.dialogs.askSave(window_, tr("Save View as Image"), QDir::home().filePath(stem + QStringLiteral(".png")),
                           tr("PNG image (*.png)"), [this, choice](const QString& path) { save(choice, path); });
}

// A large surface may take seconds to be drawn whole: a job among the others, which can be cancelled.
void PictureFlow::save(const PictureChoice& choice, const QString& path) {
    if (parts_.host.viewport() == nullptr || session_.dataset() == nullptr)
        return;
    auto ordered = parts_.host.orderPicture(choice);
    if (ordered.scene == nullptr)
        return;
    session_.runner().run<bool>(
        "Save " + QFileInfo(path).fileName().toStdString(),
        [ordered = std::move(ordered), file = std::filesystem::path(path.toStdU16String()),
         read = model::ReadFiles({session_.dataset(), session_.secondVolume().dataset()})](
            const JobControl& job) -> Result<bool> {
            ISO_TRY(read.checkNotReplacedBy(file));
            ISO_TRY(writeOrdered(ordered, file, job));
            return true;
        },
        [flow = QPointer(this), path](const Result<bool>& saved) {
            using Severity = model::Notice::Severity;
            if (flow == nullptr || saved.isCancelled())
                return;
            if (saved.isOk())
                flow->parts_.messages.showNotice({Severity::Information, tr("Image saved").toStdString(),
                                                  QDir::toNativeSeparators(path).toStdString()});
            else
                flow->parts_.messages.showNotice({Severity::Error, tr("The image could not be saved").toStdString(),
                                                  saved.error().line(), saved.error().code});
        });
}

} // namespace isoslider::widgets
