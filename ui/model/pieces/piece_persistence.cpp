#include "ui/model/pieces/piece_persistence.h"

#include "core/extract/pieces/surface_pieces.h"
#include "ui/model/slices/slice_source.h"

namespace isoslider::model {

Result<topology::PiecePersistence> PersistenceFinder::find(const extract::SurfaceFrame& frame, std::size_t piece,
                                                           const Dataset& dataset,
                                                           const std::shared_ptr<const ScalarGrid>& grid,
                                                           const SessionServices& services, const JobControl& job) {
    if (!samples_ || !samples_->status().isOk() || grid_ != grid || (!grid && index_ != dataset.indexPath)) {
        samples_.reset();
        auto opened = grid ? Result<std::shared_ptr<index::SampleBlocks>>(index::makeSampleBlocks(grid))
                           : openBlocks(dataset, services, job);
        if (!opened.isOk())
            return std::move(opened).error();
        samples_ = std::move(opened).value();
        grid_ = grid;
        index_ = dataset.indexPath;
    }
    if (samples_->dims() != frame.geometry.dims)
        return makeError(ErrorCode::InvalidArgument, "the surface is not of these samples");
    const extract::Piece& of = frame.pieces->pieces()[piece];
    topology::PersistenceOptions options;
    options.least = dataset.min;
    options.greatest = dataset.max;
    return topology::persistenceOfPiece(*samples_, {of.edgeStart, of.edgeAxis}, frame.isovalue, options, job);
}

} // namespace isoslider::model
