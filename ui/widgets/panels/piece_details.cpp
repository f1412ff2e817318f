#include "ui/widgets/panels/piece_details.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/panels/fact_texts.h"

namespace isoslider::widgets {
namespace {

constexpr int kRestMs = 150; // a surface that slides is not measured at every step

QString lengthText(double length) { return QString::fromStdString(model::valueText(length, 5)); }

QString boxText(const extract::Piece& piece, const GridGeometry& geometry, const std::string& unit) {
    std::array<QString, 3> sides;
    for (std::size_t axis = 0; axis < 3; ++axis)
        sides[axis] =
            lengthText((piece.high[axis] - piece.low[axis]) * std::abs(geometry.spacing[static_cast<int>(axis)]));
    return inLengthUnit(QStringLiteral("%1 × %2 × %3").arg(sides[0], sides[1], sides[2]), unit);
}

QString volumeText(const extract::PieceMeasures& measures, const std::string& unit) {
    if (!measures.isClosed)
        return PieceDetails::tr("– (open)");
    const QString volume = inLengthUnit(lengthText(std::abs(measures.volume)), unit, 3);
    return measures.volume < 0.0 ? PieceDetails::tr("%1 of lower values").arg(volume) : volume;
}

} // namespace

PieceDetails::PieceDetails(model::MainThread postToMain, QWidget* parent)
    : QWidget(parent), form_(new FactForm(this)), job_(std::make_shared<model::BackgroundJobs>(std::move(postToMain))) {
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    form_->setObjectName(QStringLiteral("pieceForm"));
    layout->addWidget(form_);
    timer_.setSingleShot(true);
    timer_.setInterval(kRestMs);
    connect(&timer_, &QTimer::timeout, this, &PieceDetails::measure);
    setVisible(false);
}

void PieceDetails::show(std::shared_ptr<const extract::SurfaceFrame> frame, std::optional<extract::PieceId> piece,
                        const std::string& unit) {
    std::optional<std::size_t> place;
    if (frame && frame->pieces && piece) {
        const auto pieces = frame->pieces->pieces();
        const auto found =
            std::find_if(pieces.begin(), pieces.end(), [&](const extract::Piece& each) { return each.id == *piece; });
        if (found != pieces.end())
            place = static_cast<std::size_t>(found - pieces.begin());
    }
    if (!place)
        frame.reset(); // nothing is kept that nobody sees
    if (frame == frame_ && piece == id_ && unit == unit_)
        return;
    job_.cancel();
    timer_.stop();
    const bool isSamePiece = piece == id_;
    frame_ = std::move(frame);
    piece_ = place;
    id_ = piece;
    unit_ = unit;
    if (!isSamePiece)
        measures_.reset();
    if (piece_)
        timer_.start();
    setVisible(piece_.has_value());
    form_->setEnabled(false); // the numbers are of the surface before
    showFacts();
}

void PieceDetails::measure() {
    job_.start(
        "Measure a piece",
        [frame = frame_, piece = *piece_](const JobControl& job) { return extract::measurePiece(*frame, piece, job); },
        [this](const Result<extract::PieceMeasures>& measured) {
            if (!measured.isOk())
                return; // there was no memory for it: the other facts stand
            measures_ = measured.value();
            form_->setEnabled(true);
            showFacts();
        });
}

void PieceDetails::showFacts() {
    if (!piece_)
        return form_->setFacts({});
    const extract::Piece& piece = frame_->pieces->pieces()[*piece_];
    const QString waiting = QStringLiteral("…");
    form_->setFacts({{tr("Piece %1").arg(piece.id.number() + 1), tr("%1 triangles").arg(grouped(piece.triangles)), {}},
                     {tr("Box"), boxText(piece, frame_->geometry, unit_), tr("To one step of the grid")},
                     {tr("Area"), measures_ ? inLengthUnit(lengthText(measures_->area), unit_, 2) : waiting, {}},
                     {tr("Enclosed volume"), measures_ ? volumeText(*measures_, unit_) : waiting,
                      tr("Of a piece that is closed. Around lower values it is a hollow")}});
}

} // namespace isoslider::widgets
