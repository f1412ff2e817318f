#pragma once

#include <cstdint>
#include <optional>

#include "core/base/result.h"
#include "core/grid/brick_grid.h"

namespace isoslider::extract {

/// Scalars that sliding cannot take from active edges: those of corners on which a cell's tunnel depends
/// though they lie on none (cell::hiddenCorner).
class HiddenScalars {
public:
    virtual ~HiddenScalars() = default;

    /// Scalar at `corner` of a cell; nothing when the cell has no tunnel at any isovalue. From any thread.
    /// Errors: IoError, Corruption.
    virtual Result<std::optional<double>> hiddenScalar(BrickIndex brick, LocalPoint cell, int corner) = 0;
    /// Bytes read for that so far.
    virtual std::uint64_t hiddenBytesRead() const = 0;
};

} // namespace isoslider::extract
