#include "ui/widgets/window/export_flow.h"

#include <filesystem>

#include <QAction>
#include <QDir>
#include <QFileInfo>
#include <QWidget>

#include "ui/model/surface/view_state.h"
#include "ui/widgets/opening/file_dialogs.h"
#include "ui/widgets/opening/file_filters.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

std::filesystem::path toPath(const QString& path) { return {path.toStdU16String()}; }

} // namespace

ExportFlow::ExportFlow(model::Session& session, const Parts& parts, QWidget* window)
    : QObject(window), session_(session), parts_(parts), window_(window) {
    connect(parts_.actions.action("mesh.export"), &QAction::triggered, this, [this] { askWhole(); });
    connect(parts_.actions.action("pieces.exportShown"), &QAction::triggered, this, [this] { askShown(); });
    connect(parts_.actions.action("pieces.exportSelected"), &QAction::triggered, this, [this] { askSelected(); });
    connect(parts_.actions.action("clip.exportClosed"), &QAction::triggered, this, [this] { askClosed(); });
    frameSubscription_ = session_.frameChanged().observe([this] { showWhatIsPossible(); });
    optionsSubscription_ = parts_.viewState.observe([this] { showWhatIsPossible(); });
    showWhatIsPossible();
}

void ExportFlow::askWhole() {
    if (session_.dataset() == nullptr || session_.refusesExport())
        return;
    const auto& surfaces = session_.surfaces();
    const QString title = surfaces.canRemove() && surfaces.active() != nullptr
                              ? tr("Export Mesh of %1").arg(QString::fromStdString(surfaces.active()->name))
                              : tr("Export Mesh");
    parts_.dialogs.askSave(window_, title, suggestedPath(QString()), meshFilters(),
                           [this, of = session_.datasetGeneration()](const QString& path) {
                               rememberFolder(path);
                               session_.exportMesh(toPath(path), of);
                           });
}

void ExportFlow::askShown() {
    const auto& options = parts_.viewState.options();
    model::Session::ExportPart part;
    part.clipping = options.clipping;
    if (options.pieces.hidesAny()) {
        part.pieces = piecesOf(Choice::Shown);
        if (!part.pieces || part.pieces->kept.empty())
            return;
    }
    ask(tr("Export What Is Shown"), QStringLiteral("_shown"), part);
}

void ExportFlow::askSelected() {
    model::Session::ExportPart part;
    part.pieces = piecesOf(Choice::Selected);
    if (part.pieces && !part.pieces->kept.empty())
        ask(tr("Export Selected Piece"), QStringLiteral("_piece"), part);
}

void ExportFlow::askClosed() {
    model::Session::ExportPart part;
    part.clipping = parts_.viewState.options().clipping;
    part.sides = model::CropSides::Closed;
    ask(tr("Export Closed Crop"), QStringLiteral("_closed"), part);
}

// What is written is what is on screen now, not when the dialog is closed.
void ExportFlow::ask(const QString& title, const QString& addition, const model::Session::ExportPart& part) {
    if (session_.dataset() == nullptr || session_.refusesExport())
        return;
    parts_.dialogs.askSave(window_, title, suggestedPath(addition), meshFilters(),
                           [this, part, of = session_.datasetGeneration()](const QString& path) {
                               rememberFolder(path);
                               session_.exportPart(toPath(path), of, part);
                           });
}

QString ExportFlow::suggestedPath(const QString& addition) const {
    const QString stem = QFileInfo(QString::fromStdString(session_.dataset()->name)).completeBaseName();
    const QString name =
        QStringLiteral("%1_%2%3.ply").arg(stem).arg(session_.isovalue().requested(), 0, 'g', 6).arg(addition);
    const QString folder = parts_.settings.text("files/exportFolder");
    return folder.isEmpty() ? QDir::home().filePath(name) : QDir(folder).filePath(name);
}

void ExportFlow::rememberFolder(const QString& path) {
    parts_.settings.set("files/exportFolder", QFileInfo(path).path());
}

std::optional<model::Session::ExportPart::Pieces> ExportFlow::piecesOf(Choice choice) const {
    const auto frame = session_.frame();
    if (session_.dataset() == nullptr || !frame || !frame->pieces)
        return std::nullopt;
    model::Session::ExportPart::Pieces pieces{{}, frame->isovalue};
    const auto& options = parts_.viewState.options().pieces;
    const model::PieceDisplay display(*frame->pieces, frame->geometry, options);
    const auto all = frame->pieces->pieces();
    for (std::size_t piece = 0; piece < all.size(); ++piece)
        if (choice == Choice::Selected ? options.selected == all[piece].id : display.isShown(piece))
            pieces.kept.push_back(all[piece]);
    return pieces;
}

void ExportFlow::showWhatIsPossible() {
    const auto frame = session_.frame();
    const model::ViewOptions& options = parts_.viewState.options();
    const auto* dataset = session_.dataset();
    const model::Clipping& clipping = options.clipping;
    const bool isKnown = frame && frame->pieces;
    const bool isClipped = clipping.isCropped || clipping.plane.isOn;
    parts_.actions.action("pieces.exportSelected")->setEnabled(isKnown && options.pieces.selected);
    parts_.actions.action("pieces.exportShown")
        ->setEnabled(options.pieces.hidesAny() ? isKnown : frame != nullptr && isClipped);
    // Only whole cells can be closed exactly, and only where no sample is missing.
    parts_.actions.action("clip.exportClosed")
        ->setEnabled(frame != nullptr && dataset != nullptr && clipping.isCropped && dataset->missingSamples == 0 &&
                     !(frame->mergeBound.limit > 0.0));
}

} // namespace isoslider::widgets
