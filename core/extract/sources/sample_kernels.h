#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/extract/live/active_bits.h"
#include "core/extract/live/brick_bits.h"
#include "core/extract/live/brick_points.h"
#include "core/extract/live/cell_triangles.h"
#include "core/extract/live/one_leaf.h"
#include "core/extract/live/vertex_code.h"

namespace isoslider::extract {

/// What a threshold makes of a brick's samples.
template <class Stored>
struct ClassifiedBrick {
    BitString above; ///< bits behind the last point hold anything
    ActiveBits active;
    BitString changed; ///< cells with a corner that changed sides
    std::uint32_t ownedEdges = 0, edgesAdded = 0, edgesRemoved = 0; ///< of the edges that the brick owns
    Stored up, down; ///< the least sample above, and the greatest below; the type's greatest and least without one
};

/// One pass over the samples, some over the bits. `before`: the signs that the brick had; none for a brick that had
/// none, of which every cell has changed. `samples`: kKeptPoints of them, those behind the last point repeat one of
/// the brick; 64-byte aligned.
template <class Stored>
void classify(const Stored* samples, Stored threshold, const BrickMasks& masks, std::optional<BitsInMemory> before,
              ClassifiedBrick<Stored>& out);
/// What follows from signs that are known: `out.above`, `out.up` and `out.down` are given, the rest is filled in.
template <class Stored>
void classifyAgain(const BrickMasks& masks, std::optional<BitsInMemory> before, ClassifiedBrick<Stored>& out);
/// As classify(), sample by sample: what that is tested against.
template <class Stored>
void classifyReference(const Stored* samples, Stored threshold, const BrickMasks& masks,
                       std::optional<BitsInMemory> before, ClassifiedBrick<Stored>& out);

/// What it makes of the samples on the edges of a brick that is one leaf.
template <class Stored>
struct ClassifiedLeafEdges {
    LeafEdgeSigns above;
    Stored up, down; ///< as in ClassifiedBrick
};
template <class Stored>
void classifyLeafEdges(const LeafEdgeSamples<Stored>& edges, Stored threshold, ClassifiedLeafEdges<Stored>& out);

/// Codes of a brick's active edges in their order, and their numbers in the vertex table; returns how many there are.
/// `codes` has room for kMaxEdgeCodes.
std::uint32_t numberEdges(const ActiveBits& active, VertexCode* codes, VertexTable& vertices);

/// Names of the instruction sets that the kernels can run with here, the best first; and, for tests, a way to
/// restrict it to one of them (0: the best again).
std::vector<std::string> kernelTargets();
void useKernelTarget(std::size_t number);

} // namespace isoslider::extract
