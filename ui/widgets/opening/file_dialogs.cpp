#include "ui/widgets/opening/file_dialogs.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QRegularExpression>

#include "ui/widgets/viewport/picture_dialog.h"

namespace isoslider::widgets {
namespace {

/// "*.ply" of "Stanford PLY (*.ply)", without the star.
QString firstSuffix(const QString& filter) {
    static const QRegularExpression pattern(QStringLiteral("\\*(\\.[A-Za-z0-9]+)"));
    return pattern.match(filter).captured(1);
}

} // namespace

void PlatformFileDialogs::askOpen(QWidget* parent, const QString& title, const QString& folder, const QString& filters,
                                  Chosen chosen) {
    auto* dialog = new QFileDialog(parent, title, folder, filters);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setFileMode(QFileDialog::ExistingFile);
    QObject::connect(dialog, &QFileDialog::fileSelected, parent, std::move(chosen));
    dialog->open();
}

void PlatformFileDialogs::askFolder(QWidget* parent, const QString& title, const QString& folder, Chosen chosen) {
    auto* dialog = new QFileDialog(parent, title, folder);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setFileMode(QFileDialog::Directory);
    dialog->setOption(QFileDialog::ShowDirsOnly);
    QObject::connect(dialog, &QFileDialog::fileSelected, parent, std::move(chosen));
    dialog->open();
}

void PlatformFileDialogs::askSave(QWidget* parent, const QString& title, const QString& suggestion,
                                  const QString& filters, Chosen chosen) {
    const QFileInfo suggested(suggestion);
    auto* dialog = new QFileDialog(parent, title, suggested.path(), filters);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setAcceptMode(QFileDialog::AcceptSave);
    dialog->setFileMode(QFileDialog::AnyFile);
    dialog->selectFile(suggested.fileName());
    const auto followFilter = [dialog](const QString& filter) { dialog->setDefaultSuffix(firstSuffix(filter).mid(1)); };
    followFilter(dialog->selectedNameFilter());
    QObject::connect(dialog, &QFileDialog::filterSelected, dialog, followFilter);
    QObject::connect(dialog, &QFileDialog::fileSelected, parent, std::move(chosen));
    dialog->open();
}

void PlatformFileDialogs::askPicture(QWidget* parent, const PictureChoice& last, QSize view,
                                     std::function<void(const PictureChoice&)> chosen) {
    auto* dialog = new PictureDialog(last, view, parent);
    QObject::connect(dialog, &PictureDialog::chosen, parent, std::move(chosen));
    dialog->open();
}

} // namespace isoslider::widgets
