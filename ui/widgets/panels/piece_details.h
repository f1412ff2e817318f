#pragma once

#include <memory>
#include <optional>
#include <string>

#include <QTimer>
#include <QWidget>

#include "core/extract/pieces/piece_measures.h"
#include "core/extract/pieces/surface_pieces.h"
#include "ui/model/jobs/latest_job.h"
#include "ui/model/pieces/piece_persistence.h"

namespace isoslider::model {
class Session;
} // namespace isoslider::model

namespace isoslider::widgets {

class FactForm;

/// One piece of the surface: its box, and what jobs find out once the surface rests: area, the volume that it encloses,
/// how long it lasts.
class PieceDetails : public QWidget {
    Q_OBJECT
public:
    explicit PieceDetails(model::Session& session, QWidget* parent = nullptr);

    /// Nothing for no piece, and where the frame has none of that number. `frame` may be null. `unit`: of length;
    /// empty where it is not known.
    void show(std::shared_ptr<const extract::SurfaceFrame> frame, std::optional<extract::PieceId> piece,
              const std::string& unit);

private:
    void measure();
    void findPersistence();
    void showFacts();

    model::Session& session_;
    FactForm* form_;
    std::shared_ptr<const extract::SurfaceFrame> frame_;
    std::optional<std::size_t> piece_; ///< its place among the frame's
    std::optional<extract::PieceId> id_;
    std::string unit_;
    std::optional<extract::PieceMeasures> measures_; ///< of `frame_`
    std::optional<Result<topology::PiecePersistence>> persistence_; ///< likewise
    std::shared_ptr<model::PersistenceFinder> finder_;
    QTimer timer_;
    std::shared_ptr<model::BackgroundJobs> jobs_;
    model::LatestJob<extract::PieceMeasures> measuring_; // last, as the next: nothing is reported once it is gone
    model::LatestJob<topology::PiecePersistence> persisting_;
};

} // namespace isoslider::widgets
