#include "ui/widgets/window/undo_history.h"

#include <algorithm>
#include <utility>

#include <QAction>
#include <QGuiApplication>

#include "ui/model/colouring/colour_model.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/slices/slice_model.h"
#include "ui/model/surface/view_state.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

constexpr int kTogetherMs = 400;
constexpr int kMostSteps = 500;

/// REQUIRES: as many surfaces.
bool hideSame(const model::SurfaceList& before, const model::SurfaceList& after) {
    return std::equal(before.surfaces.begin(), before.surfaces.end(), after.surfaces.begin(),
                      [](const auto& a, const auto& b) { return a.hiddenPieces == b.hiddenPieces; });
}

/// The list with what has been found out about the same surfaces since: until it is found again, that hides most.
model::SurfaceList withFound(model::SurfaceList list, const model::SurfaceList& now) {
    for (model::ListedSurface& surface : list.surfaces)
        if (const auto* same = now.find(surface.id))
            surface.hiddenPieces.shortLived = same->hiddenPieces.shortLived;
    return list;
}

/// What a step is called; after "Undo" and "Redo".
QString nameOf(const model::SceneState& before, const model::SceneState& after) {
    if (before.surfaces.surfaces.size() != after.surfaces.surfaces.size())
        return before.surfaces.surfaces.size() < after.surfaces.surfaces.size() ? UndoHistory::tr("Add Surface")
                                                                                : UndoHistory::tr("Remove Surface");
    if (before.surfaces.active != after.surfaces.active)
        return UndoHistory::tr("Active Surface");
    if (before.second.volume != after.second.volume)
        return UndoHistory::tr("Second Volume");
    if (before.second != after.second)
        return UndoHistory::tr("Surfaces of Second Volume");
    if (before.isovalue != after.isovalue)
        return UndoHistory::tr("Isovalue %1").arg(QString::fromStdString(model::valueText(after.isovalue, 7)));
    if (before.view.pieces != after.view.pieces || !hideSame(before.surfaces, after.surfaces))
        return UndoHistory::tr("Pieces");
    if (before.surfaces != after.surfaces)
        return UndoHistory::tr("Surfaces");
    if (before.view.colouring != after.view.colouring)
        return UndoHistory::tr("Colours");
    if (before.view.clipping != after.view.clipping)
        return UndoHistory::tr("Clipping");
    if (before.slices != after.slices)
        return UndoHistory::tr("Slices");
    if (before.histogram != after.histogram)
        return UndoHistory::tr("Histogram");
    if (before.reference != after.reference)
        return UndoHistory::tr("Reference Isovalue");
    return before.view != after.view ? UndoHistory::tr("View") : UndoHistory::tr("Error");
}

} // namespace

class UndoHistory::Step : public QUndoCommand {
public:
    Step(UndoHistory& history, const model::SceneState& before, const model::SceneState& after)
        : QUndoCommand(nameOf(before, after)), history_(history), before_(before), after_(after) {}
    void undo() override { history_.apply(before_); }
    void redo() override {
        if (std::exchange(isDone_, false))
            return; // the user did it
        history_.apply(after_);
    }

private:
    UndoHistory& history_;
    model::SceneState before_, after_;
    bool isDone_ = true;
};

UndoHistory::UndoHistory(const Models& models, const ActionRegistry& actions, QObject* parent)
    : QObject(parent), models_(models), actions_(actions) {
    stack_.setUndoLimit(kMostSteps);
    timer_.setSingleShot(true);
    timer_.setInterval(kTogetherMs);
    connect(&timer_, &QTimer::timeout, this, [this] {
        if (QGuiApplication::mouseButtons() != Qt::NoButton)
            timer_.start(); // it is not over
        else
            record();
    });
    connect(actions_.action("edit.undo"), &QAction::triggered, this, &UndoHistory::undo);
    connect(actions_.action("edit.redo"), &QAction::triggered, this, &UndoHistory::redo);
    connect(&stack_, &QUndoStack::indexChanged, this, &UndoHistory::showActions);
    model::Session& session = models_.session;
    const auto note = [this] { noteChange(); };
    subscriptions_.push_back(session.isovalue().observe(note));
    subscriptions_.push_back(session.detail().observe(note));
    subscriptions_.push_back(session.surfaces().observe([this] { noteSurfaces(); }));
    subscriptions_.push_back(session.surfaces().observeRestructuring([this] {
        if (isOfThisVolume() && !isApplying_ && !isNew_)
            record();
    }));
    subscriptions_.push_back(session.secondVolume().changed().observe(note));
    subscriptions_.push_back(session.secondVolume().surfaces().observe(note));
    subscriptions_.push_back(session.histogramOptions().observe(note));
    subscriptions_.push_back(models_.view.observe(note));
    subscriptions_.push_back(models_.slices.observe(note));
    subscriptions_.push_back(models_.colours.observe(note));
    subscriptions_.push_back(session.datasetChanged().observe(note));
    subscriptions_.push_back(session.frameChanged().observe([this] {
        if (isNew_ && models_.session.frame() != nullptr) // once all have heard of it
            QTimer::singleShot(0, this, [this] { isNew_ = false; });
    }));
    forget();
}

model::SceneState UndoHistory::capture() const {
    model::SceneState state;
    auto& session = models_.session;
    state.isovalue = session.isovalue().requested();
    state.surfaces = session.surfaces().list();
    for (model::ListedSurface& surface : state.surfaces.surfaces)
        surface.hiddenPieces.shortLived.reset(); // found, not set
    state.second = session.secondVolume().state();
    state.reference = session.isovalue().reference();
    state.error = session.detail().error();
    state.view = models_.view.options();
    state.view.pieces.selected.reset();
    state.view.pieces.hiddenPieces() = {}; // which the surfaces have
    if (models_.colours.isMaking()) // no step before it can be drawn: it may be refused
        state.view.colouring = last_.view.colouring;
    state.histogram = session.histogramOptions().options();
    state.slices = models_.slices.options();
    return state;
}

void UndoHistory::apply(const model::SceneState& state) {
    isApplying_ = true;
    model::Session& session = models_.session;
    auto view = state.view;
    view.pieces.selected = models_.view.options().pieces.selected;
    view.pieces.hiddenPieces() = models_.view.options().pieces; // they follow the surfaces
    models_.view.setOptions(view);
    session.histogramOptions().setOptions(state.histogram);
    models_.slices.setOptions(state.slices);
    session.detail().setError(state.error);
    session.isovalue().setReference(state.reference);
    session.surfaces().setList(withFound(state.surfaces, session.surfaces().list()));
    session.secondVolume().setState(state.second);
    session.isovalue().request(state.isovalue);
    timer_.stop();
    isApplying_ = false;
    last_.view.colouring = state.view.colouring; // which may be on its way
    last_ = capture(); // what was clamped stays so
}

void UndoHistory::noteChange() {
    if (isApplying_)
        return;
    if (!isOfThisVolume())
        return forget();
    if (isNew_)
        last_ = capture();
    // A first isovalue that gives way to a better one is nobody's step.
    if (auto first = models_.session.firstIsovalue().isovalue()) {
        const auto& isovalue = models_.session.isovalue();
        first = std::clamp(*first, isovalue.min(), isovalue.max()); // one asked for may be out of range
        last_.isovalue = *first;
        for (model::ListedSurface& surface : last_.surfaces.surfaces)
            if (surface.id == last_.surfaces.active)
                surface.isovalue = *first;
    }
    for (model::ListedSurface& surface : last_.surfaces.surfaces) { // so is that a session's pieces are found
        const auto* now = models_.session.surfaces().list().find(surface.id);
        if (now != nullptr && !surface.hiddenPieces.awaited.isEmpty() && now->hiddenPieces.awaited.isEmpty())
            surface.hiddenPieces = now->hiddenPieces;
        surface.hiddenPieces.shortLived.reset();
    }
    if (capture() == last_)
        return;
    timer_.start();
    showActions();
}

// One that comes, goes or becomes active is a step, however soon the next one follows.
void UndoHistory::noteSurfaces() {
    const auto& now = models_.session.surfaces().list();
    const bool isOther = last_.surfaces.surfaces.size() != now.surfaces.size() || last_.surfaces.active != now.active;
    noteChange();
    if (isOther && timer_.isActive())
        record();
}

bool UndoHistory::isOfThisVolume() const {
    return models_.session.dataset() != nullptr &&
           dataset_ == static_cast<std::uint64_t>(models_.session.datasetGeneration());
}

void UndoHistory::record() {
    timer_.stop();
    const model::SceneState now = capture();
    if (now != last_) {
        const model::SceneState before = std::exchange(last_, now);
        stack_.push(new Step(*this, before, now));
    }
    showActions();
}

void UndoHistory::forget() {
    timer_.stop();
    dataset_ = static_cast<std::uint64_t>(models_.session.datasetGeneration());
    isNew_ = true;
    last_ = capture();
    stack_.clear();
    showActions();
}

UndoHistory::~UndoHistory() { disconnect(&stack_, nullptr, this, nullptr); }

void UndoHistory::undo() {
    record();
    stack_.undo();
}

void UndoHistory::redo() {
    record(); // what was changed since takes the place of what could be done again
    stack_.redo();
}

void UndoHistory::showActions() {
    const auto show = [](QAction& action, bool isEnabled, const QString& text) {
        action.setEnabled(isEnabled);
        action.setText(text);
    };
    const bool isChanging = timer_.isActive();
    show(*actions_.action("edit.undo"), isChanging || stack_.canUndo(),
         isChanging || !stack_.canUndo() ? tr("&Undo") : tr("&Undo %1").arg(stack_.undoText()));
    show(*actions_.action("edit.redo"), !isChanging && stack_.canRedo(),
         isChanging || !stack_.canRedo() ? tr("&Redo") : tr("&Redo %1").arg(stack_.redoText()));
}

} // namespace isoslider::widgets
