#include "core/volume_io/resampling/curvilinear_resampler.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <tbb/parallel_for.h>

namespace isoslider::io {
namespace {

constexpr double kTolerance = 1e-6; // of a cell: neighbours share their faces but for rounding
constexpr int kMaxSteps = 12;
constexpr std::int64_t kSlabPlanes = 4;

/// One cell as the polynomial a0 + a1 u + a2 v + a3 w + a4 uv + a5 vw + a6 uw + a7 uvw.
template <class Value>
struct Trilinear {
    std::array<Value, 8> a;

    /// Corner c has u = c & 1, v = c >> 1 & 1, w = c >> 2 & 1.
    explicit Trilinear(const std::array<Value, 8>& p)
        : a{p[0],
            p[1] - p[0],
            p[2] - p[0],
            p[4] - p[0],
            p[3] - p[1] - p[2] + p[0],
            p[6] - p[2] - p[4] + p[0],
            p[5] - p[1] - p[4] + p[0],
            p[7] - p[3] - p[5] - p[6] + p[1] + p[2] + p[4] - p[0]} {}

    Value at(const glm::dvec3& t) const {
        return a[0] + a[1] * t.x + a[2] * t.y + a[3] * t.z + a[4] * (t.x * t.y) + a[5] * (t.y * t.z) +
               a[6] * (t.x * t.z) + a[7] * (t.x * t.y * t.z);
    }
    Value du(const glm::dvec3& t) const { return a[1] + a[4] * t.y + a[6] * t.z + a[7] * (t.y * t.z); }
    Value dv(const glm::dvec3& t) const { return a[2] + a[4] * t.x + a[5] * t.z + a[7] * (t.x * t.z); }
    Value dw(const glm::dvec3& t) const { return a[3] + a[5] * t.y + a[6] * t.x + a[7] * (t.x * t.y); }
};

bool isInside(const glm::dvec3& t) {
    return t.x >= -kTolerance && t.y >= -kTolerance && t.z >= -kTolerance && t.x <= 1 + kTolerance &&
           t.y <= 1 + kTolerance && t.z <= 1 + kTolerance;
}

/// Newton's method; moves `t` to the place whose image is `point`. False where it does not settle
/// inside the cell, or wanders far from it.
bool invert(const Trilinear<glm::dvec3>& map, const glm::dvec3& point, glm::dvec3& t) {
    for (int step = 0; step < kMaxSteps; ++step) {
        const glm::dmat3 jacobian(map.du(t), map.dv(t), map.dw(t));
        const double determinant = glm::determinant(jacobian);
        if (!(std::abs(determinant) > 1e-300))
            return false; // collapsed here
        const glm::dvec3 move = glm::inverse(jacobian) * (point - map.at(t));
        t += move;
        const double size = std::max({std::abs(move.x), std::abs(move.y), std::abs(move.z)});
        if (size < 1e-9)
            return isInside(t);
        if (!(std::max({std::abs(t.x - 0.5), std::abs(t.y - 0.5), std::abs(t.z - 0.5)}) < 20.0))
            return false;
    }
    return false;
}

struct Cell {
    std::array<std::int64_t, 8> corners;
    glm::dvec3 low, high; ///< bounding box, in output index units
};

class Resampling {
public:
    Resampling(const CurvilinearGrid& grid, const GridGeometry& geometry, const JobControl& job)
        : grid_(grid), geometry_(geometry), job_(job) {
        // All in index units of the output: bounding boxes become ranges of indices.
        const glm::dmat3 toIndex = glm::inverse(geometry.direction);
        points_.reserve(grid.points.size());
        for (const glm::dvec3& p : grid.points)
            points_.push_back(toIndex * (p - geometry.origin) / geometry.spacing);
        listCells();
        samples_.assign(static_cast<std::size_t>(pointCount(geometry.dims)), std::numeric_limits<float>::quiet_NaN());
    }

    Result<ScalarGrid> run() {
        const std::int64_t slabs = (geometry_.dims[2] + kSlabPlanes - 1) / kSlabPlanes;
        std::atomic<std::int64_t> finished = 0;
        std::mutex progressMutex;
        tbb::parallel_for(std::int64_t{0}, slabs, [&](std::int64_t slab) {
            if (job_.isStopRequested())
                return;
            fillSlab(slab * kSlabPlanes, std::min((slab + 1) * kSlabPlanes, geometry_.dims[2]));
            const std::scoped_lock lock(progressMutex);
            job_.report(static_cast<double>(++finished) / static_cast<double>(slabs), "resampling");
        });
        if (job_.isStopRequested())
            return cancelledError();
        return ScalarGrid::fromValues<float>(geometry_, ScalarType::F32, samples_);
    }

private:
    void listCells() {
        const GridDims& d = grid_.dims;
        cells_.reserve(static_cast<std::size_t>((d[0] - 1) * (d[1] - 1) * (d[2] - 1)));
        for (std::int64_t k = 0; k + 1 < d[2]; ++k)
            for (std::int64_t j = 0; j + 1 < d[1]; ++j)
                for (std::int64_t i = 0; i + 1 < d[0]; ++i)
                    cells_.push_back(makeCell(i + d[0] * (j + d[1] * k)));
    }

    Cell makeCell(std::int64_t first) const {
        Cell cell;
        cell.low = cell.high = points_[static_cast<std::size_t>(first)];
        for (std::int64_t c = 0; c < 8; ++c) {
            const std::int64_t corner = first + (c & 1) + grid_.dims[0] * ((c >> 1 & 1) + grid_.dims[1] * (c >> 2 & 1));
            cell.corners[static_cast<std::size_t>(c)] = corner;
            cell.low = glm::min(cell.low, points_[static_cast<std::size_t>(corner)]);
            cell.high = glm::max(cell.high, points_[static_cast<std::size_t>(corner)]);
        }
        return cell;
    }

    struct Range {
        std::int64_t begin, end;
    };
    static Range indexRange(double low, double high, std::int64_t begin, std::int64_t end) {
        const double first = std::max(std::ceil(low - kTolerance), static_cast<double>(begin));
        const double last = std::min(std::floor(high + kTolerance), static_cast<double>(end - 1));
        return {static_cast<std::int64_t>(first),
                last < first ? static_cast<std::int64_t>(first) : static_cast<std::int64_t>(last) + 1};
    }

    void fillSlab(std::int64_t zBegin, std::int64_t zEnd) {
        for (const Cell& cell : cells_) {
            const Range z = indexRange(cell.low.z, cell.high.z, zBegin, zEnd);
            if (z.begin < z.end)
                fillCell(cell, z);
        }
    }

    void fillCell(const Cell& cell, const Range& z) {
        const Range x = indexRange(cell.low.x, cell.high.x, 0, geometry_.dims[0]);
        const Range y = indexRange(cell.low.y, cell.high.y, 0, geometry_.dims[1]);
        if (x.begin >= x.end || y.begin >= y.end)
            return;
        std::array<glm::dvec3, 8> corners;
        std::array<double, 8> values;
        for (std::size_t c = 0; c < 8; ++c) {
            corners[c] = points_[static_cast<std::size_t>(cell.corners[c])];
            values[c] = static_cast<double>(grid_.values[static_cast<std::size_t>(cell.corners[c])]);
        }
        const Trilinear<glm::dvec3> map(corners);
        const Trilinear<double> field(values);
        for (std::int64_t k = z.begin; k < z.end; ++k)
            for (std::int64_t j = y.begin; j < y.end; ++j)
                fillRow(map, field, x, j, k);
    }

    void fillRow(const Trilinear<glm::dvec3>& map, const Trilinear<double>& field, const Range& x, std::int64_t j,
                 std::int64_t k) {
        float* row = samples_.data() + geometry_.dims[0] * (j + geometry_.dims[1] * k);
        glm::dvec3 t(0.5); // each row starts afresh, so that slabs and threads change nothing
        for (std::int64_t i = x.begin; i < x.end; ++i) {
            if (!std::isnan(row[i]))
                continue;
            if (!invert(map, glm::dvec3(i, j, k), t)) {
                t = glm::dvec3(0.5);
                continue;
            }
            row[i] = static_cast<float>(field.at(glm::clamp(t, 0.0, 1.0)));
        }
    }

    const CurvilinearGrid& grid_;
    const GridGeometry& geometry_;
    const JobControl& job_;
    std::vector<glm::dvec3> points_;
    std::vector<Cell> cells_;
    std::vector<float> samples_;
};

} // namespace

GridGeometry boundingGeometry(const std::vector<glm::dvec3>& points, const GridDims& dims) {
    glm::dvec3 low = points.front(), high = points.front();
    for (const glm::dvec3& p : points) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    GridGeometry geometry;
    geometry.dims = dims;
    geometry.origin = low;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t cells = dims[static_cast<std::size_t>(axis)] - 1;
        geometry.spacing[axis] = cells > 0 ? (high - low)[axis] / static_cast<double>(cells) : 1.0;
    }
    return geometry;
}

Result<ScalarGrid> resampleCurvilinear(const CurvilinearGrid& grid, const GridGeometry& geometry,
                                       const JobControl& job) {
    ISO_CHECK(grid.dims[0] > 1 && grid.dims[1] > 1 && grid.dims[2] > 1);
    ISO_CHECK(grid.points.size() == static_cast<std::size_t>(pointCount(grid.dims)) &&
              grid.values.size() == grid.points.size());
    return Resampling(grid, geometry, job).run();
}

} // namespace isoslider::io
