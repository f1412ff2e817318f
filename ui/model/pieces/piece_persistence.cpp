#include "ui/model/pieces/piece_persistence.h"

#include <algorithm>
#include <vector>

#include "core/extract/pieces/surface_pieces.h"

namespace isoslider::model {
namespace {

topology::PersistenceOptions optionsOf(const Dataset& dataset) {
    topology::PersistenceOptions options;
    options.least = dataset.min;
    options.greatest = dataset.max;
    return options;
}

} // namespace

Status PersistenceFinder::open(const extract::SurfaceFrame& frame, const Dataset& dataset,
                               const std::shared_ptr<const ScalarGrid>& grid) {
    if (!samples_ || !samples_->status().isOk() || grid_ != grid || (!grid && index_ != dataset.indexPath)) {
        samples_.reset();
        auto opened = grid ? Result<std::shared_ptr<index::SampleBlocks>>(index::makeSampleBlocks(grid))
                           : index::openSampleBlocks(dataset.indexPath);
        if (!opened.isOk())
            return std::move(opened).error();
        samples_ = std::move(opened).value();
        grid_ = grid;
        index_ = dataset.indexPath;
    }
    if (samples_->dims() != frame.geometry.dims)
        return makeError(ErrorCode::InvalidArgument, "the surface is not of these samples");
    return {};
}

Result<topology::PiecePersistence> PersistenceFinder::find(const extract::SurfaceFrame& frame, std::size_t piece,
                                                           const Dataset& dataset,
                                                           const std::shared_ptr<const ScalarGrid>& grid,
                                                           const JobControl& job) {
    ISO_TRY(open(frame, dataset, grid));
    const extract::Piece& of = frame.pieces->pieces()[piece];
    return topology::persistenceOfPiece(*samples_, {of.edgeStart, of.edgeAxis}, frame.isovalue, optionsOf(dataset),
                                        job);
}

Result<ShortLivedPieces> PersistenceFinder::findShortLived(const extract::SurfaceFrame& frame, double leastPersistence,
                                                           const Dataset& dataset,
                                                           const std::shared_ptr<const ScalarGrid>& grid,
                                                           const JobControl& job) {
    ISO_TRY(open(frame, dataset, grid));
    const auto pieces = frame.pieces->pieces();
    std::vector<topology::PieceVertex> vertices;
    vertices.reserve(pieces.size());
    for (const extract::Piece& piece : pieces)
        vertices.push_back({piece.edgeStart, piece.edgeAxis});
    const auto lifetimes =
        topology::findShortLivedPieces(*samples_, vertices, frame.isovalue, leastPersistence, optionsOf(dataset), job);
    if (!lifetimes.isOk())
        return lifetimes.error();
    ShortLivedPieces found{frame.isovalue, frame.geometry.dims, leastPersistence, {}, lifetimes.value().isComplete, {}};
    for (std::size_t piece = 0; piece < pieces.size(); ++piece)
        if (lifetimes.value().isShortLived[piece])
            found.ids.push_back(pieces[piece].id);
    std::sort(found.ids.begin(), found.ids.end());
    return found;
}

} // namespace isoslider::model
