#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cell/cell_states.h"
#include "core/grid/grid_geometry.h"
#include "core/topology/analysis/cell_measure.h"
#include "core/topology/measuring.h"

namespace isoslider::topology {

/// A cell to be measured at isovalues `first` to `end` - 1 of a plan, where its rank is among those looked at. The
/// surface passes through it at all of them.
struct MeasuredCell {
    cell::CornerScalars scalars;
    std::uint32_t rank = 0;
    std::uint32_t first = 0, end = 0;
    bool isUsual = true; ///< all scalars within the plan's usual values
};

/// What cells of one kind measure at one isovalue.
struct BatchSum {
    double area = 0.0, volume = 0.0, gradient = 0.0, triangles = 0.0;
};

/// The same as whole multiples of 2^-50 of a unit: it does not depend on the order in which cells are added, nor on the
/// parts in which they come.
class ExactSum {
public:
    void add(double area, double volume, double gradient, double triangles) {
        area_ += wholeOf(area);
        volume_ += wholeOf(volume);
        gradient_ += wholeOf(gradient);
        triangles_ += wholeOf(triangles);
    }
    void add(const ExactSum& other) {
        area_ += other.area_;
        volume_ += other.volume_;
        gradient_ += other.gradient_;
        triangles_ += other.triangles_;
    }
    BatchSum sum() const { return {valueOf(area_), valueOf(volume_), valueOf(gradient_), valueOf(triangles_)}; }
    friend bool operator==(const ExactSum&, const ExactSum&) = default;

private:
    using Wide = __int128; // NOLINT: an extension that GCC and Clang share
    static constexpr double kUnits = 1125899906842624.0, kMost = 4096.0; // no cell measures so much

    static std::int64_t wholeOf(double value) { // NaN becomes the least
        return static_cast<std::int64_t>(kUnits * (value > -kMost ? value < kMost ? value : kMost : -kMost));
    }
    static double valueOf(Wide sum) { return static_cast<double>(sum) / kUnits; }

    Wide area_ = 0, volume_ = 0, gradient_ = 0, triangles_ = 0;
};

/// Measures many cells quickly. Cells of one state have the same triangles: they wait until there are kTogether of
/// them, which are then measured together, a cell to a lane, in single precision. What is added up depends on the cells
/// alone, not on the width of vectors.
class CellBatches {
public:
    static constexpr std::size_t kTogether = 16;

    CellBatches(const MeasurePlan& plan, const GridGeometry& geometry);

    /// O(isovalues of the cells), some ten nanoseconds for each that is looked at.
    void add(std::span<const MeasuredCell> cells);
    /// Measures what is waiting. Element 2 i + 1: of usual cells at isovalue i; 2 i: of others.
    const std::vector<ExactSum>& finish();
    /// Of an element with this number, in units of the geometry.
    BatchSum measured(std::size_t element, const ExactSum& sum) const;

    /// A rank is looked at if it is not beyond this; of one isovalue.
    static std::uint32_t lastRank(double share);
    /// How many cells each of these stands for.
    static double weight(double share);

    /// What waits of one state. Scalars less the isovalue, in units of `scale`, of four corners each.
    struct Batch {
        alignas(64) std::array<float, 4 * kTogether> lower, upper;
        std::array<std::uint32_t, kTogether> into; ///< place in the sums
        std::uint32_t count = 0;
    };
    /// What the kernels work on.
    struct Parts {
        std::vector<double> isovalues;
        std::vector<std::uint32_t> lastRanks; ///< and kTogether more
        double scale = 1.0;
        std::array<float, 9> areaToWorld{}, gradientToWorld{}; ///< by columns, none greater than 1
        std::array<bool, 256> isAmbiguous{};
        std::vector<Batch> batches; ///< by state
        std::vector<ExactSum> sums;
        std::array<double, 2> gradientShare{1.0, 1.0}; ///< of which the sums are, of others and usual cells
        /// Of the vertices of a batch: those on edges differ along one axis only.
        alignas(64) std::array<std::array<std::array<float, kTogether>, 3>,
                               cell::kInnerVertex + cell::kMaxInnerVertices> places{};
        CellMeasure single;
        double areaUnit = 1.0, gradientUnit = 1.0;
    };

private:
    Parts parts_;
};

} // namespace isoslider::topology
