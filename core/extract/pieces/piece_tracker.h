#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/extract/live/brick_picture.h"
#include "core/extract/pieces/surface_pieces.h"

namespace isoslider::extract {

/// Finds the pieces of one picture after another, and which of them are the same: a piece keeps its number while it
/// moves, and of pieces that join or split the one with most in common does. What is in common are vertices on the
/// same edges; where a move leaves none of a piece's, what lies in the same place. After a jump that shares nothing
/// with what was there, pieces are new.
///
/// Bricks are looked into when they change; per picture further O(live bricks + vertices on their faces), several
/// threads. Memory: about 5 bytes per vertex. One thread at a time.
template <class Live>
class PieceTracker {
public:
    /// `hasMissing`: of the volume. Throws std::bad_alloc; the pieces followed are forgotten then.
    std::shared_ptr<const SurfacePieces> update(const BrickPicture<Live>& picture, bool hasMissing);
    /// Goes on from these pieces of the same grid, of another tracker or an earlier surface, instead of from the last
    /// ones. Null: no change.
    void follow(std::shared_ptr<const SurfacePieces> pieces) {
        if (!pieces || pieces == last_)
            return;
        last_ = std::move(pieces);
        bricks_.clear();
    }
    void forget() {
        last_.reset();
        bricks_.clear();
    }

private:
    class Step;

    std::shared_ptr<const SurfacePieces> last_;
    std::vector<PictureBrick> bricks_; ///< of the last picture; none if another tracker has found its pieces
    std::uint64_t series_ = 0;
};

extern template class PieceTracker<float>;
extern template class PieceTracker<double>;

} // namespace isoslider::extract
