#include "core/topology/analysis/cell_batches.h"

#include <algorithm>
#include <bit>
#include <cmath>

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/topology/analysis/cell_batches.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace isoslider::topology::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// What squares in single precision hold, and where no fraction is 0 / 0 for a scalar that is lost in rounding.
inline constexpr double kMostScaled = 1e15;
inline constexpr double kLeastBelow = -1e-30;

// Measures a batch of cells of one state: CellMeasure::at, a cell to a lane.
class BatchMeasure {
public:
    using D = hn::CappedTag<float, CellBatches::kTogether>;
    using V = hn::Vec<D>;

    BatchMeasure(CellBatches::Parts& parts, const cell::CellState& state) : parts_(parts), state_(state) {}

    HWY_INLINE void run(CellBatches::Batch& batch) {
        alignas(64) std::array<float, 4 * CellBatches::kTogether> found; // as a BatchSum of each cell
        for (lane_ = 0; lane_ < CellBatches::kTogether; lane_ += hn::Lanes(d_)) {
            V a, b, c, d;
            hn::LoadInterleaved4(d_, batch.lower.data() + 4 * lane_, a, b, c, d);
            storeCorners(0, a, b, c, d);
            hn::LoadInterleaved4(d_, batch.upper.data() + 4 * lane_, a, b, c, d);
            storeCorners(4, a, b, c, d);
            placeVertices();
            measure(found.data() + 4 * lane_);
        }
        for (std::size_t i = 0; i < batch.count; ++i) {
            const std::uint32_t into = batch.into[i];
            parts_.sums[into].add(static_cast<double>(found[4 * i]), static_cast<double>(found[4 * i + 1]),
                                  parts_.gradientShare[into & 1] * static_cast<double>(found[4 * i + 2]),
                                  static_cast<double>(found[4 * i + 3]));
        }
        batch.count = 0;
    }

private:
    HWY_INLINE void storeCorners(std::size_t first, V a, V b, V c, V d) {
        hn::Store(a, d_, corners_[first].data());
        hn::Store(b, d_, corners_[first + 1].data());
        hn::Store(c, d_, corners_[first + 2].data());
        hn::Store(d, d_, corners_[first + 3].data());
    }
    HWY_INLINE V corner(std::size_t c) const { return hn::Load(d_, corners_[c].data()); }
    HWY_INLINE float* placeOf(std::size_t vertex, std::size_t axis) const {
        return parts_.places[vertex][axis].data() + lane_;
    }
    HWY_INLINE V place(std::size_t vertex, std::size_t axis) const { return hn::Load(d_, placeOf(vertex, axis)); }

    HWY_INLINE void placeVertices() {
        for (unsigned edges = cell::activeEdges(state_.signs); edges != 0; edges &= edges - 1) {
            const auto e = static_cast<std::size_t>(std::countr_zero(edges));
            const auto& edge = cell::kCellEdges[e];
            const V a = corner(edge.lowerCorner), b = corner(edge.upperCorner);
            hn::Store(hn::Div(a, hn::Sub(a, b)), d_, placeOf(e, edge.axis));
        }
        std::size_t inner = cell::kInnerVertex;
        for (const cell::CellCentre& centre : state_.centres) {
            const V share = hn::Set(d_, 1.0f / static_cast<float>(std::popcount(centre.loopEdges)));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                V sum = hn::Zero(d_);
                for (unsigned edges = centre.loopEdges; edges != 0; edges &= edges - 1)
                    sum = hn::Add(sum, place(static_cast<std::size_t>(std::countr_zero(edges)), axis));
                hn::Store(hn::Mul(sum, share), d_, placeOf(inner, axis));
            }
            ++inner;
        }
    }

    // Length of a matrix's product with a vector.
    HWY_INLINE V lengthOf(const std::array<float, 9>& m, V x, V y, V z) const {
        const auto row = [&](std::size_t i) HWY_ATTR {
            return hn::Add(hn::Add(hn::Mul(hn::Set(d_, m[i]), x), hn::Mul(hn::Set(d_, m[3 + i]), y)),
                           hn::Mul(hn::Set(d_, m[6 + i]), z));
        };
        const V a = row(0), b = row(1), c = row(2);
        return hn::Sqrt(hn::Add(hn::Add(hn::Mul(a, a), hn::Mul(b, b)), hn::Mul(c, c)));
    }

    HWY_INLINE void measure(float* out) {
        V area = hn::Zero(d_), volume = area, middleX = area, middleY = area, middleZ = area;
        for (std::size_t t = 0; t < state_.triangles.size(); t += 3) {
            const std::size_t a = state_.triangles[t], b = state_.triangles[t + 1], c = state_.triangles[t + 2];
            const V ax = place(a, 0), ay = place(a, 1), az = place(a, 2);
            const V bx = place(b, 0), by = place(b, 1), bz = place(b, 2);
            const V cx = place(c, 0), cy = place(c, 1), cz = place(c, 2);
            const V ux = hn::Sub(bx, ax), uy = hn::Sub(by, ay), uz = hn::Sub(bz, az);
            const V vx = hn::Sub(cx, ax), vy = hn::Sub(cy, ay), vz = hn::Sub(cz, az);
            const V nx = hn::Sub(hn::Mul(uy, vz), hn::Mul(uz, vy)), ny = hn::Sub(hn::Mul(uz, vx), hn::Mul(ux, vz)),
                    nz = hn::Sub(hn::Mul(ux, vy), hn::Mul(uy, vx));
            area = hn::Add(area, lengthOf(parts_.areaToWorld, nx, ny, nz));
            const V sumX = hn::Add(hn::Add(ax, bx), cx);
            volume = hn::Add(volume, hn::Mul(nx, sumX));
            middleX = hn::Add(middleX, sumX);
            middleY = hn::Add(middleY, hn::Add(hn::Add(ay, by), cy));
            middleZ = hn::Add(middleZ, hn::Add(hn::Add(az, bz), cz));
        }
        const V share = hn::Set(d_, 1.0f / static_cast<float>(std::max<std::size_t>(1, state_.triangles.size())));
        volume = hn::Add(hn::Mul(volume, hn::Set(d_, 1.0f / 6.0f)), areaAboveOnFace());
        const V gradient = gradientAt(hn::Mul(middleX, share), hn::Mul(middleY, share), hn::Mul(middleZ, share));
        const V triangles = hn::Set(d_, static_cast<float>(state_.triangleCount));
        hn::StoreInterleaved4(area, volume, hn::Mul(area, gradient), triangles, d_, out);
    }

    HWY_INLINE V mix(V a, V b, V t) const { return hn::Add(a, hn::Mul(t, hn::Sub(b, a))); }
    HWY_INLINE V gradientAt(V x, V y, V z) const {
        const auto step = [&](std::size_t from, std::size_t to) HWY_ATTR { return hn::Sub(corner(to), corner(from)); };
        const V alongX = mix(mix(step(0, 1), step(2, 3), y), mix(step(4, 5), step(6, 7), y), z),
                alongY = mix(mix(step(0, 2), step(1, 3), x), mix(step(4, 6), step(5, 7), x), z),
                alongZ = mix(mix(step(0, 4), step(1, 5), x), mix(step(2, 6), step(3, 7), x), y);
        return lengthOf(parts_.gradientToWorld, alongX, alongY, alongZ);
    }

    // CellMeasure::areaAboveOnFace.
    HWY_INLINE V areaAboveOnFace() const {
        constexpr unsigned kFace = 1;
        const V one = hn::Set(d_, 1.0f), half = hn::Set(d_, 0.5f);
        const auto triangle = [&](unsigned at) HWY_ATTR {
            const V y = place((at & 2) != 0 ? 7 : 5, 1), z = place((at & 1) != 0 ? 11 : 9, 2);
            return hn::Mul(half, hn::Mul((at & 1) != 0 ? hn::Sub(one, y) : y, (at & 2) != 0 ? hn::Sub(one, z) : z));
        };
        const unsigned signs = state_.signs;
        const unsigned above =
            (signs >> 1 & 1u) | (signs >> 3 & 1u) << 1 | (signs >> 5 & 1u) << 2 | (signs >> 7 & 1u) << 3;
        switch (above) {
            case 0: return hn::Zero(d_);
            case 15: return one;
            case 3: return hn::Mul(half, hn::Add(place(9, 2), place(11, 2)));
            case 12: return hn::Sub(one, hn::Mul(half, hn::Add(place(9, 2), place(11, 2))));
            case 5: return hn::Mul(half, hn::Add(place(5, 1), place(7, 1)));
            case 10: return hn::Sub(one, hn::Mul(half, hn::Add(place(5, 1), place(7, 1))));
            default: break;
        }
        const bool isJoined = std::popcount(above) == 3 || (state_.joinedFaces >> kFace & 1) != 0;
        const unsigned cut = isJoined ? ~above & 15u : above; // corners that triangles part from the rest
        V area = hn::Zero(d_);
        for (unsigned at = 0; at < 4; ++at)
            if ((cut >> at & 1u) != 0)
                area = hn::Add(area, triangle(at));
        return isJoined ? hn::Sub(one, area) : area;
    }

    D d_;
    CellBatches::Parts& parts_;
    const cell::CellState& state_;
    std::size_t lane_ = 0;
    alignas(64) std::array<std::array<float, CellBatches::kTogether>, 8> corners_;
};

void measureBatchHere(CellBatches::Parts& parts, std::size_t state) {
    BatchMeasure(parts, cell::cellStates()[state]).run(parts.batches[state]);
}

// Puts a cell into the batch of its state at one isovalue.
HWY_INLINE void addAt(CellBatches::Parts& parts, std::span<const cell::CellState> states, const MeasuredCell& cell,
                      std::size_t k) {
    const hn::CappedTag<double, 8> d;
    const hn::Rebind<float, decltype(d)> floats;
    const double isovalue = parts.isovalues[k];
    alignas(64) std::array<float, 8> scaled;
    unsigned signs = 0;
    bool isFar = false;
    for (std::size_t i = 0; i < 8; i += hn::Lanes(d)) {
        const auto scalars = hn::LoadU(d, cell.scalars.data() + i), level = hn::Set(d, isovalue);
        std::array<std::uint8_t, 8> bits{};
        const auto isAbove = hn::Ge(scalars, level);
        hn::StoreMaskBits(d, isAbove, bits.data());
        signs |= static_cast<unsigned>(bits[0]) << i;
        const auto wide = hn::Mul(hn::Sub(scalars, level), hn::Set(d, parts.scale));
        isFar = isFar || !hn::AllTrue(d, hn::Lt(hn::Abs(wide), hn::Set(d, kMostScaled)));
        const auto nonzero = hn::IfThenElse(isAbove, wide, hn::Min(wide, hn::Set(d, kLeastBelow)));
        hn::Store(hn::DemoteTo(floats, nonzero), floats, scaled.data() + i);
    }
    const auto pattern = static_cast<std::uint8_t>(signs);
    const cell::StateId id =
        parts.isAmbiguous[pattern] ? cell::resolveCell(pattern, cell.scalars, isovalue).state : pattern;
    const auto into = static_cast<std::uint32_t>(2 * k + (cell.isUsual ? 1 : 0));
    if (HWY_UNLIKELY(isFar || states[id].tunnel != cell::Tunnel::None)) {
        const CellSum sum = parts.single.at(cell.scalars, states[id], isovalue);
        parts.sums[into].add(sum.area / parts.areaUnit, sum.volume,
                             parts.gradientShare[into & 1] * (sum.gradient / (parts.areaUnit * parts.gradientUnit)),
                             states[id].triangleCount);
        return;
    }
    CellBatches::Batch& batch = parts.batches[id];
    const hn::CappedTag<float, 4> quarter;
    for (std::size_t i = 0; i < 4; i += hn::Lanes(quarter)) {
        hn::Store(hn::Load(quarter, scaled.data() + i), quarter, batch.lower.data() + 4 * batch.count + i);
        hn::Store(hn::Load(quarter, scaled.data() + 4 + i), quarter, batch.upper.data() + 4 * batch.count + i);
    }
    batch.into[batch.count] = into;
    if (++batch.count == CellBatches::kTogether)
        measureBatchHere(parts, id);
}

void addCellsHere(CellBatches::Parts& parts, std::span<const MeasuredCell> cells) {
    const std::span<const cell::CellState> states = cell::cellStates();
    const hn::CappedTag<std::uint32_t, CellBatches::kTogether> d;
    const std::size_t lanes = hn::Lanes(d);
    for (const MeasuredCell& cell : cells) {
        const auto rank = hn::Set(d, cell.rank);
        for (std::size_t first = cell.first; first < cell.end; first += lanes) {
            std::array<std::uint8_t, 8> bits{};
            hn::StoreMaskBits(d, hn::Not(hn::Gt(rank, hn::LoadU(d, parts.lastRanks.data() + first))), bits.data());
            unsigned looked = static_cast<unsigned>(bits[0]) | static_cast<unsigned>(bits[1]) << 8;
            if (cell.end - first < lanes)
                looked &= (1u << (cell.end - first)) - 1;
            for (; looked != 0; looked &= looked - 1)
                addAt(parts, states, cell, first + static_cast<std::size_t>(std::countr_zero(looked)));
        }
    }
}

} // namespace isoslider::topology::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::topology {

HWY_EXPORT(addCellsHere);
HWY_EXPORT(measureBatchHere);

namespace {

// So that usual differences are about 1.
double scaleOf(const MeasurePlan& plan) {
    for (const double range : {plan.usual.second - plan.usual.first, plan.greatest - plan.least,
                               plan.isovalues.empty() ? 0.0 : plan.isovalues.back() - plan.isovalues.front()})
        if (range > 0.0 && std::isfinite(1.0 / range))
            return 1.0 / range;
    return 1.0;
}

// Divided by its greatest element, which is returned.
double unitOf(const glm::dmat3& matrix, std::array<float, 9>& columns) {
    double greatest = 0.0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            greatest = std::max(greatest, std::abs(matrix[c][r]));
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            columns[static_cast<std::size_t>(3 * c + r)] = static_cast<float>(matrix[c][r] / greatest);
    return greatest;
}

} // namespace

CellBatches::CellBatches(const MeasurePlan& plan, const GridGeometry& geometry)
    : parts_{.isovalues = plan.isovalues, .lastRanks = {}, .scale = scaleOf(plan), .single = CellMeasure(geometry)} {
    for (const double share : plan.shares)
        parts_.lastRanks.push_back(lastRank(share));
    parts_.lastRanks.resize(plan.isovalues.size() + kTogether);
    for (unsigned signs = 0; signs < 256; ++signs)
        parts_.isAmbiguous[signs] = cell::isAmbiguous(static_cast<std::uint8_t>(signs));
    parts_.areaUnit = unitOf(parts_.single.areaToWorld(), parts_.areaToWorld) / 2.0;
    parts_.gradientUnit = unitOf(parts_.single.gradientToWorld(), parts_.gradientToWorld) / parts_.scale;
    // A unit of gradients is the usual range for a step; between values far away they may be as large as the whole
    // range.
    if (const double far = parts_.scale * (plan.greatest - plan.least); far > 1.0 && std::isfinite(far))
        parts_.gradientShare[0] = 1.0 / far;
    parts_.batches.resize(cell::cellStates().size());
    parts_.sums.resize(2 * plan.isovalues.size());
    for (std::size_t e = 0; e < cell::kCellEdges.size(); ++e)
        for (std::size_t axis = 0; axis < 3; ++axis)
            parts_.places[e][axis].fill(static_cast<float>(cell::kCellEdges[e].lowerCorner >> axis & 1));
}

namespace {
constexpr double kRanks = 4294967296.0;
} // namespace

std::uint32_t CellBatches::lastRank(double share) {
    return static_cast<std::uint32_t>(std::min(kRanks - 1.0, share * kRanks));
}

double CellBatches::weight(double share) { return kRanks / (static_cast<double>(lastRank(share)) + 1.0); }

void CellBatches::add(std::span<const MeasuredCell> cells) { HWY_DYNAMIC_DISPATCH(addCellsHere)(parts_, cells); }

const std::vector<ExactSum>& CellBatches::finish() {
    for (std::size_t state = 0; state < parts_.batches.size(); ++state)
        if (parts_.batches[state].count > 0)
            HWY_DYNAMIC_DISPATCH(measureBatchHere)(parts_, state);
    return parts_.sums;
}

BatchSum CellBatches::measured(std::size_t element, const ExactSum& sum) const {
    BatchSum found = sum.sum();
    found.area *= parts_.areaUnit;
    found.gradient *= parts_.areaUnit * parts_.gradientUnit / parts_.gradientShare[element & 1];
    return found;
}

} // namespace isoslider::topology
#endif
