#include "core/topology/analysis/layer_measures.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "core/cell/cell_states.h"
#include "core/grid/scalar_type.h"

namespace isoslider::topology {
namespace {

using cell::CornerScalars;

class CellMeasure {
public:
    explicit CellMeasure(const GridGeometry& geometry)
        : toWorld_(geometry.direction *
                   glm::dmat3(geometry.spacing.x, 0, 0, 0, geometry.spacing.y, 0, 0, 0, geometry.spacing.z)),
          gradientToWorld_(glm::transpose(glm::inverse(toWorld_))),
          areaToWorld_(glm::determinant(toWorld_) * gradientToWorld_) {
        for (unsigned signs = 0; signs < 256; ++signs) {
            const auto pattern = static_cast<std::uint8_t>(signs);
            isAmbiguous_[signs] = cell::isAmbiguous(pattern);
            activeEdges_[signs] = cell::activeEdges(pattern);
        }
        for (std::size_t e = 0; e < cell::kCellEdges.size(); ++e) {
            const unsigned corner = cell::kCellEdges[e].lowerCorner;
            places_[e] = {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
        }
    }

    MeasureSums::Sum at(const CornerScalars& scalars, double isovalue) {
        unsigned signs = 0;
        for (unsigned c = 0; c < 8; ++c)
            signs |= (scalars[c] >= isovalue ? 1u : 0u) << c;
        const auto pattern = static_cast<std::uint8_t>(signs);
        const cell::StateId id =
            isAmbiguous_[pattern] ? cell::resolveCell(pattern, scalars, true, isovalue).state : pattern;
        const cell::CellState& state = states_[id];
        for (unsigned edges = activeEdges_[pattern]; edges != 0; edges &= edges - 1) {
            const auto e = static_cast<std::size_t>(std::countr_zero(edges));
            const auto& edge = cell::kCellEdges[e];
            const double a = scalars[edge.lowerCorner], b = scalars[edge.upperCorner];
            places_[e][edge.axis] = (isovalue - a) / (b - a); // the others are those of the edge
        }
        if (state.innerVertices > 0)
            placeInner(scalars, state, isovalue);
        MeasureSums::Sum sum;
        sum.triangles = state.triangleCount;
        glm::dvec3 middle{0.0};
        for (std::size_t t = 0; t < state.triangles.size(); t += 3) {
            const glm::dvec3 &a = places_[state.triangles[t]], &b = places_[state.triangles[t + 1]],
                             &c = places_[state.triangles[t + 2]];
            const glm::dvec3 normal = glm::cross(b - a, c - a); // twice as long as the triangle is large
            const glm::dvec3 corners = a + b + c;
            sum.area += glm::length(areaToWorld_ * normal);
            // Of the field (x, 0, 0) through the triangle, which is wound so that it faces what is below.
            sum.volume += normal.x * corners.x;
            middle += corners;
        }
        sum.area *= 0.5;
        sum.volume = sum.volume / 6.0 + areaAboveOnFace(state);
        middle /= std::max<double>(1.0, static_cast<double>(state.triangles.size()));
        const auto gradient = cell::gradientInCell(scalars, middle.x, middle.y, middle.z);
        sum.gradient = sum.area * glm::length(gradientToWorld_ * glm::dvec3(gradient[0], gradient[1], gradient[2]));
        return sum;
    }

private:
    // Of the unit square beyond a cell at x = 1: how much is above, within the mesh's segments.
    double areaAboveOnFace(const cell::CellState& state) const {
        constexpr unsigned kFace = 1;
        // Of corner i of the face, at (i & 1, i >> 1) in y and z: the triangle between it and its two edges' vertices.
        const auto triangle = [this](unsigned corner) {
            const double y = places_[(corner & 2) != 0 ? 7 : 5].y, z = places_[(corner & 1) != 0 ? 11 : 9].z;
            return 0.5 * ((corner & 1) != 0 ? 1.0 - y : y) * ((corner & 2) != 0 ? 1.0 - z : z);
        };
        const unsigned above = (state.signs >> 1 & 1u) | (state.signs >> 3 & 1u) << 1 | (state.signs >> 5 & 1u) << 2 |
                               (state.signs >> 7 & 1u) << 3;
        switch (above) {
            case 0: return 0.0;
            case 15: return 1.0;
            case 3: return 0.5 * (places_[9].z + places_[11].z);
            case 12: return 1.0 - 0.5 * (places_[9].z + places_[11].z);
            case 5: return 0.5 * (places_[5].y + places_[7].y);
            case 10: return 1.0 - 0.5 * (places_[5].y + places_[7].y);
            default: break;
        }
        const bool isJoined = std::popcount(above) == 3 || (state.joinedFaces >> kFace & 1) != 0;
        const unsigned cut = isJoined ? ~above & 15u : above; // corners that triangles part from the rest
        double area = 0.0;
        for (unsigned corner = 0; corner < 4; ++corner)
            area += (cut >> corner & 1u) != 0 ? triangle(corner) : 0.0;
        return isJoined ? 1.0 - area : area;
    }

    void placeInner(const CornerScalars& scalars, const cell::CellState& state, double isovalue) {
        std::size_t inner = cell::kInnerVertex;
        if (state.tunnel != cell::Tunnel::None) {
            const cell::TunnelWaist waist = cell::tunnelWaist(scalars, isovalue, 1.0 / 2048.0);
            for (const std::uint8_t corner : state.ring)
                places_[inner++] = {waist.x[corner & 1], waist.y[corner >> 1 & 1], waist.z[corner >> 2 & 1]};
        }
        for (const cell::CellCentre& centre : state.centres) {
            glm::dvec3 sum{0.0};
            for (unsigned edges = centre.loopEdges; edges != 0; edges &= edges - 1)
                sum += places_[static_cast<std::size_t>(std::countr_zero(edges))];
            places_[inner++] = sum / static_cast<double>(std::popcount(centre.loopEdges));
        }
    }

    glm::dmat3 toWorld_, gradientToWorld_, areaToWorld_; ///< the last of what is normal to an area
    std::span<const cell::CellState> states_ = cell::cellStates();
    std::array<bool, 256> isAmbiguous_{};
    std::array<std::uint16_t, 256> activeEdges_{};
    std::array<glm::dvec3, cell::kInnerVertex + cell::kMaxInnerVertices> places_{};
};

// How many isovalues a scalar reaches: a table to begin with, then a look at the next ones.
class IsovalueFinder {
public:
    explicit IsovalueFinder(const std::vector<double>& isovalues) : isovalues_(isovalues) {
        least_ = isovalues.front();
        scale_ = static_cast<double>(kParts) / (isovalues.back() - least_);
        for (std::size_t i = 0, k = 0; i <= kParts; ++i) {
            while (k < isovalues.size() && (isovalues[k] - least_) * scale_ < static_cast<double>(i))
                ++k;
            start_[i] = static_cast<std::uint32_t>(k);
        }
    }
    std::size_t reached(double scalar) const {
        const double part = (scalar - least_) * scale_;
        if (!(part >= 0.0))
            return 0;
        if (!(part < static_cast<double>(kParts)))
            return firstBeyond(start_[kParts], isovalues_.size(), scalar);
        const auto at = static_cast<std::size_t>(part);
        return firstBeyond(start_[at], start_[at + 1], scalar);
    }

private:
    // Between these two, but for rounding. All may lie in one part, where a few lie far away.
    std::size_t firstBeyond(std::size_t from, std::size_t to, double scalar) const {
        const auto begin = isovalues_.begin();
        auto k = static_cast<std::size_t>(std::upper_bound(begin + static_cast<std::ptrdiff_t>(from),
                                                           begin + static_cast<std::ptrdiff_t>(to), scalar) -
                                          begin);
        while (k > 0 && isovalues_[k - 1] > scalar)
            --k;
        while (k < isovalues_.size() && isovalues_[k] <= scalar)
            ++k;
        return k;
    }

    static constexpr std::size_t kParts = 4096;
    const std::vector<double>& isovalues_;
    double least_, scale_;
    std::array<std::uint32_t, kParts + 1> start_{};
};

// Cells spread evenly whatever their number: multiples of three irrational numbers (Roberts' R3 sequence).
std::uint32_t rankOf(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint32_t>(x) * 3518319153u + static_cast<std::uint32_t>(y) * 2882110345u +
           static_cast<std::uint32_t>(z) * 2360945575u;
}

} // namespace

void MeasureSums::add(const MeasureSums& other) {
    sums.resize(other.sums.size());
    cellsAbove.resize(other.cellsAbove.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        sums[i].area += other.sums[i].area;
        sums[i].volume += other.sums[i].volume;
        sums[i].triangles += other.sums[i].triangles;
        sums[i].gradient += other.sums[i].gradient;
        sums[i].usualArea += other.sums[i].usualArea;
        sums[i].usualGradient += other.sums[i].usualGradient;
    }
    for (std::size_t i = 0; i < cellsAbove.size(); ++i)
        cellsAbove[i] += other.cellsAbove[i];
}

MeasureCurves MeasureSums::curves(const MeasurePlan& plan, const GridGeometry& geometry) const {
    MeasureCurves curves;
    if (sums.empty())
        return curves;
    const double cell =
        std::abs(glm::determinant(geometry.direction) * geometry.spacing.x * geometry.spacing.y * geometry.spacing.z);
    curves.isovalues = plan.isovalues;
    curves.measures.resize(sums.size());
    double whole = 0.0; // cells above the isovalue
    for (std::size_t i = sums.size(); i-- > 0;) {
        whole += static_cast<double>(cellsAbove[i + 1]);
        const auto finite = [](double value) { return std::isfinite(value) ? value : 0.0; };
        // One sample that is orders of magnitude away has cells so steep that no mean would tell of any other.
        const bool isUsual = sums[i].usualArea > 0.0;
        const double area = isUsual ? sums[i].usualArea : sums[i].area;
        const double gradient = isUsual ? sums[i].usualGradient : sums[i].gradient;
        curves.measures[i] = {finite(sums[i].area), finite(cell * (whole + sums[i].volume)), sums[i].triangles,
                              area > 0.0 ? finite(gradient / area) : 0.0};
    }
    // Nothing is left of the surface at the least and greatest sample.
    whole += static_cast<double>(cellsAbove[0]);
    curves.isovalues.insert(curves.isovalues.begin(), plan.least);
    curves.measures.insert(curves.measures.begin(), {0.0, cell * whole, 0.0, 0.0});
    curves.isovalues.push_back(plan.greatest);
    curves.measures.push_back({});
    return curves;
}

template <class Sample>
MeasureSums measureLayer(const LayerWindow<Sample>& window, const MeasurePlan& plan, const GridGeometry& geometry) {
    MeasureSums found;
    if (plan.isovalues.empty())
        return found;
    found.sums.resize(plan.isovalues.size());
    found.cellsAbove.resize(plan.isovalues.size() + 1);
    constexpr double kRanks = 4294967296.0;
    std::vector<std::uint32_t> lastRank; // those up to it are looked at
    std::vector<double> weight;
    for (const double share : plan.shares) {
        lastRank.push_back(static_cast<std::uint32_t>(std::min(kRanks - 1.0, share * kRanks)));
        weight.push_back(kRanks / (static_cast<double>(lastRank.back()) + 1.0));
    }
    const IsovalueFinder finder(plan.isovalues);
    CellMeasure measure(geometry);
    const std::int64_t nx = window.dims[0], row = window.rowStep(), plane = window.planeStep();
    std::vector<Sample> least(static_cast<std::size_t>(nx)), most(least.size());
    for (std::int64_t z = window.zBegin; z < window.zEnd; ++z)
        for (std::int64_t y = 0; y + 1 < window.dims[1] && !window.stop.stop_requested(); ++y) {
            const std::int64_t start = row * y + plane * (z - window.zBegin);
            const Sample* const s = window.layer() + start;
            for (std::int64_t x = 0; x + 1 < nx; ++x) {
                const auto pair = [&](std::int64_t at, auto pick) { return pick(s[at + x], s[at + x + 1]); };
                const auto four = [&](auto pick) {
                    return pick(pick(pair(0, pick), pair(row, pick)), pick(pair(plane, pick), pair(plane + row, pick)));
                };
                least[static_cast<std::size_t>(x)] = four([](Sample a, Sample b) { return std::min(a, b); });
                most[static_cast<std::size_t>(x)] = four([](Sample a, Sample b) { return std::max(a, b); });
            }
            for (std::int64_t x = 0; x + 1 < nx; ++x) {
                if ((window.stars[static_cast<std::size_t>(start + x)] & 0x80) == 0)
                    continue;
                const auto high = static_cast<double>(most[static_cast<std::size_t>(x)]);
                const auto low = static_cast<double>(least[static_cast<std::size_t>(x)]);
                std::size_t k = finder.reached(low);
                ++found.cellsAbove[k];
                if (k == plan.isovalues.size() || high < plan.isovalues[k])
                    continue;
                const std::uint32_t rank = rankOf(x, y, z);
                CornerScalars scalars;
                for (std::int64_t c = 0; c < 8; ++c)
                    scalars[static_cast<std::size_t>(c)] =
                        static_cast<double>(s[x + (c & 1) + row * (c >> 1 & 1) + plane * (c >> 2)]);
                for (; k < plan.isovalues.size() && plan.isovalues[k] <= high; ++k) {
                    if (rank > lastRank[k])
                        continue;
                    const MeasureSums::Sum sum = measure.at(scalars, plan.isovalues[k]);
                    MeasureSums::Sum& into = found.sums[k];
                    into.area += weight[k] * sum.area;
                    into.volume += weight[k] * sum.volume;
                    into.triangles += weight[k] * sum.triangles;
                    into.gradient += weight[k] * sum.gradient;
                    if (low >= plan.usual.first && high <= plan.usual.second) {
                        into.usualArea += weight[k] * sum.area;
                        into.usualGradient += weight[k] * sum.gradient;
                    }
                }
            }
        }
    return found;
}

#define ISO_INSTANTIATE(Sample, Name) \
    template MeasureSums measureLayer(const LayerWindow<Sample>&, const MeasurePlan&, const GridGeometry&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
