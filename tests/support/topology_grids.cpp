#include "tests/support/topology_grids.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

namespace isoslider::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What a kind of grid holds at a place.
class Filler {
public:
    Filler(GridKind kind, const std::array<std::int64_t, 3>& dims, Random& random)
        : kind_(kind), dims_(dims), random_(random) {
        for (double& term : terms_)
            term = static_cast<double>(pickInt(random, -3, 3));
        share_ = 0.15 + 0.4 * pickUnit(random);
        spread_ = 5.0 * pickUnit(random);
        sign_ = pickInt(random, 0, 1) != 0 ? 1.0 : -1.0;
        extreme_ = std::array{CellKind::Denormal, CellKind::HugeFloats,
                              CellKind::HugeDoubles}[static_cast<std::size_t>(pickInt(random, 0, 2))];
    }

    double operator()(std::int64_t x, std::int64_t y, std::int64_t z) {
        const double parity = (x + y + z) % 2 == 0 ? 1.0 : -1.0;
        switch (kind_) {
            case GridKind::Open: return integer(127);
            case GridKind::TinyIntegers: return integer(2);
            case GridKind::SmallIntegers: return integer(9);
            case GridKind::Closed:
                return isOnBox(x, y, z) ? static_cast<double>(pickInt(random_, -127, -1)) : integer(127);
            case GridKind::Saddles: return sign_ * (pickUnit(random_) < share_ ? strength(60) : -strength(6));
            case GridKind::Checkerboard: return parity * std::round(std::exp(spread_ * pickUnit(random_)));
            case GridKind::PlusMinusOne: return pickInt(random_, 0, 19) == 0 ? integer(1) : parity;
            case GridKind::Plane: return linear(0, x, y, z);
            case GridKind::NearTies: return disturbed(linear(0, x, y, z) * linear(4, x, y, z));
            case GridKind::Doubles: return 2.0 * pickUnit(random_) - 1.0;
            case GridKind::Extreme: return randomCell(extreme_, random_)[0];
        }
        return 0.0;
    }

private:
    double integer(std::int64_t most) { return static_cast<double>(pickInt(random_, -most, most)); }
    double strength(std::int64_t most) { return static_cast<double>(pickInt(random_, 1, most)); }
    bool isOnBox(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return x == 0 || y == 0 || z == 0 || x + 1 == dims_[0] || y + 1 == dims_[1] || z + 1 == dims_[2];
    }
    double linear(std::size_t first, std::int64_t x, std::int64_t y, std::int64_t z) const {
        return terms_[first] + terms_[first + 1] * static_cast<double>(x - 2) +
               terms_[first + 2] * static_cast<double>(y - 2) + terms_[first + 3] * static_cast<double>(z - 2);
    }
    double disturbed(double value) {
        if (pickInt(random_, 0, 3) != 0)
            return value;
        return value + static_cast<double>(pickInt(random_, -1, 1)) * static_cast<double>(FLT_EPSILON) *
                           std::max(1.0, std::abs(value));
    }

    GridKind kind_;
    std::array<std::int64_t, 3> dims_;
    Random& random_;
    std::array<double, 8> terms_;
    double share_, spread_, sign_;
    CellKind extreme_;
};

template <class Sample>
bool holdsAll(const std::vector<double>& scalars) {
    return std::all_of(scalars.begin(), scalars.end(), [](double scalar) {
        const bool isInRange = std::abs(scalar) <= static_cast<double>(std::numeric_limits<Sample>::max());
        return isInRange && static_cast<double>(static_cast<Sample>(scalar)) == scalar;
    });
}

template <class Sample>
std::shared_ptr<const ScalarGrid> gridOf(ScalarType type, const GridGeometry& geometry,
                                         const std::vector<double>& scalars) {
    std::vector<Sample> samples;
    for (const double scalar : scalars)
        samples.push_back(static_cast<Sample>(scalar));
    return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<Sample>(geometry, type, samples));
}

} // namespace

CellScalars TopologyGrid::cell(std::int64_t x, std::int64_t y, std::int64_t z) const {
    CellScalars corners;
    for (std::int64_t i = 0; i < 8; ++i) {
        const std::int64_t point = x + (i & 1) + dims[0] * (y + (i >> 1 & 1) + dims[1] * (z + (i >> 2)));
        corners[static_cast<std::size_t>(i)] = scalars[static_cast<std::size_t>(point)];
    }
    return corners;
}

double TopologyGrid::min() const { return *std::min_element(scalars.begin(), scalars.end()); }
double TopologyGrid::max() const { return *std::max_element(scalars.begin(), scalars.end()); }

const char* gridKindName(GridKind kind) {
    static constexpr const char* kNames[kGridKinds] = {"open",      "tiny integers", "small integers", "closed",
                                                       "saddles",   "checkerboard",  "plus minus one", "plane",
                                                       "near ties", "doubles",       "extreme"};
    return kNames[static_cast<int>(kind)];
}

TopologyGrid makeTopologyGrid(std::vector<double> scalars, const std::array<std::int64_t, 3>& dims,
                              std::string description) {
    GridGeometry geometry;
    for (int axis = 0; axis < 3; ++axis)
        geometry.dims[axis] = dims[static_cast<std::size_t>(axis)];
    TopologyGrid result{nullptr, std::move(scalars), dims, std::move(description)};
    if (holdsAll<std::int8_t>(result.scalars))
        result.grid = gridOf<std::int8_t>(ScalarType::I8, geometry, result.scalars);
    else if (holdsAll<std::int16_t>(result.scalars))
        result.grid = gridOf<std::int16_t>(ScalarType::I16, geometry, result.scalars);
    else if (holdsAll<float>(result.scalars))
        result.grid = gridOf<float>(ScalarType::F32, geometry, result.scalars);
    else
        result.grid = gridOf<double>(ScalarType::F64, geometry, result.scalars);
    return result;
}

TopologyGrid randomTopologyGrid(GridKind kind, std::int64_t shortest, std::int64_t longest, Random& random) {
    std::array<std::int64_t, 3> dims;
    for (std::int64_t& n : dims)
        n = pickInt(random, shortest, longest);
    Filler scalarAt(kind, dims, random);
    std::vector<double> scalars;
    for (std::int64_t z = 0; z < dims[2]; ++z)
        for (std::int64_t y = 0; y < dims[1]; ++y)
            for (std::int64_t x = 0; x < dims[0]; ++x)
                scalars.push_back(scalarAt(x, y, z));
    return makeTopologyGrid(std::move(scalars), dims,
                            std::string(gridKindName(kind)) + " " + std::to_string(dims[0]) + "x" +
                                std::to_string(dims[1]) + "x" + std::to_string(dims[2]));
}

namespace {

double anyIsovalue(const TopologyGrid& grid, Random& random) {
    const auto last = [](const auto& list) { return static_cast<std::int64_t>(list.size()) - 1; };
    const auto sample = [&] { return grid.scalars[static_cast<std::size_t>(pickInt(random, 0, last(grid.scalars)))]; };
    double target = sample();
    std::array<std::int64_t, 3> p;
    for (std::size_t axis = 0; axis < 3; ++axis)
        p[axis] = pickInt(random, 0, std::max<std::int64_t>(0, grid.dims[axis] - 2));
    const CellScalars cell = grid.cell(p[0], p[1], p[2]);
    const std::int64_t choice = pickInt(random, 0, 9);
    if (const auto saddles = faceSaddleValues(cell); choice < 3 && !saddles.empty())
        target = saddles[static_cast<std::size_t>(pickInt(random, 0, last(saddles)))];
    else if (const auto bodies = bodySaddleValues(cell); choice < 6 && !bodies.empty())
        target = bodies[static_cast<std::size_t>(pickInt(random, 0, last(bodies)))];
    else if (choice == 9)
        return grid.min() + (grid.max() - grid.min()) * (1.2 * pickUnit(random) - 0.1);
    switch (pickInt(random, 0, 7)) {
        case 0: return std::nextafter(target, kInfinity);
        case 1: return std::nextafter(target, -kInfinity);
        case 2: return std::round(target);
        case 3: return target + (pickUnit(random) - 0.5) * 1e-9 * (grid.max() - grid.min());
        case 4: return 0.5 * (target + sample());
        default: return target;
    }
}

} // namespace

double topologyIsovalue(const TopologyGrid& grid, Random& random) {
    const double isovalue = anyIsovalue(grid, random);
    return std::isfinite(isovalue) ? isovalue : 0.0;
}

} // namespace isoslider::test
