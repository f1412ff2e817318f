#include "ui/widgets/window/export_flow.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <QAction>
#include <QDir>
#include <QFileInfo>
#include <QRegularExpression>
#include <QStringList>
#include <QWidget>

#include "ui/model/surface/view_state.h"
#include "ui/widgets/opening/file_dialogs.h"
#include "ui/widgets/opening/file_filters.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

std::filesystem::path toPath(const QString& path) { return {path.toStdU16String()}; }

/// A file beside `path` that is not there yet: nobody was asked whether it may be replaced.
QString freePath(const QString& path, QString name, const QStringList& taken) {
    static const QRegularExpression unfit(QStringLiteral("[^\\w.-]+"), QRegularExpression::UseUnicodePropertiesOption);
    name.replace(unfit, QStringLiteral("_"));
    const QFileInfo file(path);
    const QString begin = file.dir().filePath(file.completeBaseName() + QLatin1Char('_') + name);
    const QString end = QLatin1Char('.') + file.suffix();
    QString found = begin + end;
    for (int number = 2; QFileInfo::exists(found) || taken.contains(found); ++number)
        found = begin + QLatin1Char('_') + QString::number(number) + end;
    return found;
}

} // namespace

ExportFlow::ExportFlow(model::Session& session, const Parts& parts, QWidget* window)
    : QObject(window), session_(session), parts_(parts), window_(window) {
    connect(parts_.actions.action("mesh.export"), &QAction::triggered, this, [this] { askWhole(); });
    connect(parts_.actions.action("pieces.exportShown"), &QAction::triggered, this, [this] { askShown(); });
    connect(parts_.actions.action("pieces.exportSelected"), &QAction::triggered, this, [this] { askSelected(); });
    connect(parts_.actions.action("clip.exportClosed"), &QAction::triggered, this, [this] { askClosed(); });
    frameSubscription_ = session_.frameChanged().observe([this] { showWhatIsPossible(); });
    surfacesSubscription_ = session_.surfaces().observe([this] { showWhatIsPossible(); });
    optionsSubscription_ = parts_.viewState.observe([this] { showWhatIsPossible(); });
    showWhatIsPossible();
}

void ExportFlow::askWhole() {
    if (session_.dataset() == nullptr || session_.refusesExport())
        return;
    const auto& surfaces = session_.surfaces();
    const QString remark = whatIsNotShown();
    const bool isNamed = surfaces.canRemove() && surfaces.active() != nullptr;
    const QString name = isNamed ? QString::fromStdString(surfaces.active()->name) : QString();
    const QString title = remark.isEmpty()
                              ? (isNamed ? tr("Export Mesh of %1").arg(name) : tr("Export Mesh"))
                              : (isNamed ? tr("Export Whole Surface of %1").arg(name) : tr("Export Whole Surface"));
    parts_.dialogs.askSave(window_, title, suggestedPath(QString()), meshFilters(),
                           [this, remark, of = session_.datasetGeneration()](const QString& path) {
                               rememberFolder(path);
                               session_.exportMesh(toPath(path), of, remark.toStdString());
                           });
}

// Empty where all is.
QString ExportFlow::whatIsNotShown() const {
    const model::ViewOptions& options = parts_.viewState.options();
    const bool hides = options.pieces.hidesAny(), clips = options.clipping.clipsAnything();
    if (!hides && !clips)
        return {};
    const QString what = hides && clips ? tr("The hidden and clipped parts are in it.")
                         : hides        ? tr("The hidden pieces are in it.")
                                        : tr("The clipped parts are in it.");
    return tr("%1 Export What Is Shown leaves them out.").arg(what);
}

// A file for each surface. The first has the name that is chosen, the others that of the surface besides.
void ExportFlow::askShown() {
    std::vector<ShownPart> parts;
    for (const model::ShownSurface& surface : model::shownSurfaces(session_, parts_.viewState.options())) {
        const auto* listed = session_.surfaces().list().find(surface.id);
        model::Session::ExportPart part;
        part.clipping = parts_.viewState.options().clipping;
        if (surface.pieces.hidesAny())
            part.pieces = shownPiecesOf(surface);
        const bool isNothing = surface.pieces.hidesAny() && (!part.pieces || part.pieces->kept.empty());
        if (!surface.isOfSecond && listed != nullptr && !isNothing)
            parts.push_back({surface.id, QString::fromStdString(listed->name), std::move(part)});
    }
    if (parts.empty() || session_.dataset() == nullptr || session_.refusesExport())
        return;
    const QString title =
        parts.size() > 1 ? tr("Export What Is Shown: %1 Files").arg(parts.size()) : tr("Export What Is Shown");
    parts_.dialogs.askSave(window_, title, suggestedPath(QStringLiteral("_shown")), meshFilters(),
                           [this, parts, of = session_.datasetGeneration()](const QString& path) {
                               rememberFolder(path);
                               exportAll(parts, path, of);
                           });
}

void ExportFlow::exportAll(const std::vector<ShownPart>& parts, const QString& path, model::DatasetGeneration of) {
    QStringList taken{path};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const QString file = i == 0 ? path : freePath(path, parts[i].name, taken);
        taken << file;
        if (parts[i].surface == session_.surfaces().list().active)
            session_.exportPart(toPath(file), of, parts[i].part);
        else
            session_.exportInactive(toPath(file), of, parts[i].surface, parts[i].part);
    }
}

void ExportFlow::askSelected() {
    model::Session::ExportPart part;
    part.pieces = selectedPiece();
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
    const QString stem = QString::fromStdString(model::fileStem(*session_.dataset()));
    const QString name =
        QStringLiteral("%1_%2%3.ply").arg(stem).arg(session_.isovalue().requested(), 0, 'g', 6).arg(addition);
    const QString folder = parts_.settings.text("files/exportFolder");
    return folder.isEmpty() ? QDir::home().filePath(name) : QDir(folder).filePath(name);
}

void ExportFlow::rememberFolder(const QString& path) {
    parts_.settings.set("files/exportFolder", QFileInfo(path).path());
}

std::optional<model::Session::ExportPart::Pieces> ExportFlow::selectedPiece() const {
    const auto frame = session_.frame();
    if (session_.dataset() == nullptr || !frame || !frame->pieces)
        return std::nullopt;
    model::Session::ExportPart::Pieces pieces{{}, frame->isovalue};
    for (const extract::Piece& piece : frame->pieces->pieces())
        if (parts_.viewState.options().pieces.selected == piece.id)
            pieces.kept.push_back(piece);
    return pieces;
}

std::optional<model::Session::ExportPart::Pieces> ExportFlow::shownPiecesOf(const model::ShownSurface& surface) {
    const extract::SurfaceFrame& frame = *surface.frame;
    if (!frame.pieces)
        return std::nullopt;
    model::Session::ExportPart::Pieces pieces{{}, frame.isovalue};
    const model::PieceDisplay display(*frame.pieces, frame.geometry, surface.pieces);
    const auto all = frame.pieces->pieces();
    for (std::size_t piece = 0; piece < all.size(); ++piece)
        if (display.isShown(piece))
            pieces.kept.push_back(all[piece]);
    return pieces;
}

void ExportFlow::showWhatIsPossible() {
    const auto frame = session_.frame();
    const model::ViewOptions& options = parts_.viewState.options();
    const auto* dataset = session_.dataset();
    const model::Clipping& clipping = options.clipping;
    const bool isKnown = frame && frame->pieces;
    const auto& surfaces = session_.surfaces().list().surfaces;
    const bool areSeveral = std::count_if(surfaces.begin(), surfaces.end(),
                                          [](const model::ListedSurface& surface) { return surface.isVisible; }) > 1;
    const bool isClipped = clipping.clipsAnything();
    parts_.actions.action("pieces.exportSelected")->setEnabled(isKnown && options.pieces.selected);
    parts_.actions.action("pieces.exportShown")
        ->setEnabled(frame != nullptr && (areSeveral || (options.pieces.hidesAny() ? isKnown : isClipped)));
    // Only whole cells can be closed exactly, and only where no sample is missing.
    parts_.actions.action("clip.exportClosed")
        ->setEnabled(frame != nullptr && dataset != nullptr && clipping.isCropped && dataset->missingSamples == 0 &&
                     !(frame->mergeBound.limit > 0.0));
}

} // namespace isoslider::widgets
