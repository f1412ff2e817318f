#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <glm/vec3.hpp>

#include "core/extract/surface_mesh.h"
#include "core/index/format/index_format.h"
#include "tests/bench/chained_table.h"
#include "tests/bench/flat_changes.h"

namespace isoslider::bench {

/// The live surface laid out as the paper prints it (3.2, 3.3): flat arrays E, I[1..5], V, N over the
/// whole surface, hash tables H_E and H_C, one thread. A measured baseline, not part of the product.
///
/// Invariants, between moves: 1. E, its ids and H_E have activeEdges() entries, without holes; 2. a cell
/// is in H_C exactly while it has an active edge; 3. the triangles of a cell with t triangles are run
/// `start` of I[t], and that run's owner is the cell; runs have no holes.
template <class Live>
class FlatBaseline {
public:
    /// `expectedEdges`: active edges on average, which sizes the tables. `missingCells` must outlive this.
    FlatBaseline(const GridGeometry& geometry, const std::vector<index::MissingCells>& missingCells,
                 std::uint64_t expectedEdges);

    /// Brings E, I, H_E and H_C to the isovalue that `changes` lead to.
    /// REQUIRES: the changes fit the live state.
    void apply(const EdgeChanges<Live>& changes);
    /// Regenerates V and N from E.
    void interpolate(double isovalue);

    std::uint64_t activeEdges() const { return edges_.size(); }
    std::uint64_t triangles() const;
    /// Bytes in arrays and tables.
    std::uint64_t memoryBytes() const;

private:
    using EdgeId = extract::EdgeId;
    using CellId = std::uint64_t;

    // PAPER 3.2: V_1, S_1, dV = (V_2 - V_1) / (S_2 - S_1), N_1, N_2 and m = 2 sin^2(alpha / 2).
    struct Edge {
        glm::vec3 v1;
        Live s1;
        glm::vec3 dv;
        float m;
        NormalCode n1, n2;
    };
    // PAPER 3.2: <vid, Start Address, list_number, case_number>; the case follows from the edge mask.
    struct Cell {
        std::uint32_t start = 0;
        std::uint16_t edgeMask = 0;
        std::uint8_t list = 0;
        bool isStale = false; // its triangles have been taken out of I
    };
    struct Bucket {
        std::vector<std::uint32_t> indices;
        std::vector<CellId> owners; // one per run
        std::vector<std::uint32_t> holes;
    };

    EdgeId edgeIdOf(BrickIndex brick, LocalEdge edge) const;
    Edge makeEdge(const ActivatedEdge<Live>& change) const;
    bool isLowerEndBelow(const Edge& edge) const;
    bool isMissingCell(CellId cell) const;
    template <class Visit>
    void forEachCellAt(EdgeId edge, const Visit& visit) const;

    void remove(EdgeId edge);
    void add(const ActivatedEdge<Live>& change);
    void toggleCells(EdgeId edge);
    void makeStale(Cell& cell, CellId id);
    void compactEdges();
    void renameVertex(EdgeId edge, std::uint32_t from, std::uint32_t to);
    void retriangulate(CellId id);
    void compact(Bucket& bucket, std::uint32_t triangles);

    std::array<std::uint64_t, 3> dims_;
    std::array<std::uint64_t, 3> strides_;
    BrickGrid grid_;
    std::unordered_map<BrickIndex, const index::MissingCells*> missingCells_;

    std::vector<Edge> edges_; // E
    std::vector<EdgeId> edgeIds_; // beside E: whose entry it is
    std::vector<std::uint32_t> edgeHoles_;
    std::array<Bucket, 6> buckets_; // I; 0 is unused
    std::vector<glm::vec3> positions_, normals_; // V, N
    ChainedTable<std::uint32_t> edgeTable_; // H_E
    ChainedTable<Cell> cellTable_; // H_C
    std::vector<CellId> staleCells_;
};

extern template class FlatBaseline<float>;
extern template class FlatBaseline<double>;

} // namespace isoslider::bench
