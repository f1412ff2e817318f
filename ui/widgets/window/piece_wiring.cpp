#include "ui/widgets/window/piece_wiring.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <QAction>
#include <QDockWidget>
#include <QMenu>

#include "ui/model/pieces/piece_places.h"
#include "ui/model/pieces/shown_hit.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/shown_surfaces.h"
#include "ui/model/surface/view_state.h"
#include "ui/widgets/panels/pieces_panel.h"
#include "ui/widgets/viewport/view_note.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {

PieceWiring::PieceWiring(model::Session& session, const ActionRegistry& actions, ViewportHost& host, const Parts& parts,
                         QObject* parent)
    : QObject(parent),
      session_(session),
      actions_(actions),
      host_(host),
      parts_(parts),
      note_(new ViewNote(host, ViewNote::Place::Centre)),
      shortLived_(session, [this](model::SurfaceId surface, std::shared_ptr<const model::ShortLivedPieces> found) {
          takeShortLived(surface, std::move(found));
      }) {
    note_->setObjectName(QStringLiteral("hiddenPiecesNote"));
    connectActions();
    connect(&parts_.dock, &QDockWidget::visibilityChanged, this, [this](bool isSeen) {
        isPanelSeen_ = isSeen;
        parts_.panel.setSeen(isSeen);
        ask();
    });
    connect(&parts_.panel, &PiecesPanel::piecePicked, this, &PieceWiring::select);
    if (auto* viewport = host_.viewport()) {
        connect(viewport, &ViewportWidget::picked, this, [this](QPointF point) { pick(point, Purpose::Select); });
        connect(viewport, &ViewportWidget::menuRequested, this, [this](QPointF point) { pick(point, Purpose::Menu); });
    }
    frameSubscription_ = session_.frameChanged().observe([this] {
        findAwaited();
        shortLived_.update();
        takePick();
        dropLostSelection();
        showWhatIsHidden();
        actions_.action("pieces.largest")
            ->setEnabled(session_.frame() != nullptr && host_.viewState().options().pieces.largest != 1);
    });
    datasetSubscription_ = session_.datasetChanged().observe([this] { followDataset(); });
    optionsSubscription_ = host_.viewState().observe([this] { showOptions(); });
    surfacesSubscription_ = session_.surfaces().observe([this] { followSurfaces(); });
    secondSubscription_ = session_.secondVolume().surfaces().observe([this] { showWhatIsHidden(); });
    inactiveSubscription_ = session_.inactiveChanged().observe([this] {
        findAwaitedOfOthers();
        shortLived_.update();
    });
    showOptions();
}

void PieceWiring::connectActions() {
    connect(actions_.action("pieces.colour"), &QAction::toggled, this,
            [this](bool isColoured) { change([&](model::PieceOptions& pieces) { pieces.isColoured = isColoured; }); });
    connect(actions_.action("pieces.hide"), &QAction::triggered, this, [this] {
        change([](model::PieceOptions& pieces) {
            if (!pieces.selected)
                return;
            if (std::find(pieces.hidden.begin(), pieces.hidden.end(), *pieces.selected) == pieces.hidden.end())
                pieces.hidden.push_back(*pieces.selected);
            if (pieces.only == pieces.selected)
                pieces.only.reset();
            pieces.selected.reset();
        });
    });
    connect(actions_.action("pieces.only"), &QAction::triggered, this, [this] {
        change([](model::PieceOptions& pieces) {
            pieces.only = pieces.selected;
            pieces.selected.reset();
        });
    });
    connect(actions_.action("pieces.hideSmaller"), &QAction::triggered, this, &PieceWiring::hideSmaller);
    connect(actions_.action("pieces.largest"), &QAction::triggered, this, [this] {
        change([](model::PieceOptions& pieces) {
            pieces.largest = 1;
            pieces.selected.reset();
        });
    });
    connect(actions_.action("pieces.all"), &QAction::triggered, this,
            [this] { change([](model::PieceOptions& pieces) { pieces.hiddenPieces() = {}; }); });
    connect(actions_.action("pieces.deselect"), &QAction::triggered, this, [this] { select(std::nullopt); });
}

void PieceWiring::hideSmaller() {
    const auto frame = session_.frame();
    const auto& pieces = host_.viewState().options().pieces;
    if (!frame || !frame->pieces)
        return;
    const auto selected = model::PieceDisplay(*frame->pieces, frame->geometry, pieces).find(pieces.selected);
    if (!selected)
        return;
    const double size = model::sizeOf(frame->pieces->pieces()[*selected], frame->geometry);
    change([size](model::PieceOptions& options) { options.leastSize = size; });
}

void PieceWiring::change(const std::function<void(model::PieceOptions&)>& change) {
    auto options = host_.viewState().options();
    change(options.pieces);
    host_.viewState().setOptions(options);
}

// Once a piece was hidden all pictures have pieces: they keep their numbers from one picture to the next only.
void PieceWiring::ask() {
    session_.findPieces(isPanelSeen_ || pick_ || hasHidden_ || host_.viewState().options().pieces.isWanted());
}

void PieceWiring::pick(QPointF point, Purpose purpose) {
    const auto frame = session_.frame();
    const auto line = host_.viewport()->lineOfSight(point);
    pick_.reset();
    const Met met = frame && line ? activatePicked(*line, purpose) : Met::OfSecond;
    if (met != Met::OfSecond)
        pick_ = Pick{point, purpose, *line, met == Met::Other ? session_.isovalue().requested() : frame->isovalue,
                     met == Met::Other};
    else if (purpose == Purpose::Menu)
        showMenu(point, frame && line);
    ask();
    takePick();
}

// What is met first is what is meant, whichever surface it is of. A menu is about the active one, also where something
// is seen through it; a double click takes what is seen.
PieceWiring::Met PieceWiring::activatePicked(const std::pair<glm::dvec3, glm::dvec3>& line, Purpose purpose) {
    const auto drawn = session_.pictureOf(session_.surfaces().list().active); // of whose grid the line is
    if (drawn == nullptr)
        return Met::Active;
    const GridGeometry& volume = session_.dataset()->geometry;
    const model::ViewOptions& view = host_.viewState().options();
    const auto isActiveOne = [this](const model::ShownSurface& surface) {
        return !surface.isOfSecond && surface.id == session_.surfaces().list().active;
    };
    auto shown = model::shownSurfaces(session_, view);
    for (model::ShownSurface& surface : shown)
        if (purpose == Purpose::Menu && isActiveOne(surface))
            surface.isSeeThrough = false;
    const auto met =
        model::firstShownPlace(shown, view.clipping, volume, model::centredWorldOf(line.first, drawn->geometry, volume),
                               model::centredWorldOf(line.second, drawn->geometry, volume));
    if (!met)
        return Met::Active;
    const model::ShownSurface& surface = shown[met->surface];
    const bool isActive = isActiveOne(surface);
    if (!isActive)
        (surface.isOfSecond ? session_.secondVolume().surfaces() : session_.surfaces()).activate(surface.id);
    return surface.isOfSecond ? Met::OfSecond : isActive ? Met::Active : Met::Other;
}

void PieceWiring::takePick() {
    const auto frame = session_.frame();
    if (!pick_ || !frame || session_.dataset() == nullptr)
        return;
    if (pick_->isComing && frame->isovalue != pick_->isovalue && session_.isMoving())
        return;
    if (frame->isovalue == pick_->isovalue && !frame->pieces && !frame->findsPieces)
        return; // the next one has them
    const Pick pick = *std::exchange(pick_, std::nullopt);
    if (frame->isovalue != pick.isovalue)
        return ask(); // nobody waits for an answer about what was there before
    std::optional<extract::PieceId> piece;
    if (frame->pieces) {
        const model::ViewOptions& view = host_.viewState().options();
        const auto cuts = model::cutsOf(view.clipping, frame->geometry, session_.dataset()->geometry);
        if (const auto hit = model::firstShownHit(*frame, view.pieces, cuts, pick.line.first, pick.line.second))
            piece = frame->pieces->pieces()[hit->piece].id;
    }
    select(piece);
    ask();
    if (pick.purpose == Purpose::Menu)
        showMenu(pick.point, false);
}

// Coarse pictures and those on the way to the session's isovalue have other edges.
void PieceWiring::findAwaited() {
    const auto frame = session_.frame();
    const auto& pieces = host_.viewState().options().pieces;
    if (pieces.awaited.isEmpty() || !frame || !frame->pieces || frame->mergedCells > 1 ||
        frame->isovalue != session_.isovalue().requested())
        return;
    change([&](model::PieceOptions& options) { options.hiddenPieces() = model::found(options, *frame->pieces); });
}

void PieceWiring::findAwaitedOfOthers() {
    auto& surfaces = session_.surfaces();
    const auto listed = surfaces.list();
    for (const model::ListedSurface& surface : listed.surfaces) {
        if (surface.id == listed.active || surface.hiddenPieces.awaited.isEmpty())
            continue;
        const auto picture = session_.pictureOf(surface.id);
        if (picture && picture->pieces && picture->isovalue == surface.isovalue)
            surfaces.change(surface.id, [&](model::ListedSurface& changed) {
                changed.hiddenPieces = model::found(changed.hiddenPieces, *picture->pieces);
            });
    }
}

void PieceWiring::takeShortLived(model::SurfaceId surface, std::shared_ptr<const model::ShortLivedPieces> found) {
    if (surface == followed_)
        change([&](model::PieceOptions& pieces) { pieces.shortLived = std::move(found); });
    else
        session_.surfaces().change(
            surface, [&](model::ListedSurface& changed) { changed.hiddenPieces.shortLived = std::move(found); });
}

void PieceWiring::followSurfaces() {
    const auto* active = session_.surfaces().active();
    if (active == nullptr)
        return;
    const bool isOther = std::exchange(followed_, active->id) != active->id;
    const model::HiddenPieces hidden = active->hiddenPieces;
    change([&](model::PieceOptions& pieces) {
        pieces.hiddenPieces() = hidden;
        if (isOther)
            pieces.selected.reset(); // of another surface
    });
    showWhatIsHidden();
}

void PieceWiring::tellSurfaces() {
    auto& surfaces = session_.surfaces();
    const model::HiddenPieces hidden = host_.viewState().options().pieces;
    hasHidden_ = hasHidden_ || !hidden.hidden.empty() || hidden.only || !hidden.awaited.isEmpty();
    if (surfaces.active() != nullptr && surfaces.active()->id == followed_)
        surfaces.change(followed_, [&](model::ListedSurface& surface) { surface.hiddenPieces = hidden; });
}

void PieceWiring::dropLostSelection() {
    const auto frame = session_.frame();
    const auto& pieces = host_.viewState().options().pieces;
    if (frame && frame->pieces && pieces.selected &&
        !model::PieceDisplay(*frame->pieces, frame->geometry, pieces).find(pieces.selected))
        select(std::nullopt);
}

void PieceWiring::select(std::optional<extract::PieceId> piece) {
    change([&](model::PieceOptions& pieces) { pieces.selected = piece; });
}

// What the menu is about.
QString PieceWiring::menuTitle(bool isOfSecond) const {
    const auto& surfaces = isOfSecond ? session_.secondVolume().surfaces() : session_.surfaces();
    if (surfaces.active() == nullptr)
        return {};
    const QString name = QString::fromStdString(surfaces.active()->name).replace(QLatin1Char('&'), QLatin1String("&&"));
    if (isOfSecond)
        return tr("%1, of the second volume").arg(name);
    const auto& selected = host_.viewState().options().pieces.selected;
    return selected ? tr("%1: piece %2").arg(name).arg(selected->number() + 1) : name;
}

void PieceWiring::showMenu(QPointF point, bool isOfSecond) {
    auto* viewport = host_.viewport();
    auto* menu = new QMenu(viewport);
    menu->setAttribute(Qt::WA_DeleteOnClose);
    menu->setObjectName(QStringLiteral("viewMenu"));
    if (const QString title = menuTitle(isOfSecond); !title.isEmpty())
        menu->addAction(title)->setEnabled(false);
    const std::vector<std::vector<const char*>> groups{
        {"pieces.hide", "pieces.only", "pieces.hideSmaller", "pieces.largest", "pieces.all"},
        {"pieces.exportSelected", "pieces.exportShown"},
        {"pieces.colour", "view.measure", "clip.plane", "clip.crop", "slices.isovalue"},
        {"view.fit", "view.reset"},
        {"edit.undo", "edit.redo"}};
    for (const auto& group : groups) {
        if (isOfSecond && QLatin1String(group.front()).startsWith(QLatin1String("pieces.h")))
            continue; // pieces are those of the first
        if (!menu->isEmpty())
            menu->addSeparator();
        for (const char* action : group)
            menu->addAction(actions_.action(action));
    }
    menu->popup(viewport->mapToGlobal(point.toPoint()));
}

void PieceWiring::showOptions() {
    tellSurfaces();
    ask();
    findAwaited(); // undone steps may bring back what was awaited
    shortLived_.update();
    const auto& pieces = host_.viewState().options().pieces;
    actions_.action("pieces.colour")->setChecked(pieces.isColoured);
    for (const char* action : {"pieces.hide", "pieces.only", "pieces.hideSmaller", "pieces.deselect"})
        actions_.action(action)->setEnabled(pieces.selected.has_value());
    actions_.action("pieces.largest")->setEnabled(session_.frame() != nullptr && pieces.largest != 1);
    actions_.action("pieces.all")->setEnabled(pieces.hidesAny());
    showWhatIsHidden();
}

QString PieceWiring::whatIsHidden() const {
    const auto shortcut = [this](const char* action) {
        return actions_.action(action)->shortcut().toString(QKeySequence::NativeText);
    };
    const auto isSeen = [](const model::ListedSurface& surface) { return surface.isVisible; };
    const auto* active = session_.surfaces().active();
    if (active == nullptr)
        return {};
    if (!active->isVisible) {
        const auto& first = session_.surfaces().list().surfaces;
        const auto& second = session_.secondVolume().surfaces().list().surfaces;
        const bool isAnySeen =
            std::any_of(first.begin(), first.end(), isSeen) || std::any_of(second.begin(), second.end(), isSeen);
        if (isAnySeen)
            return {};
        return (first.size() + second.size() > 1 ? tr("All surfaces are hidden. Show the active one: %1")
                                                 : tr("The surface is hidden. Show it: %1"))
            .arg(shortcut("surfaces.show"));
    }
    const auto frame = session_.frame();
    const auto& pieces = host_.viewState().options().pieces;
    model::PieceCounts counts;
    if (frame && frame->pieces && pieces.hidesAny())
        counts = model::PieceDisplay(*frame->pieces, frame->geometry, pieces).counts();
    return counts.all > 0 && counts.shown == 0 ? tr("All pieces are hidden. Show them: %1").arg(shortcut("pieces.all"))
                                               : QString();
}

void PieceWiring::showWhatIsHidden() { note_->say(whatIsHidden()); }

// Numbers of pieces are of one volume.
void PieceWiring::followDataset() {
    if (std::exchange(dataset_, session_.datasetGeneration()) == session_.datasetGeneration())
        return;
    pick_.reset();
    hasHidden_ = false;
    change([](model::PieceOptions& pieces) {
        pieces.hiddenPieces() = {};
        pieces.selected.reset();
        pieces.isColoured = false;
    });
    ask();
}

} // namespace isoslider::widgets
