#pragma once

#include <filesystem>
#include <memory>

#include "core/extract/surface_frame.h"
#include "core/index/sample_blocks.h"
#include "core/topology/piece_persistence.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/model/session/dataset.h"

namespace isoslider::model {

/// How long pieces last, from the samples of their volume, which are kept from one piece to the next. For jobs, one at
/// a time.
class PersistenceFinder {
public:
    /// Of the frame's piece in that place of its pieces. `grid`: the samples that the frame is of, where they are in
    /// memory; else those of the index are opened. Errors: those of
    /// topology::persistenceOfPiece() and index::openSampleBlocks(). REQUIRES: the frame has such a piece.
    Result<topology::PiecePersistence> find(const extract::SurfaceFrame& frame, std::size_t piece,
                                            const Dataset& dataset, const std::shared_ptr<const ScalarGrid>& grid,
                                            const JobControl& job);
    /// Which of the frame's pieces last less than that. Else as find().
    Result<ShortLivedPieces> findShortLived(const extract::SurfaceFrame& frame, double leastPersistence,
                                            const Dataset& dataset, const std::shared_ptr<const ScalarGrid>& grid,
                                            const JobControl& job);

private:
    Status open(const extract::SurfaceFrame& frame, const Dataset& dataset,
                const std::shared_ptr<const ScalarGrid>& grid);

    std::shared_ptr<index::SampleBlocks> samples_;
    std::shared_ptr<const ScalarGrid> grid_; ///< they are of it, or else of the index there
    std::filesystem::path index_;
};

} // namespace isoslider::model
