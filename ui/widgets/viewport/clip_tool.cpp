#include "ui/widgets/viewport/clip_tool.h"

#include <array>
#include <cmath>
#include <utility>

#include <QAction>
#include <QEvent>
#include <QMouseEvent>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/axis_names.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

using Kind = ClipHandle::Kind;

struct AxisAction {
    const char* id;
    int row; ///< see model::AxisNames
};
constexpr std::array<AxisAction, 3> kAxisActions{{{"clip.acrossX", 0}, {"clip.acrossY", 1}, {"clip.acrossZ", 2}}};

struct CapAction {
    const char* id;
    model::Cap cap;
};
constexpr std::array<CapAction, 3> kCapActions{
    {{"clip.noCap", model::Cap::None}, {"clip.colourCap", model::Cap::Colour}, {"clip.valueCap", model::Cap::Values}}};

/// The place along `way` from `from`, in lengths of it, that comes nearest to the line of sight; none if that runs
/// along it.
std::optional<double> nearestAlong(const glm::dvec3& from, const glm::dvec3& way,
                                   const std::pair<glm::dvec3, glm::dvec3>& line) {
    const glm::dvec3 sight = glm::normalize(line.second - line.first), between = from - line.first;
    const double a = glm::dot(way, way), b = glm::dot(way, sight);
    const double determinant = a - b * b;
    if (!(determinant > 1e-4 * a)) // within half a degree
        return std::nullopt;
    return (b * glm::dot(sight, between) - glm::dot(way, between)) / determinant;
}

} // namespace

ClipTool::ClipTool(model::Session& session, model::ViewState& options, ViewportWidget& viewport,
                   const ActionRegistry& actions, QObject* parent)
    : QObject(parent),
      session_(session),
      options_(options),
      viewport_(viewport),
      actions_(actions),
      handles_(new ClipHandles(viewport)),
      caps_{model::CapModel(session, options, 0), model::CapModel(session, options, 1)} {
    connectActions(actions);
    connect(&viewport_, &ViewportWidget::cameraChanged, handles_, qOverload<>(&QWidget::update));
    viewport_.installEventFilter(this);
    viewport_.setMouseTracking(true); // handles stand out below the pointer
    viewport_.view().setMouseTracking(true);
    subscriptions_.push_back(options_.observe([this] { showOptions(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { followDataset(); }));
    for (model::CapModel& cap : caps_)
        subscriptions_.push_back(cap.observe([this] { showCaps(); }));
    followDataset();
}

void ClipTool::connectActions(const ActionRegistry& actions) {
    const auto on = [&](const char* id, const std::function<void(model::Clipping&)>& effect) {
        connect(actions.action(id), &QAction::triggered, this, [this, effect] { change(effect); });
    };
    on("clip.crop", [](model::Clipping& clipping) { clipping.isCropped = !clipping.isCropped; });
    on("clip.resetCrop", [](model::Clipping& clipping) { clipping.crop.reset(); });
    on("clip.plane", [](model::Clipping& clipping) { clipping.plane().isOn = !clipping.plane().isOn; });
    on("clip.second", [](model::Clipping& clipping) {
        clipping.active = 1 - clipping.active;
        if (clipping.active == 1)
            clipping.plane().isOn = true;
    });
    on("clip.flip", [](model::Clipping& clipping) { clipping.plane() = model::flipped(clipping.plane()); });
    on("clip.facing", [this](model::Clipping& clipping) {
        clipping.plane() = model::turnedTo(clipping.plane(), viewport_.camera().facingNormal(), glm::dvec3(0.0));
        clipping.plane().isOn = true;
    });
    for (const auto& entry : kAxisActions)
        on(entry.id, [this, row = entry.row](model::Clipping& clipping) {
            // Along grid lines: where samples lie, also in a turned volume.
            const GridGeometry& geometry = session_.dataset()->geometry;
            const int axis = model::AxisNames(geometry).gridAxisInRow(row);
            const glm::dmat3 toWorld(geometry.indexToWorld());
            const glm::dvec3 across = glm::cross(toWorld[(axis + 1) % 3], toWorld[(axis + 2) % 3]);
            clipping.plane() = model::turnedTo(clipping.plane(), across, glm::dvec3(0.0));
            clipping.plane().isOn = true;
        });
    for (const auto& entry : kCapActions)
        on(entry.id, [cap = entry.cap](model::Clipping& clipping) { clipping.plane().cap = cap; });
}

void ClipTool::change(const std::function<void(model::Clipping&)>& change) {
    auto options = options_.options();
    change(options.clipping);
    options_.setOptions(options);
    showOptions(); // an action that changes nothing has been checked or unchecked all the same
}

// What a session file or another volume brings is put within the volume first.
void ClipTool::showOptions() {
    const auto* dataset = session_.dataset();
    auto options = options_.options();
    model::Clipping& clipping = options.clipping;
    if (dataset != nullptr) {
        if (clipping.crop)
            clipping.crop = model::cropWithin(clipping.crop, dataset->geometry.dims);
        if (clipping.crop == model::wholeBox(dataset->geometry.dims))
            clipping.crop.reset();
        for (model::ClipPlane& plane : clipping.planes)
            plane = model::planeWithin(plane, dataset->geometry);
        if (options != options_.options())
            return options_.setOptions(options);
    }
    const bool hasVolume = dataset != nullptr;
    for (const char* id : {"clip.crop", "clip.plane", "clip.second", "clip.facing"})
        actions_.action(id)->setEnabled(hasVolume);
    actions_.action("clip.crop")->setChecked(clipping.isCropped);
    actions_.action("clip.resetCrop")->setEnabled(hasVolume && clipping.crop.has_value());
    actions_.action("clip.plane")->setChecked(clipping.plane().isOn);
    actions_.action("clip.second")->setChecked(clipping.active == 1);
    actions_.action("clip.flip")->setEnabled(hasVolume && clipping.plane().isOn);
    const model::AxisNames names = hasVolume ? model::AxisNames(dataset->geometry) : model::AxisNames();
    for (const auto& entry : kAxisActions) {
        const QString name = fromStd(names.nameOf(names.gridAxisInRow(entry.row)));
        actions_.action(entry.id)->setEnabled(hasVolume);
        nameAction(*actions_.action(entry.id), tr("Across &%1").arg(name),
                   tr("Put the clip plane across %1, in the middle").arg(name));
    }
    for (const auto& entry : kCapActions) {
        actions_.action(entry.id)->setEnabled(hasVolume && clipping.plane().isOn);
        actions_.action(entry.id)->setChecked(clipping.plane().cap == entry.cap);
    }
    handles_->show(clipping, hasVolume ? std::optional(dataset->geometry) : std::nullopt);
    if (hovered_) // it may have been moved from elsewhere
        handles_->highlight(hovered_, textOf(*hovered_));
    for (model::CapModel& cap : caps_)
        cap.refresh();
}

void ClipTool::showCaps() {
    render::CapScenes scenes;
    for (std::size_t place = 0; place < caps_.size(); ++place)
        if (auto samples = caps_[place].samples())
            scenes[place] = {std::move(samples), caps_[place].window()};
    viewport_.setCaps(std::move(scenes));
}

// Boxes and planes are of one volume.
void ClipTool::followDataset() {
    if (std::exchange(dataset_, session_.datasetGeneration()) != session_.datasetGeneration()) {
        drag_.reset();
        hover(std::nullopt);
        auto options = options_.options();
        options.clipping = {};
        options_.setOptions(options);
    }
    showOptions();
}

bool ClipTool::eventFilter(QObject* watched, QEvent* event) {
    if (watched != &viewport_)
        return QObject::eventFilter(watched, event);
    switch (event->type()) {
        case QEvent::Resize: handles_->setGeometry(viewport_.rect()); break;
        case QEvent::Leave:
            if (!drag_)
                hover(std::nullopt);
            break;
        case QEvent::MouseButtonPress:
        case QEvent::MouseButtonDblClick: return press(static_cast<QMouseEvent*>(event));
        case QEvent::MouseMove: {
            const auto* mouse = static_cast<QMouseEvent*>(event);
            if (drag_) {
                drag(mouse->position());
                return true;
            }
            if (mouse->buttons() == Qt::NoButton)
                hover(handles_->handleAt(mouse->position()));
            break;
        }
        case QEvent::MouseButtonRelease:
            if (!drag_ || static_cast<QMouseEvent*>(event)->button() != Qt::LeftButton)
                break;
            drag_.reset();
            hover(handles_->handleAt(static_cast<QMouseEvent*>(event)->position()));
            return true;
        default: break;
    }
    return QObject::eventFilter(watched, event);
}

bool ClipTool::press(QMouseEvent* event) {
    if (drag_)
        return true; // another button
    const auto handle = handles_->handleAt(event->position());
    if (!handle || event->button() != Qt::LeftButton || event->modifiers().testFlag(Qt::ShiftModifier))
        return false;
    viewport_.setFocus(Qt::MouseFocusReason);
    hover(handle);
    begin(*handle, event->position());
    return true;
}

void ClipTool::hover(const std::optional<ClipHandle>& handle) {
    handles_->highlight(handle, handle ? textOf(*handle) : QString());
    if (std::exchange(hovered_, handle).has_value() == handle.has_value())
        return;
    if (handle) {
        if (viewport_.testAttribute(Qt::WA_SetCursor))
            cursorBefore_ = viewport_.cursor();
        viewport_.setCursor(Qt::SizeAllCursor);
    } else if (cursorBefore_) {
        viewport_.setCursor(*std::exchange(cursorBefore_, std::nullopt));
    } else {
        viewport_.unsetCursor();
    }
}

/// The place of the pointer along the handle's way, in lengths of that; none where it is seen along the line of sight.
std::optional<double> ClipTool::placeAlongWay(const glm::dvec3& from, const glm::dvec3& way, QPointF point) const {
    const glm::dmat3& stretch = viewport_.camera().stretch(); // near is what is seen to be near
    const auto line = handles_->lineOfSight(point);
    return nearestAlong(stretch * from, stretch * way, {stretch * line.first, stretch * line.second});
}

/// What moves a handle by one: a cell, or a unit of length.
glm::dvec3 ClipTool::wayOf(const ClipHandle& handle) const {
    return handle.kind == Kind::Face ? glm::dmat3(session_.dataset()->geometry.indexToWorld())[handle.axis]
                                     : options_.options().clipping.plane().normal;
}

void ClipTool::begin(const ClipHandle& handle, QPointF point) {
    Drag drag{handle, options_.options().clipping,      handles_->placeOf(handle),
              0.0,    handles_->placeOf({Kind::Plane}), false};
    drag.at = placeAlongWay(drag.from, wayOf(handle), point).value_or(0.0);
    drag.isFar =
        handle.kind == Kind::Normal && glm::dot(drag.before.plane().normal, viewport_.camera().facingNormal()) < 0.0;
    drag_ = drag;
}

void ClipTool::drag(QPointF point) {
    const auto* dataset = session_.dataset();
    if (dataset == nullptr)
        return;
    model::Clipping clipping = drag_->before;
    if (drag_->handle.kind == Kind::Normal) {
        clipping.plane() = model::turnedTo(clipping.plane(), turnedNormal(point), drag_->pivot);
    } else {
        const bool isFace = drag_->handle.kind == Kind::Face;
        const glm::dvec3 way = isFace ? wayOf(drag_->handle) : clipping.plane().normal;
        const auto at = placeAlongWay(drag_->from, way, point);
        if (!at)
            return;
        const double moved = *at - drag_->at;
        if (isFace) {
            const auto axis = static_cast<std::size_t>(drag_->handle.axis);
            const model::CropBox box = model::cropWithin(clipping.crop, dataset->geometry.dims);
            const std::int64_t before = drag_->handle.isHigh ? box.high[axis] : box.low[axis];
            clipping.crop = model::withFace(box, drag_->handle.axis, drag_->handle.isHigh,
                                            static_cast<double>(before) + moved, dataset->geometry.dims);
        } else {
            clipping.plane().offset += moved;
        }
    }
    change([&](model::Clipping& changed) { changed = clipping; });
    handles_->highlight(drag_->handle, textOf(drag_->handle));
}

/// Towards the place on a ball about the pivot that lies below the pointer, or beside it at the ball's rim.
glm::dvec3 ClipTool::turnedNormal(QPointF point) const {
    const auto [from, to] = handles_->lineOfSight(point);
    const glm::dvec3 sight = glm::normalize(to - from);
    const double nearest = glm::dot(drag_->pivot - from, sight);
    const glm::dvec3 foot = from + nearest * sight - drag_->pivot; // perpendicular to the line of sight
    const double radius = handles_->normalLength(), away = glm::length(foot);
    if (away >= radius) { // as the pointer is seen from the pivot, whatever the perspective
        const glm::dvec3 towards = viewport_.camera().facingNormal();
        return foot - glm::dot(foot, towards) * towards;
    }
    const double depth = std::sqrt(radius * radius - away * away);
    return foot + (drag_->isFar ? depth : -depth) * sight;
}

QString ClipTool::textOf(const ClipHandle& handle) const {
    const auto* dataset = session_.dataset();
    if (dataset == nullptr || handle.kind == Kind::Normal)
        return {};
    const model::Clipping& clipping = options_.options().clipping;
    if (handle.kind == Kind::Plane)
        return inLengthUnit(fromStd(model::valueText(clipping.plane().offset, 4)), dataset->lengthUnit);
    const model::CropBox box = model::cropWithin(clipping.crop, dataset->geometry.dims);
    const auto axis = static_cast<std::size_t>(handle.axis);
    return (handle.isHigh ? tr("%1 to %2") : tr("%1 from %2"))
        .arg(fromStd(model::AxisNames(dataset->geometry).nameOf(handle.axis)))
        .arg(handle.isHigh ? box.high[axis] : box.low[axis]);
}

} // namespace isoslider::widgets
