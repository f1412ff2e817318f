#include "ui/widgets/panels/piece_details.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <QVBoxLayout>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
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
    const QString volume = inLengthUnit(fromStd(model::measureText(std::abs(measures.volume))), unit, 3);
    return measures.volume < 0.0 ? PieceDetails::tr("%1 of lower values").arg(volume) : volume;
}

QString scalarText(double scalar) { return QString::fromStdString(model::valueText(scalar, 5)); }

Fact persistenceFact(const std::optional<Result<topology::PiecePersistence>>& found) {
    const QString name = PieceDetails::tr("Persistence");
    if (!found)
        return {name, QStringLiteral("…"), {}};
    if (!found->isOk())
        return {name, QStringLiteral("–"), QString::fromStdString(found->error().message)};
    const topology::PiecePersistence& life = found->value();
    const bool isAbove = life.side == topology::Side::Above;
    const QString number = scalarText(life.persistence);
    if (life.lasts)
        return {name, number, PieceDetails::tr("The piece lasts through all values of the volume")};
    const QString from = scalarText(isAbove ? life.ends : life.comes),
                  to = scalarText(isAbove ? life.comes : life.ends);
    if (life.isAtLeast)
        return {name, PieceDetails::tr("at least %1").arg(number),
                PieceDetails::tr("The piece lasts from %1 to %2 and longer. It is so large that no more was looked at")
                    .arg(from, to)};
    return {name, PieceDetails::tr("%1 (from %2 to %3)").arg(number, from, to),
            isAbove ? PieceDetails::tr("What the piece has round higher values joins a higher peak where the isovalue "
                                       "falls to %1, and is gone beyond %2")
                          .arg(from, to)
                    : PieceDetails::tr("What the piece has round lower values is there from %1 on, and joins a deeper "
                                       "pit where the isovalue rises beyond %2")
                          .arg(from, to)};
}

} // namespace

PieceDetails::PieceDetails(model::Session& session, QWidget* parent)
    : QWidget(parent),
      session_(session),
      form_(new FactForm(this)),
      finder_(std::make_shared<model::PersistenceFinder>()),
      jobs_(std::make_shared<model::BackgroundJobs>(session.services().postToMain)),
      measuring_(jobs_),
      persisting_(jobs_) {
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
    measuring_.cancel();
    persisting_.cancel();
    timer_.stop();
    const bool isSamePiece = piece == id_;
    frame_ = std::move(frame);
    piece_ = place;
    id_ = piece;
    unit_ = unit;
    if (!isSamePiece) {
        measures_.reset();
        persistence_.reset();
    }
    if (piece_)
        timer_.start();
    else
        finder_ = std::make_shared<model::PersistenceFinder>(); // and so its samples go
    setVisible(piece_.has_value());
    form_->setEnabled(false); // the numbers are of the surface before
    showFacts();
}

void PieceDetails::measure() {
    measuring_.start(
        "Measure a piece",
        [frame = frame_, piece = *piece_](const JobControl& job) { return extract::measurePiece(*frame, piece, job); },
        [this](const Result<extract::PieceMeasures>& measured) {
            if (!measured.isOk())
                return; // there was no memory for it: the other facts stand
            measures_ = measured.value();
            persistence_.reset(); // it was of the surface before
            form_->setEnabled(true);
            showFacts();
            findPersistence();
        });
}

void PieceDetails::findPersistence() {
    const auto* dataset = session_.dataset();
    if (dataset == nullptr)
        return;
    persisting_.start(
        "Find how long a piece lasts",
        [frame = frame_, piece = *piece_, dataset = *dataset, grid = session_.samples(),
         finder = finder_](const JobControl& job) { return finder->find(*frame, piece, dataset, grid, job); },
        [this](Result<topology::PiecePersistence> found) {
            persistence_ = std::move(found);
            showFacts();
        });
}

void PieceDetails::showFacts() {
    if (!piece_)
        return form_->setFacts({});
    const extract::Piece& piece = frame_->pieces->pieces()[*piece_];
    const QString waiting = QStringLiteral("…");
    form_->setFacts(
        {{tr("Piece %1").arg(piece.id.number() + 1), tr("%1 triangles").arg(grouped(piece.triangles)), {}},
         {tr("Box"), boxText(piece, frame_->geometry, unit_), tr("To one step of the grid")},
         {tr("Area"), measures_ ? inLengthUnit(fromStd(model::measureText(measures_->area)), unit_, 2) : waiting, {}},
         {tr("Enclosed volume"), measures_ ? volumeText(*measures_, unit_) : waiting,
          tr("Of a piece that is closed. Around lower values it is a hollow")},
         persistenceFact(persistence_)});
}

} // namespace isoslider::widgets
