#include "ui/widgets/viewport/scene_guides.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <QAction>
#include <QEvent>
#include <QPainter>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "ui/model/colouring/colour_model.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/axis_names.h"
#include "ui/model/surface/box_ticks.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/viewport/box_ticks_view.h"
#include "ui/widgets/viewport/camera_flight.h"
#include "ui/widgets/viewport/colour_bar_view.h"
#include "ui/widgets/viewport/orientation_cube.h"
#include "ui/widgets/viewport/scale_bar_view.h"
#include "ui/widgets/viewport/surface_fit.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

constexpr int kMargin = 12;
constexpr int kCubeMargin = 4; // its corners leave room around it already
constexpr int kLeastCubes = 3; // widths of it that the view must have
constexpr QSize kLeastForBar(260, 150); // of the view
constexpr int kMostColourBar = 300; // pixels high

} // namespace

SceneGuides::SceneGuides(model::Session& session, const Parts& parts, const ActionRegistry& actions, QObject* parent)
    : QObject(parent),
      session_(session),
      parts_(parts),
      actions_(actions),
      ticks_(new BoxTicksView(&parts.viewport)), // below the others
      cube_(new OrientationCube(&parts.viewport)),
      scaleBar_(new ScaleBarView(&parts.viewport)),
      colourBar_(new ColourBarView(&parts.viewport)),
      fit_(new SurfaceFit(session, parts.view, parts.viewport, this)) {
    connect(cube_, &OrientationCube::sidePicked, this,
            [this](model::StandardView side) { parts_.flight.turnTo(model::standardOrientation(side)); });
    connect(&parts_.viewport, &ViewportWidget::cameraChanged, this, [this] {
        cube_->setOrientation(parts_.viewport.camera().orientation());
        showScale();
        showTicks();
    });
    connect(actions_.action("view.fit"), &QAction::triggered, this, &SceneGuides::fitToSurface);
    parts_.viewport.installEventFilter(this);
    subscriptions_.push_back(parts_.view.observe([this] { showState(); }));
    subscriptions_.push_back(parts_.colours.observe([this] { showColours(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { showState(); }));
    subscriptions_.push_back(session_.frameChanged().observe([this] { showState(); }));
    cube_->setOrientation(parts_.viewport.camera().orientation());
    showState();
}

void SceneGuides::showState() {
    const auto* dataset = session_.dataset();
    const auto frame = session_.frame();
    actions_.action("view.fit")->setEnabled(frame != nullptr && frame->stats.triangles > 0);
    const QSize room = parts_.viewport.size();
    cube_->setPatient(dataset != nullptr && model::isPatientSpace(*dataset));
    cube_->setVisible(dataset != nullptr && parts_.view.options().showsCube &&
                      room.width() >= kLeastCubes * cube_->width() && room.height() >= 2 * cube_->height());
    cube_->move(room.width() - cube_->width() - kCubeMargin, kCubeMargin);
    showScale();
    showColours();
    showTicks();
}

// Outside the box as it is seen: away from its middle.
void SceneGuides::showTicks() {
    const auto* dataset = session_.dataset();
    const model::ViewOptions& options = parts_.view.options();
    const QSize room = parts_.viewport.size();
    ticks_->setGeometry(parts_.viewport.rect());
    ticks_->setVisible(dataset != nullptr && options.showsTicks && room.width() > 0 && room.height() > 0);
    if (ticks_->isHidden())
        return;
    const model::Camera& camera = parts_.viewport.camera();
    const GridGeometry& volume = dataset->geometry;
    const glm::dmat4 toScreen = camera.projectionMatrix(static_cast<double>(room.width()) / room.height()) *
                                camera.viewMatrix() * render::indexToCentredWorld(volume, volume);
    const auto pixelOf = [&](const glm::dvec3& place) {
        const glm::dvec4 clip = toScreen * glm::dvec4(place, 1.0);
        return QPointF((0.5 + 0.5 * clip.x / clip.w) * room.width(), (0.5 - 0.5 * clip.y / clip.w) * room.height());
    };
    const glm::dvec3 last(volume.dims[0] - 1, volume.dims[1] - 1, volume.dims[2] - 1);
    const QPointF middle = pixelOf(0.5 * last);
    std::vector<BoxTicksView::Edge> edges;
    for (const model::TickedEdge& ticked : model::tickedEdges(volume, toScreen, {room.width(), room.height()})) {
        BoxTicksView::Edge edge;
        const bool isPatient = model::isPatientSpace(*dataset) && ticked.isOfWorld;
        const QString unit = fromStd(dataset->lengthUnit);
        const QString name = ticked.isOfWorld
                                 ? fromStd(model::worldAxisName(ticked.axis, isPatient))
                                 : tr("along %1").arg(fromStd(model::AxisNames(volume).nameOf(ticked.axis)));
        edge.title = unit.isEmpty() ? name : tr("%1 (%2)").arg(name, unit);
        edge.from = pixelOf(ticked.from);
        edge.to = pixelOf(ticked.to);
        const QPointF along = edge.to - edge.from;
        QPointF across(-along.y(), along.x());
        if (QPointF::dotProduct(across, (edge.from + edge.to) / 2.0 - middle) < 0.0)
            across = -across;
        edge.outwards = across / std::hypot(across.x(), across.y());
        for (const auto& tick : ticked.ticks)
            edge.ticks.emplace_back(
                pixelOf(tick.place),
                fromStd(model::coordinateText(ticked.axis, tick.value, isPatient && tick.value != 0.0, 7)));
        edges.push_back(std::move(edge));
    }
    ticks_->setEdges(std::move(edges), model::isLight(options.stage.background));
}

// Between the cube and the scale bar: all three stay clear of each other.
void SceneGuides::showColours() {
    const auto& options = parts_.view.options();
    const model::SurfaceColours& colours = parts_.colours.colours();
    const QSize room = parts_.viewport.size();
    const int top = cube_->isHidden() ? kMargin : cube_->geometry().bottom() + kCubeMargin;
    const int bottom =
        options.showsScaleBar ? room.height() - 2 * kMargin - scaleBar_->sizeHint().height() : room.height() - kMargin;
    const int height = std::min(bottom - top, kMostColourBar);
    const bool isWanted = colours.by != model::ColourBy::One && options.showsColourBar &&
                          render::isColouredByField(options) && height >= ColourBarView::kLeastHeight &&
                          room.width() >= kLeastForBar.width();
    colourBar_->setVisible(isWanted);
    if (!isWanted)
        return;
    colourBar_->setBar({fromStd(parts_.colours.title()), fromStd(parts_.colours.unit()), colours.range, colours.map,
                        colours.isReversed, colours.field && colours.field->hasMissing},
                       height);
    colourBar_->move(room.width() - colourBar_->width() - kMargin, top);
}

void SceneGuides::showScale() {
    const auto* dataset = session_.dataset();
    const QSize room = parts_.viewport.size();
    // On the plane through the camera's target, as deep as the middle of the view. Where lengths are stretched it is
    // true along its own direction.
    const model::Camera& camera = parts_.viewport.camera();
    const double unstretched = glm::length(glm::inverse(camera.stretch()) * camera.right());
    const bool isWanted = dataset != nullptr && parts_.view.options().showsScaleBar &&
                          room.width() >= kLeastForBar.width() && room.height() >= kLeastForBar.height();
    const auto bar =
        isWanted ? model::scaleBarOf(unstretched * 2.0 * camera.halfHeight() / room.height(), ScaleBarView::kMostPixels)
                 : std::nullopt;
    scaleBar_->setVisible(bar.has_value());
    if (!bar)
        return;
    scaleBar_->setBar(*bar, inLengthUnit(fromStd(model::valueText(bar->length)), dataset->lengthUnit));
    scaleBar_->move(room.width() - scaleBar_->width() - kMargin, room.height() - scaleBar_->height() - kMargin);
}

void SceneGuides::paint(QPainter& painter) const {
    const auto paint = [&painter](const auto& guide) {
        if (guide.isHidden())
            return;
        painter.save();
        painter.translate(guide.pos());
        guide.paint(painter);
        painter.restore();
    };
    paint(*ticks_);
    paint(*cube_);
    paint(*scaleBar_);
    paint(*colourBar_);
}

void SceneGuides::fitToSurface() {
    fit_->find([this](const model::CameraPose& pose) { parts_.flight.flyTo(pose); });
}

bool SceneGuides::eventFilter(QObject* watched, QEvent* event) {
    if (watched == &parts_.viewport && event->type() == QEvent::Resize)
        showState();
    return QObject::eventFilter(watched, event);
}

} // namespace isoslider::widgets
