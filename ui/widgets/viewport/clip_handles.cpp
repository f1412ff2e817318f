#include "ui/widgets/viewport/clip_handles.h"

#include <algorithm>
#include <array>

#include <QFontMetricsF>
#include <QLineF>

#include <glm/matrix.hpp>

#include "ui/model/slices/cap_samples.h"
#include "ui/render/slice_planes.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::widgets {
namespace {

constexpr double kReach = 12.0; // of the pointer
constexpr double kRadius = 5.0, kLarge = 7.0;
constexpr double kNormalShare = 0.3; // of the scene's radius
constexpr int kOutlineAlpha = 110;
constexpr double kPadding = 5.0, kHandleGap = 12.0; // of the text
const QColor kCropInk(250, 168, 76), kPlaneInk(115, 204, 250);
const QColor kShadow(20, 22, 26, 190);

} // namespace

ClipHandles::ClipHandles(ViewportWidget& viewport) : QWidget(&viewport), viewport_(viewport) {
    setObjectName(QStringLiteral("clipHandles"));
    setAttribute(Qt::WA_TransparentForMouseEvents);
    hide();
}

void ClipHandles::show(const model::Clipping& clipping, const std::optional<GridGeometry>& volume) {
    clipping_ = clipping;
    volume_ = volume;
    handles_.clear();
    if (volume_ && clipping.isCropped)
        for (int axis = 0; axis < 3; ++axis)
            for (const bool isHigh : {false, true})
                handles_.push_back({ClipHandle::Kind::Face, axis, isHigh});
    if (volume_ && clipping.plane().isOn) {
        handles_.push_back({ClipHandle::Kind::Plane});
        handles_.push_back({ClipHandle::Kind::Normal});
        // The middle of what is seen of the plane; near its edge-on end at least near the volume.
        const auto border = render::borderOf(model::capPlaneOf(clipping.plane(), *volume_, 1), volume_->dims);
        glm::dvec3 middle(0.0);
        for (const glm::vec3& corner : border)
            middle += glm::dvec3(corner) / static_cast<double>(border.size());
        planeMiddle_ = border.empty() ? clipping.plane().normal * clipping.plane().offset
                                      : model::centredWorldOf(middle, *volume_, *volume_);
    }
    setGeometry(viewport_.rect());
    setVisible(!handles_.empty());
    update();
}

void ClipHandles::highlight(const std::optional<ClipHandle>& handle, const QString& text) {
    if (highlighted_ == handle && text_ == text)
        return;
    highlighted_ = handle;
    text_ = text;
    update();
}

// As long on screen however lengths are stretched.
double ClipHandles::normalLength() const {
    const model::Camera& camera = viewport_.camera();
    return kNormalShare * camera.sceneRadius() / glm::length(camera.stretch() * clipping_.plane().normal);
}

glm::dvec3 ClipHandles::placeOf(const ClipHandle& handle) const {
    if (handle.kind == ClipHandle::Kind::Plane)
        return planeMiddle_;
    if (handle.kind == ClipHandle::Kind::Normal)
        return planeMiddle_ + normalLength() * clipping_.plane().normal;
    const model::CropBox box = model::cropWithin(clipping_.crop, volume_->dims);
    glm::dvec3 place(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        place[axis] = 0.5 * static_cast<double>(box.low[a] + box.high[a]);
        if (axis == handle.axis)
            place[axis] = static_cast<double>(handle.isHigh ? box.high[a] : box.low[a]);
    }
    return model::centredWorldOf(place, *volume_, *volume_);
}

std::optional<QPointF> ClipHandles::pointOf(const ClipHandle& handle) const { return pointOf(placeOf(handle)); }

std::optional<QPointF> ClipHandles::pointOf(const glm::dvec3& place) const {
    const model::Camera& camera = viewport_.camera();
    const double aspect = static_cast<double>(viewport_.width()) / std::max(1, viewport_.height());
    const glm::dvec4 clip = camera.projectionMatrix(aspect) * camera.viewMatrix() * glm::dvec4(place, 1.0);
    if (!(clip.w > 0.0))
        return std::nullopt;
    return QPointF((clip.x / clip.w + 1.0) / 2.0 * viewport_.width(),
                   (1.0 - clip.y / clip.w) / 2.0 * viewport_.height());
}

std::pair<glm::dvec3, glm::dvec3> ClipHandles::lineOfSight(QPointF point) const {
    const model::Camera& camera = viewport_.camera();
    const double aspect = static_cast<double>(viewport_.width()) / std::max(1, viewport_.height());
    const glm::dmat4 toWorld = glm::inverse(camera.projectionMatrix(aspect) * camera.viewMatrix());
    const glm::dvec2 screen(2.0 * point.x() / std::max(1, viewport_.width()) - 1.0,
                            1.0 - 2.0 * point.y() / std::max(1, viewport_.height()));
    const auto at = [&](double depth) {
        const glm::dvec4 place = toWorld * glm::dvec4(screen, depth, 1.0);
        return glm::dvec3(place) / place.w;
    };
    return {at(-1.0), at(1.0)};
}

std::optional<ClipHandle> ClipHandles::handleAt(QPointF point) const {
    std::optional<ClipHandle> nearest;
    double least = kReach;
    for (const ClipHandle& handle : handles_)
        if (const auto at = pointOf(handle); at && QLineF(*at, point).length() <= least) {
            least = QLineF(*at, point).length();
            nearest = handle;
        }
    return nearest;
}

void ClipHandles::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    paintBox(painter);
    const auto middle = pointOf(planeMiddle_);
    const auto tip = pointOf(planeMiddle_ + normalLength() * clipping_.plane().normal);
    if (volume_ && clipping_.plane().isOn && middle && tip)
        for (const auto& [colour, width] : {std::pair(kShadow, 4.5), std::pair(kPlaneInk, 2.0)}) {
            painter.setPen(QPen(colour, width, Qt::SolidLine, Qt::RoundCap));
            painter.drawLine(*middle, *tip);
        }
    for (const ClipHandle& handle : handles_)
        if (const auto point = pointOf(handle))
            paintHandle(painter, handle, *point);
}

void ClipHandles::paintBox(QPainter& painter) const {
    if (!volume_ || !clipping_.isCropped)
        return;
    const model::CropBox box = model::cropWithin(clipping_.crop, volume_->dims);
    const auto corner = [&](const std::array<bool, 3>& isHigh) {
        glm::dvec3 place(0.0);
        for (std::size_t a = 0; a < 3; ++a)
            place[static_cast<int>(a)] = static_cast<double>(isHigh[a] ? box.high[a] : box.low[a]);
        return pointOf(model::centredWorldOf(place, *volume_, *volume_));
    };
    QColor faint = kCropInk;
    faint.setAlpha(kOutlineAlpha);
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 4; ++side) {
            std::array<bool, 3> isHigh{};
            const std::size_t first = (axis + 1) % 3, second = (axis + 2) % 3;
            isHigh[first] = (side & 1) != 0;
            isHigh[second] = (side & 2) != 0;
            const auto from = corner(isHigh);
            isHigh[axis] = true;
            const auto to = corner(isHigh);
            if (!from || !to)
                continue;
            // That of the face whose handle is held stands out.
            const bool isOfFace = highlighted_ && highlighted_->kind == ClipHandle::Kind::Face &&
                                  highlighted_->axis != static_cast<int>(axis) &&
                                  isHigh[static_cast<std::size_t>(highlighted_->axis)] == highlighted_->isHigh;
            painter.setPen(QPen(isOfFace ? kCropInk : faint, isOfFace ? 2.0 : 1.0));
            painter.drawLine(*from, *to);
        }
}

void ClipHandles::paintHandle(QPainter& painter, const ClipHandle& handle, QPointF point) const {
    const bool isHighlighted = handle == highlighted_;
    const double radius = isHighlighted ? kLarge : kRadius;
    painter.setPen(QPen(kShadow, 2.0));
    painter.setBrush(handle.kind == ClipHandle::Kind::Face ? kCropInk : kPlaneInk);
    if (handle.kind == ClipHandle::Kind::Plane)
        painter.drawRect(QRectF(point - QPointF(radius, radius), QSizeF(2.0 * radius, 2.0 * radius)));
    else
        painter.drawEllipse(point, radius, radius);
    if (!isHighlighted || text_.isEmpty())
        return;
    const QFontMetricsF metrics(painter.font());
    QRectF plate(0.0, 0.0, metrics.horizontalAdvance(text_) + 2.0 * kPadding, metrics.height() + kPadding);
    plate.moveCenter(point + QPointF(0.0, -kHandleGap - plate.height() / 2.0));
    plate.moveLeft(std::clamp(plate.left(), 0.0, std::max(0.0, width() - plate.width())));
    plate.moveTop(plate.top() < 0.0 ? point.y() + kHandleGap : plate.top());
    painter.setPen(Qt::NoPen);
    painter.setBrush(kShadow);
    painter.drawRoundedRect(plate, 5.0, 5.0);
    painter.setPen(handle.kind == ClipHandle::Kind::Face ? kCropInk : kPlaneInk);
    painter.drawText(plate, Qt::AlignCenter, text_);
}

} // namespace isoslider::widgets
