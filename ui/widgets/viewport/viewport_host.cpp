#include "ui/widgets/viewport/viewport_host.h"

#include <algorithm>
#include <cmath>

#include <QAction>
#include <QEvent>
#include <QLabel>
#include <QPainter>
#include <QVBoxLayout>

#include "ui/model/colouring/colour_model.h"
#include "ui/model/isovalue/isovalue_words.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/render/gl_support.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/common/focus_frame.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/opening/loading_card.h"
#include "ui/widgets/opening/start_page.h"
#include "ui/widgets/viewport/camera_flight.h"
#include "ui/widgets/viewport/clip_tool.h"
#include "ui/widgets/viewport/first_view.h"
#include "ui/widgets/viewport/measure_tool.h"
#include "ui/widgets/viewport/scene_guides.h"
#include "ui/widgets/viewport/viewport_overlay.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

constexpr int kOverlayMargin = 12;
constexpr int kOverlaySpacing = 6;
constexpr std::uint32_t kSecondVolume = 0x80000000; // set in the ids of its surfaces
constexpr std::uint64_t kLeastPictureBytes = 1 << 14; // below it, it is not for its size that a surface is refused
const QColor kPreviewColour(255, 214, 138);
const QColor kDarkHalo(20, 22, 26, 150), kLightHalo(250, 250, 250, 150);
constexpr double kHaloWidth = 1.6;

struct OptionAction {
    const char* action;
    const char* setting;
    bool model::ViewOptions::*member;
};
constexpr std::array<OptionAction, 10> kOptionActions{
    {{"view.changed", "view/showsChanged", &model::ViewOptions::showsChanged},
     {"view.edges", "view/showsEdges", &model::ViewOptions::showsEdges},
     {"view.levels", "view/showsLevels", &model::ViewOptions::showsLevels},
     {"view.box", "view/showsBox", &model::ViewOptions::showsBox},
     {"view.axes", "view/showsAxes", &model::ViewOptions::showsAxes},
     {"view.readout", "view/showsReadout", &model::ViewOptions::showsReadout},
     {"view.cube", "view/showsCube", &model::ViewOptions::showsCube},
     {"view.scaleBar", "view/showsScaleBar", &model::ViewOptions::showsScaleBar},
     {"view.ticks", "view/showsTicks", &model::ViewOptions::showsTicks},
     {"colour.bar", "view/showsColourBar", &model::ViewOptions::showsColourBar}}};

constexpr std::array<const char*, 12> kClipActions{{"clip.crop", "clip.resetCrop", "clip.plane", "clip.second",
                                                    "clip.flip", "clip.facing", "clip.acrossX", "clip.acrossY",
                                                    "clip.acrossZ", "clip.noCap", "clip.colourCap", "clip.valueCap"}};

struct ViewAction {
    const char* action;
    model::StandardView view;
};
constexpr std::array<ViewAction, 6> kViewActions{{{"view.front", model::StandardView::Front},
                                                  {"view.back", model::StandardView::Back},
                                                  {"view.right", model::StandardView::Right},
                                                  {"view.left", model::StandardView::Left},
                                                  {"view.top", model::StandardView::Top},
                                                  {"view.bottom", model::StandardView::Bottom}}};

/// A driver may do better with the other way than is known of it.
PictureWay wantedPictureWay() {
    const QString wanted = qEnvironmentVariable("ISOSLIDER_PICTURES");
    return wanted == QLatin1String("textures") ? PictureWay::Textures
           : wanted == QLatin1String("images") ? PictureWay::Images
                                               : PictureWay::Best;
}

QString indexText(model::IndexState state) {
    switch (state) {
        case model::IndexState::None: return ViewportHost::tr("there is no index yet");
        case model::IndexState::Building: return ViewportHost::tr("the index is being built");
        case model::IndexState::Ready: return ViewportHost::tr("the index is ready");
        case model::IndexState::Failed: return ViewportHost::tr("the index could not be built");
        case model::IndexState::Cancelled: return ViewportHost::tr("building the index was cancelled");
    }
    return {};
}

// As a colour of the scene is seen.
QString swatch(const glm::vec3& linear) {
    const auto seen = [](float part) { return std::pow(static_cast<double>(part), 1.0 / 2.2); };
    const QColor colour = QColor::fromRgbF(seen(linear.r), seen(linear.g), seen(linear.b));
    return QStringLiteral("<span style=\"color:%1\">■</span>&nbsp;").arg(colour.name());
}

// The colours of merged cells, and how many cells a side each stands for.
QString levelsText() {
    const render::SceneColours colours;
    QString text;
    for (std::size_t level = 0; level < colours.levels.size(); ++level)
        text += QStringLiteral("%1%2&nbsp;&nbsp; ").arg(swatch(colours.levels[level])).arg(1 << level);
    return text + ViewportHost::tr("cells a side");
}

QString changedText() {
    return swatch(glm::vec3(render::SceneColours().highlight)) + ViewportHost::tr("retriangulated by the last move");
}

} // namespace

ViewportHost::ViewportHost(model::Session& session, SettingsStore& settings, const ActionRegistry& actions,
                           QWidget* parent)
    : QWidget(parent), session_(session) {
    if (render::isOpenGlUsable())
        view_ = viewport_ = new ViewportWidget(this, wantedPictureWay());
    else
        view_ = makeFallback();
    new FocusFrame(*view_);
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->addWidget(view_);
    axes_ = new AxesGlyph(this);
    readout_ = new ViewReadout(this);
    readout_->setObjectName(QStringLiteral("viewReadout"));
    preview_ = new ViewReadout(this, kPreviewColour);
    preview_->setObjectName(QStringLiteral("previewLabel"));
    legend_ = new ViewReadout(this);
    legend_->setObjectName(QStringLiteral("legend"));
    legend_->setTextFormat(Qt::RichText);
    loading_ = new LoadingCard(session_, this);
    startPage_ = new StartPage(actions, this);
    startPage_->installEventFilter(this);
    connectActions(settings, actions);
    colours_ = std::make_unique<model::ColourModel>(session_, viewState_);
    connectViews(actions);
    connectGraphics();
    optionsSubscription_ = viewState_.observe([this] { applyOptions(); });
    datasetSubscription_ = session_.datasetChanged().observe([this] { showState(); });
    frameSubscription_ = session_.frameChanged().observe([this] { showFrame(); });
    surfacesSubscription_ = session_.surfaces().observe([this] {
        showSurfaces();
        showReadout();
    });
    inactiveSubscription_ = session_.inactiveChanged().observe([this] { showSurfaces(); });
    secondSubscriptions_[0] = session_.secondVolume().changed().observe([this] { showSurfaces(); });
    secondSubscriptions_[1] = session_.secondVolume().surfaces().observe([this] { showSurfaces(); });
    applyOptions();
    showFrame();
}

ViewportHost::~ViewportHost() = default;

QWidget* ViewportHost::makeFallback() {
    auto* label = new QLabel(tr("OpenGL 3.3 is not available, so the surface cannot be drawn: %1.\n"
                                "The panels still work: isovalue, levels, mesh check and export.\n"
                                "Install or enable a graphics driver with OpenGL 3.3 to see the surface.")
                                 .arg(render::openGlProblem()),
                             this);
    label->setTextFormat(Qt::PlainText); // drivers name themselves
    label->setObjectName(QStringLiteral("viewportFallback"));
    label->setAlignment(Qt::AlignCenter);
    label->setWordWrap(true);
    label->setMargin(24);
    label->setFocusPolicy(Qt::StrongFocus);
    return label;
}

void ViewportHost::connectActions(SettingsStore& settings, const ActionRegistry& actions) {
    model::ViewOptions options;
    for (const auto& entry : kOptionActions) {
        options.*entry.member = settings.boolean(entry.setting);
        QAction* action = actions.action(entry.action);
        action->setChecked(options.*entry.member);
        connect(action, &QAction::toggled, this, [this, &settings, entry](bool isShown) {
            auto changed = viewState_.options();
            changed.*entry.member = isShown;
            viewState_.setOptions(changed);
            settings.set(entry.setting, isShown);
        });
    }
    viewState_.setOptions(options);
    actionsSubscription_ = viewState_.observe([this, &actions] {
        for (const auto& entry : kOptionActions)
            actions.action(entry.action)->setChecked(viewState_.options().*entry.member);
    });
}

void ViewportHost::connectViews(const ActionRegistry& actions) {
    const bool hasView = viewport_ != nullptr;
    actions.action("view.reset")->setEnabled(hasView);
    actions.action("view.perspective")->setEnabled(hasView);
    for (const auto& entry : kViewActions)
        actions.action(entry.action)->setEnabled(hasView);
    if (!hasView) {
        actions.action("view.fit")->setEnabled(false);
        actions.action("view.measure")->setEnabled(false);
        for (const char* id : kClipActions)
            actions.action(id)->setEnabled(false);
        return;
    }
    flight_ = new CameraFlight(*viewport_);
    firstView_ = new FirstView(session_, viewState_, *viewport_, this);
    guides_ = new SceneGuides(session_, {*viewport_, viewState_, *flight_, *colours_}, actions, this);
    coloursSubscription_ = colours_->observe([this] { viewport_->setColours(colours_->colours()); });
    measure_ = new MeasureTool(session_, viewState_, *viewport_, *actions.action("view.measure"), this);
    clip_ = new ClipTool(session_, viewState_, *viewport_, actions, this);
    connect(viewport_, &ViewportWidget::cameraChanged, this,
            [this] { axes_->setOrientation(viewport_->camera().orientation()); });
    connect(viewport_, &ViewportWidget::cameraChanged, this,
            &ViewportHost::reachSecond); // what is shown may be stretched
    connect(viewport_, &ViewportWidget::stepRequested, this, [this](double step) { session_.isovalue().step(step); });
    connect(actions.action("view.reset"), &QAction::triggered, firstView_, &FirstView::reset);
    connect(actions.action("view.perspective"), &QAction::toggled, this, [this](bool isPerspective) {
        viewport_->changeCamera([isPerspective](model::Camera& camera) { camera.setPerspective(isPerspective); });
    });
    for (const auto& entry : kViewActions)
        connect(actions.action(entry.action), &QAction::triggered, this, [this, view = entry.view] {
            viewport_->changeCamera([view](model::Camera& camera) { camera.setStandardView(view); });
        });
    axes_->setOrientation(viewport_->camera().orientation());
}

void ViewportHost::connectGraphics() {
    if (viewport_ == nullptr)
        return;
    connect(viewport_, &ViewportWidget::behindChanged, this, [this](bool isBehind) { session_.holdMoves(isBehind); });
    // Queued: both come from within a paint.
    connect(viewport_, &ViewportWidget::surfaceRefused, this, &ViewportHost::showCoarser, Qt::QueuedConnection);
    connect(
        viewport_, &ViewportWidget::graphicsLost, this,
        [this] {
            session_.post(
                {model::Notice::Severity::Error, tr("The graphics card was reset and has not come back").toStdString(),
                 tr("The panels still work. If the picture stays away, start the program again").toStdString(),
                 ErrorCode::IoError});
        },
        Qt::QueuedConnection);
}

void ViewportHost::showCoarser(std::uint64_t refusedBytes) {
    const auto isOf = [refusedBytes](const auto& owner) {
        const auto& surfaces = owner.surfaces().list().surfaces;
        return std::any_of(surfaces.begin(), surfaces.end(), [&](const model::ListedSurface& surface) {
            const auto picture = owner.pictureOf(surface.id);
            return picture && extract::pictureBytes(*picture) == refusedBytes;
        });
    };
    const bool isShown = isOf(session_) || isOf(session_.secondVolume());
    if (!isShown)
        return; // another one is on its way already
    if (refusedBytes >= kLeastPictureBytes)
        return session_.limitPicture(refusedBytes / 2);
    session_.post({model::Notice::Severity::Error, tr("The graphics card has no memory for any surface").toStdString(),
                   tr("The panels still work. Close other programs that draw").toStdString(), ErrorCode::OutOfSpace});
}

void ViewportHost::reportWhatIsDrawn() {
    const auto frame = session_.frame();
    const auto merged = frame ? frame->mergedCells : 1;
    const auto reported = std::exchange(reportedMergedCells_, merged > 1 ? std::max(merged, reportedMergedCells_) : 1);
    if (merged > reported)
        session_.post(
            {model::Notice::Severity::Error, tr("The graphics card has no memory for this surface").toStdString(),
             tr("It has %1 triangles; drawn is a coarser one of %2, its vertices merged in blocks of %3 cells along each "
                "axis. Meshes are checked and exported whole")
                 .arg(grouped(frame->stats.triangles), grouped(frame->indices.size() / 3))
                 .arg(merged)
                 .toStdString(),
             ErrorCode::OutOfSpace});
    else if (frame && merged == 1 && reported > 1)
        session_.post({model::Notice::Severity::Information, tr("The surface is drawn whole again").toStdString(), {}});
}

QString ViewportHost::standInText() const {
    QStringList lines;
    const auto step = session_.shownStep();
    if (step > 1)
        lines << tr("preview at 1:%1\none of %1 samples along each axis\n%2")
                     .arg(step)
                     .arg(indexText(session_.indexState()));
    if (const auto frame = session_.frame(); frame && frame->mergedCells > 1)
        lines
            << tr("coarser surface: vertices merged in blocks of %1 cells\nthe graphics card has no memory for the whole one")
                   .arg(frame->mergedCells);
    return lines.join(QLatin1Char('\n'));
}

void ViewportHost::showFrame() {
    if (viewport_ != nullptr) {
        firstView_->follow();
        showSurfaces();
    }
    showReadout();
    reportWhatIsDrawn();
    showState();
}

void ViewportHost::showReadout() {
    const auto frame = session_.frame();
    const auto* dataset = session_.dataset();
    if (!frame)
        return;
    const auto text = [](const std::string& s) { return QString::fromStdString(s); };
    const auto* active = session_.surfaces().canRemove() ? session_.surfaces().active() : nullptr;
    QString lines = active != nullptr ? text(active->name) + QLatin1Char('\n') : QString();
    lines += (frame->region ? tr("isovalue %1\n%2 triangles about the crop box") : tr("isovalue %1\n%2 triangles"))
                 .arg(text(dataset != nullptr ? model::isovalueText(frame->isovalue, dataset->min, dataset->max)
                                              : model::valueText(frame->isovalue, 7)),
                      text(model::groupedText(frame->stats.triangles)));
    if (frame->mergeBound.limit > 0.0 && dataset != nullptr)
        lines +=
            tr(", error %1")
                .arg(text(model::DetailModel::text(extract::errorOf(frame->mergeBound, dataset->min, dataset->max))));
    readout_->setText(lines + QLatin1Char('\n') +
                      text(model::millisecondsText(frame->stats.updateMs + frame->stats.interpolateMs)));
    readout_->adjustSize();
}

void ViewportHost::showSurfaces() {
    const auto* dataset = session_.dataset();
    const auto& list = session_.surfaces().list();
    if (viewport_ == nullptr)
        return;
    render::SurfaceLook look;
    std::vector<render::InactiveSurface> inactive;
    for (const model::ListedSurface& surface : list.surfaces) {
        if (surface.id == list.active)
            look = render::lookOf(surface);
        else if (auto picture = session_.pictureOf(surface.id); picture && surface.isVisible)
            inactive.push_back({surface.id, std::move(picture), render::lookOf(surface), surface.hiddenPieces});
    }
    addSecond(inactive);
    reachSecond();
    // The list states each isovalue that the handle asks for: without a new picture there is nothing to draw.
    const auto volume = dataset != nullptr ? std::optional(dataset->geometry) : std::nullopt;
    auto picture = session_.pictureOf(list.active);
    if (picture != drawnPicture_ || volume != drawnVolume_)
        viewport_->setFrame(picture, volume);
    drawnPicture_ = std::move(picture);
    drawnVolume_ = volume;
    viewport_->setSurfaces(look, std::move(inactive));
}

void ViewportHost::addSecond(std::vector<render::InactiveSurface>& surfaces) {
    const auto& second = session_.secondVolume();
    for (const model::ListedSurface& surface : second.surfaces().list().surfaces)
        if (auto picture = second.pictureOf(surface.id); picture && surface.isVisible)
            surfaces.push_back({model::SurfaceId{static_cast<std::uint32_t>(surface.id) | kSecondVolume},
                                std::move(picture), render::lookOf(surface), surface.hiddenPieces, false});
}

void ViewportHost::reachSecond() {
    const auto* first = session_.dataset();
    const auto* second = session_.secondVolume().dataset();
    const bool areThere = first != nullptr && second != nullptr;
    const model::Camera& camera = viewport_->camera();
    const double reach = areThere ? model::reachOf(second->geometry.dims,
                                                   glm::dmat4(camera.stretch()) *
                                                       render::indexToCentredWorld(second->geometry, first->geometry))
                                  : 0.0;
    if (reach != camera.reach())
        viewport_->changeCamera([reach](model::Camera& changed) { changed.setReach(reach); });
}

void ViewportHost::showState() {
    const bool isEmpty = session_.dataset() == nullptr && !session_.isLoading();
    startPage_->setVisible(isEmpty);
    loading_->showState();
    const auto& options = viewState_.options();
    axes_->setPatient(session_.dataset() != nullptr && model::isPatientSpace(*session_.dataset()));
    areAxesWanted_ = options.showsAxes && viewport_ != nullptr && session_.dataset() != nullptr;
    isReadoutWanted_ = options.showsReadout && viewport_ != nullptr && session_.frame() != nullptr;
    preview_->setText(standInText());
    preview_->setVisible(!preview_->text().isEmpty());
    placeOverlays();
}

void ViewportHost::applyOptions() {
    session_.markChanges(viewState_.options().showsChanged);
    if (viewport_ != nullptr)
        viewport_->setOptions(viewState_.options());
    axes_->setOnLight(isLight(viewState_.options().stage.background));
    showState();
}

bool ViewportHost::fits(const QWidget& overlay) const {
    return overlay.width() + 2 * kOverlayMargin <= width() && overlay.height() + 2 * kOverlayMargin <= height();
}

void ViewportHost::placeOverlays() {
    const auto centreOn = [this](QWidget* overlay) {
        overlay->resize(overlay->sizeHint().boundedTo(size()));
        overlay->move((width() - overlay->width()) / 2, std::max(0, (height() - overlay->height()) / 2));
    };
    // What stands in for the surface is always said; the rest gives way.
    readout_->setVisible(isReadoutWanted_ && fits(*readout_));
    axes_->setVisible(areAxesWanted_ && width() >= 2 * axes_->width() && height() >= 2 * axes_->height());
    readout_->move(kOverlayMargin, kOverlayMargin);
    preview_->setWordWrap(false);
    preview_->adjustSize();
    if (!fits(*preview_)) {
        const int room = std::max(1, width() - 2 * kOverlayMargin);
        preview_->setWordWrap(true);
        preview_->resize(room, preview_->heightForWidth(room));
    }
    preview_->move(kOverlayMargin,
                   readout_->isHidden() ? kOverlayMargin : readout_->geometry().bottom() + kOverlaySpacing);
    const auto frame = session_.frame();
    const bool isMerged = frame && frame->mergeBound.limit > 0.0 && frame->bricks != nullptr;
    QStringList legend;
    if (viewState_.options().showsLevels && isMerged)
        legend << levelsText();
    if (viewState_.options().showsChanged && frame)
        legend << changedText();
    if (const auto& stretch = viewState_.options().stage.stretch; frame && model::isStretched(stretch))
        legend << tr("stretched: %1")
                      .arg(QString::fromStdString(model::stretchText(stretch, model::AxisNames(frame->geometry))));
    legend_->setText(legend.join(QStringLiteral("<br>")));
    legend_->adjustSize();
    legend_->setVisible(!legend.isEmpty() && fits(*legend_));
    int below = kOverlayMargin;
    for (const QWidget* above : {static_cast<const QWidget*>(readout_), static_cast<const QWidget*>(preview_)})
        if (!above->isHidden())
            below = std::max(below, above->geometry().bottom() + kOverlaySpacing);
    legend_->move(kOverlayMargin, below);
    axes_->move(4, height() - axes_->height() - 4);
    centreOn(startPage_);
    centreOn(loading_);
}

QImage ViewportHost::picture() {
    if (viewport_ == nullptr)
        return {};
    QImage picture = viewport_->grabFramebuffer();
    if (!picture.isNull())
        paintAbove(picture);
    return picture;
}

// As the camera stands now: it may have moved on by the time that the surface is drawn.
ViewportHost::OrderedPicture ViewportHost::orderPicture(const PictureChoice& choice) {
    const QSize size = choice.sizeOf(pictureSize());
    OrderedPicture ordered{size.isEmpty() ? nullptr : viewport_->orderPicture(size, choice.isTransparent), {}, {}};
    if (ordered.scene == nullptr)
        return ordered;
    ordered.above = QImage(size, QImage::Format_ARGB32_Premultiplied);
    ordered.above.fill(Qt::transparent);
    paintAbove(ordered.above);
    if (choice.isTransparent) { // words are as light or dark as the background that they were made for is not
        ordered.halo = model::isLight(viewState_.options().stage.background) ? kLightHalo : kDarkHalo;
        ordered.haloPixels = kHaloWidth * size.width() / std::max(1, viewport_->width());
    }
    return ordered;
}

QSize ViewportHost::pictureSize() const {
    return viewport_ != nullptr ? QSize(viewport_->pixels().x, viewport_->pixels().y) : QSize();
}

void ViewportHost::paintAbove(QImage& picture) {
    QPainter painter(&picture);
    painter.scale(static_cast<double>(picture.width()) / std::max(1, viewport_->width()),
                  static_cast<double>(picture.height()) / std::max(1, viewport_->height()));
    guides_->paint(painter);
    measure_->view().paint(painter);
    if (axes_->isHidden())
        return;
    painter.translate(viewport_->mapFrom(this, axes_->pos()));
    axes_->paint(painter);
}

void ViewportHost::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    placeOverlays();
}

bool ViewportHost::eventFilter(QObject* watched, QEvent* event) {
    if (watched == startPage_ && event->type() == QEvent::LayoutRequest)
        placeOverlays();
    return QWidget::eventFilter(watched, event);
}

} // namespace isoslider::widgets
