#include "preprocess/edges/record_generator.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include <tbb/parallel_for.h>

#include "core/cell/trilinear_cell.h"
#include "core/grid/edge_cells.h"
#include "core/grid/gradient.h"
#include "preprocess/edges/hidden_corner_filter.h"
#include "preprocess/missing_cells.h"

namespace isoslider::preprocess {
namespace {

using index::HiddenCorner;
using index::kPointEdges;
using index::MissingCells;
using index::PointRecord;

// A layer's planes and one on either side, prepared once: keys, normals, missing flags.
template <class Sample>
class PreparedLayer {
public:
    using Key = KeyOf<Sample>;

    PreparedLayer(const SlabWindow<Sample>& window, const GridGeometry& geometry, std::int64_t layer)
        : dims_(geometry.dims), plane_(dims_[0] * dims_[1]) {
        begin_ = std::max<std::int64_t>(0, layer * kBrickSide - 1);
        end_ = std::min(dims_[2], (layer + 1) * kBrickSide + 1);
        const std::size_t count = static_cast<std::size_t>((end_ - begin_) * plane_);
        keys_.resize(count);
        normals_.resize(count);
        missing_.resize(count);
        glm::vec3 inverseSpacing;
        for (int a = 0; a < 3; ++a)
            inverseSpacing[a] = static_cast<float>(1.0 / std::abs(geometry.spacing[a]));
        // The window is a separate grid; at its own ends it is cut off only where the box is.
        const SampleView<Sample> view{window.plane(window.begin()),
                                      {dims_[0], dims_[1], window.end() - window.begin()}};
        tbb::parallel_for(begin_, end_,
                          [&](std::int64_t z) { preparePlane(view, z - window.begin(), z, inverseSpacing); });
        hasMissing_ = std::any_of(missing_.begin(), missing_.end(), [](std::uint8_t m) { return m != 0; });
    }

    std::size_t at(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return static_cast<std::size_t>(x + dims_[0] * y + plane_ * (z - begin_));
    }
    Key key(std::size_t i) const { return keys_[i]; }
    const Key* keysFrom(std::size_t i) const { return keys_.data() + i; }
    NormalCode normal(std::size_t i) const { return normals_[i]; }
    bool missing(std::size_t i) const { return missing_[i] != 0; }
    bool hasMissing() const { return hasMissing_; }
    const GridDims& dims() const { return dims_; }
    std::ptrdiff_t stride(int axis) const {
        return axis == 0 ? 1 : axis == 1 ? static_cast<std::ptrdiff_t>(dims_[0]) : static_cast<std::ptrdiff_t>(plane_);
    }

    // A cell whose planes are here; outside the box no cell is valid.
    bool isCellValid(std::int64_t x, std::int64_t y, std::int64_t z) const {
        if (x < 0 || y < 0 || z < 0 || x + 1 >= dims_[0] || y + 1 >= dims_[1] || z + 1 >= dims_[2])
            return false;
        const std::size_t i = at(x, y, z);
        for (int c = 0; c < 8; ++c)
            if (missing_[i + static_cast<std::size_t>((c & 1) + (c >> 1 & 1) * stride(1) + (c >> 2) * stride(2))])
                return false;
        return true;
    }

    bool hasValidCell(std::int64_t x, std::int64_t y, std::int64_t z, int axis) const {
        return isoslider::hasValidCell(x, y, z, axis, [this](auto... cell) { return isCellValid(cell...); });
    }

private:
    void preparePlane(const SampleView<Sample>& view, std::int64_t viewZ, std::int64_t z,
                      const glm::vec3& inverseSpacing) {
        std::size_t i = at(0, 0, z);
        const Sample* sample = view.samples + view.offset(0, 0, viewZ);
        for (std::int64_t y = 0; y < dims_[1]; ++y)
            for (std::int64_t x = 0; x < dims_[0]; ++x, ++i, ++sample) {
                missing_[i] = isMissing(*sample);
                if (missing_[i])
                    continue;
                keys_[i] = keyOf(*sample);
                normals_[i] = normalOfGradient(gradientAt(view, x, y, viewZ, inverseSpacing));
            }
    }

    GridDims dims_;
    std::int64_t plane_;
    std::int64_t begin_ = 0;
    std::int64_t end_ = 0;
    bool hasMissing_ = false;
    std::vector<Key> keys_;
    std::vector<NormalCode> normals_;
    std::vector<std::uint8_t> missing_;
};

template <class Sample>
class BrickGenerator {
public:
    using Key = KeyOf<Sample>;

    BrickGenerator(const PreparedLayer<Sample>& layer, const BrickGrid& grid, const KeyIntervals& bins)
        : layer_(layer), grid_(grid), bins_(bins) {}

    void generate(BrickIndex brick, SpanHistogram& histogram, std::vector<PointRecord<Key>>& records,
                  std::vector<std::uint64_t>& withoutEdges) const {
        const auto b = grid_.brickCoords(brick);
        std::int64_t begin[3], end[3];
        for (int a = 0; a < 3; ++a) {
            begin[a] = b[a] * kBrickSide;
            end[a] = std::min(begin[a] + kBrickSide, grid_.dims()[a]);
        }
        PointRecord<Key> record;
        for (std::int64_t z = begin[2]; z < end[2]; ++z)
            for (std::int64_t y = begin[1]; y < end[1]; ++y)
                for (std::int64_t x = begin[0]; x < end[0]; ++x) {
                    const std::size_t i = layer_.at(x, y, z);
                    if (layer_.missing(i))
                        continue;
                    if (fill(record, i, x, y, z, withoutEdges)) {
                        count(record, histogram);
                        records.push_back(record);
                    }
                }
    }

    // Of the cells that exist and have no missing corner.
    void hiddenCorners(BrickIndex brick, std::vector<HiddenCorner>& corners) const {
        const auto b = grid_.brickCoords(brick);
        std::int64_t begin[3], cells[3];
        for (int a = 0; a < 3; ++a) {
            begin[a] = b[a] * kBrickSide;
            cells[a] = std::min<std::int64_t>(kBrickSide, grid_.dims()[a] - 1 - begin[a]);
        }
        Key padded[4][kFilterCells + 1] = {};
        for (std::int64_t z = 0; z < cells[2]; ++z)
            for (std::int64_t y = 0; y < cells[1]; ++y) {
                const std::size_t at = layer_.at(begin[0], begin[1] + y, begin[2] + z);
                const Key* rows[4];
                for (int row = 0; row < 4; ++row) {
                    rows[row] = layer_.keysFrom(
                        at + static_cast<std::size_t>((row & 1) * layer_.stride(1) + (row >> 1) * layer_.stride(2)));
                    if (cells[0] < kFilterCells)
                        rows[row] = std::copy_n(rows[row], cells[0] + 1, padded[row]) - (cells[0] + 1);
                }
                unsigned found = mayNeedHiddenCorners(rows) & ((1u << cells[0]) - 1);
                for (; found != 0; found &= found - 1)
                    hiddenCornersOfCell(brick, std::countr_zero(found) + 8 * y + 64 * z,
                                        at + static_cast<std::size_t>(std::countr_zero(found)), corners);
            }
    }

    // Bit per cell of the brick with a missing corner; false when there is none.
    bool missingCells(BrickIndex brick, MissingCells& out) const {
        return layer_.hasMissing() && findMissingCells(
                                          grid_, brick, [&](auto... cell) { return layer_.isCellValid(cell...); }, out);
    }

private:
    void hiddenCornersOfCell(BrickIndex brick, std::int64_t cell, std::size_t at,
                             std::vector<HiddenCorner>& corners) const {
        Key keys[8];
        cell::CornerScalars scalars;
        for (int c = 0; c < 8; ++c) {
            const std::size_t i =
                at + static_cast<std::size_t>((c & 1) + (c >> 1 & 1) * layer_.stride(1) + (c >> 2) * layer_.stride(2));
            if (layer_.missing(i))
                return;
            keys[c] = layer_.key(i);
            scalars[static_cast<std::size_t>(c)] = static_cast<double>(sampleOfKey<Sample>(keys[c]));
        }
        for (unsigned needed = cell::hiddenCornersNeeded(scalars); needed != 0; needed &= needed - 1) {
            const int corner = std::countr_zero(needed);
            corners.push_back({brick, static_cast<std::uint16_t>(8 * cell + corner), keys[corner]});
        }
    }

    bool fill(PointRecord<Key>& record, std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z,
              std::vector<std::uint64_t>& withoutEdges) const {
        const std::int64_t p[3] = {x, y, z};
        record.key = layer_.key(i);
        record.edgeMask = 0;
        bool hasUnusable = false;
        for (int e = 0; e < kPointEdges; ++e) {
            const int axis = e >> 1;
            const bool up = e & 1;
            record.farKeys[e] = 0;
            record.farNormals[e] = 0;
            if (up ? p[axis] + 1 >= grid_.dims()[axis] : p[axis] == 0)
                continue;
            const std::size_t far = up ? i + static_cast<std::size_t>(layer_.stride(axis))
                                       : i - static_cast<std::size_t>(layer_.stride(axis));
            if (layer_.missing(far)) {
                hasUnusable = true;
                continue;
            }
            if (layer_.key(far) == record.key)
                continue;
            if ((layer_.hasMissing() || isThin()) && !isUsable(p, axis, up)) {
                hasUnusable = true;
                continue;
            }
            record.edgeMask |= static_cast<std::uint8_t>(1 << e);
            record.farKeys[e] = layer_.key(far);
            record.farNormals[e] = layer_.normal(far);
        }
        if (record.edgeMask == 0) {
            if (hasUnusable)
                withoutEdges.push_back(record.key);
            return false;
        }
        record.normal = layer_.normal(i);
        record.setId(grid_.pointId(x, y, z));
        return true;
    }

    bool isThin() const { return grid_.dims()[0] < 2 || grid_.dims()[1] < 2 || grid_.dims()[2] < 2; }

    bool isUsable(const std::int64_t (&p)[3], int axis, bool up) const {
        std::int64_t lower[3] = {p[0], p[1], p[2]};
        lower[axis] -= up ? 0 : 1;
        return layer_.hasValidCell(lower[0], lower[1], lower[2], axis);
    }

    void count(const PointRecord<Key>& record, SpanHistogram& histogram) const {
        const std::size_t bin = bins_.find(record.key);
        for (int e = 0; e < kPointEdges; ++e)
            if ((record.edgeMask >> e & 1) && record.farKeys[e] > record.key)
                histogram.add(bin, bins_.find(record.farKeys[e]));
    }

    const PreparedLayer<Sample>& layer_;
    const BrickGrid& grid_;
    const KeyIntervals& bins_;
};

template <class Sample>
void generateBricks(const BrickGenerator<Sample>& generator, std::size_t count, std::span<SpanHistogram> histograms,
                    LayerRecords<KeyOf<Sample>>& out) {
    std::vector<MissingCells> missing(count);
    std::vector<std::uint8_t> hasMissing(count, 0);
    std::vector<std::vector<std::uint64_t>> withoutEdges(count);
    out.bricks.resize(count);
    out.hiddenCorners.resize(count);
    std::atomic<std::size_t> next = 0;
    tbb::parallel_for(std::size_t{0}, histograms.size(), [&](std::size_t lane) {
        for (std::size_t i; (i = next++) < count;) {
            out.bricks[i].clear();
            out.hiddenCorners[i].clear();
            const BrickIndex brick = out.firstBrick + i;
            generator.generate(brick, histograms[lane], out.bricks[i], withoutEdges[i]);
            generator.hiddenCorners(brick, out.hiddenCorners[i]);
            hasMissing[i] = generator.missingCells(brick, missing[i]);
        }
    });
    out.missingCells.clear();
    out.keysWithoutEdges.clear();
    for (std::size_t i = 0; i < count; ++i) {
        if (hasMissing[i])
            out.missingCells.push_back(missing[i]);
        out.keysWithoutEdges.insert(out.keysWithoutEdges.end(), withoutEdges[i].begin(), withoutEdges[i].end());
    }
    std::sort(out.keysWithoutEdges.begin(), out.keysWithoutEdges.end());
    out.keysWithoutEdges.erase(std::unique(out.keysWithoutEdges.begin(), out.keysWithoutEdges.end()),
                               out.keysWithoutEdges.end());
}

} // namespace

template <class Sample>
Status generateLayer(const SlabWindow<Sample>& window, const GridGeometry& geometry, std::int64_t layer,
                     const KeyIntervals& bins, std::span<SpanHistogram> histograms,
                     const ConsumeRecords<KeyOf<Sample>>& consume) {
    const BrickGrid grid(geometry.dims);
    const PreparedLayer<Sample> prepared(window, geometry, layer);
    const BrickGenerator<Sample> generator(prepared, grid, bins);
    const auto inLayer = static_cast<std::size_t>(grid.bricks()[0] * grid.bricks()[1]);
    LayerRecords<KeyOf<Sample>> records;
    for (std::size_t begin = 0; begin < inLayer; begin += kBricksAtOnce) {
        records.firstBrick = grid.brickAt(0, 0, layer) + begin;
        generateBricks(generator, std::min(kBricksAtOnce, inLayer - begin), histograms, records);
        ISO_TRY(consume(records));
    }
    return {};
}

#define ISO_INSTANTIATE(Sample, Name) \
    template Status generateLayer<Sample>(const SlabWindow<Sample>&, const GridGeometry&, std::int64_t, \
                                          const KeyIntervals&, std::span<SpanHistogram>, \
                                          const ConsumeRecords<KeyOf<Sample>>&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::preprocess
