#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/cell/cell_states.h"

namespace isoslider::topology {

/// Where the surface in a cell changes though the isovalue crosses none of its corners, or where a corner that is
/// crossed finds others already joined.
struct CellJoin {
    double isovalue = 0.0; ///< above side: the last at which the corners are joined; below side: beyond it they are
    bool isOfAbove = false;
    std::int8_t face = -1; ///< across it; -1: through the inside
    std::array<std::uint8_t, 2> corners{};
};

/// A change of the surface's Euler number between two corners' scalars: when the isovalue rises beyond.
struct CellSaddle {
    double isovalue = 0.0;
    int euler = 0; ///< 0 where only what is joined changes
    std::int8_t face = -1; ///< whose saddle it is; -1: a body saddle
};

/// What one cell contributes, at all isovalues.
class CellHistory {
public:
    /// REQUIRES: all finite. Most cells of smooth data cost some comparisons, others some decisions (resolveCell).
    void find(const cell::CornerScalars& scalars);

    /// Discs less tubes, when the isovalue rises beyond the scalar of each corner; with equal scalars the sum counts.
    const std::array<std::int8_t, 8>& eulerAtCorners() const { return eulerAtCorners_; }
    std::span<const CellSaddle> saddles() const { return {saddles_.data(), saddleCount_}; }
    std::span<const CellJoin> joins() const { return {joins_.data(), joinCount_}; }

private:
    struct FaceJoin;
    /// Isovalues at which the cell has one state, from above those of the stretch below it.
    struct Stretch {
        const cell::CellState* state = nullptr; ///< null: the surface does not pass through
        double below = 0.0;

        int euler() const; ///< discs less tubes
        unsigned joinedAbove() const;
        unsigned joinedBelow() const;
        bool hasTunnel(cell::Tunnel which) const;
    };
    void findStretches(const cell::CornerScalars& scalars, std::uint8_t signs, double low, double high);
    void addStretch(cell::StateId state, double below);
    void add(const Stretch& lower, const Stretch& upper, double isovalue);

    // Between two corners a state changes at six face saddles and two body saddles at most.
    static constexpr std::size_t kMost = 64;
    std::array<double, 6> lastJoined_{}; ///< of faces that are ambiguous at some isovalue
    std::array<Stretch, kMost> stretches_{}; ///< of one sign pattern, from above downwards
    std::size_t stretchCount_ = 0;
    std::array<std::int8_t, 8> eulerAtCorners_{};
    std::array<CellSaddle, kMost> saddles_{};
    std::array<CellJoin, 2 * kMost> joins_{};
    std::size_t saddleCount_ = 0, joinCount_ = 0;
};

} // namespace isoslider::topology
