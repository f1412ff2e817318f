#pragma once

#include <memory>
#include <optional>
#include <string>

#include <QTimer>
#include <QWidget>

#include "core/extract/pieces/piece_measures.h"
#include "core/extract/pieces/surface_pieces.h"
#include "ui/model/jobs/latest_job.h"

namespace isoslider::widgets {

class FactForm;

/// One piece of the surface: its box, area and the volume that it encloses, which a job measures once the surface
/// rests.
class PieceDetails : public QWidget {
    Q_OBJECT
public:
    explicit PieceDetails(model::MainThread postToMain, QWidget* parent = nullptr);

    /// Nothing for no piece, and where the frame has none of that number. `frame` may be null. `unit`: of length;
    /// empty where it is not known.
    void show(std::shared_ptr<const extract::SurfaceFrame> frame, std::optional<extract::PieceId> piece,
              const std::string& unit);

private:
    void measure();
    void showFacts();

    FactForm* form_;
    std::shared_ptr<const extract::SurfaceFrame> frame_;
    std::optional<std::size_t> piece_; ///< its place among the frame's
    std::optional<extract::PieceId> id_;
    std::string unit_;
    std::optional<extract::PieceMeasures> measures_; ///< of `frame_`
    QTimer timer_;
    model::LatestJob<extract::PieceMeasures> job_; // last: nothing is reported once it is gone
};

} // namespace isoslider::widgets
