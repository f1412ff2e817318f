#include "tests/support/cell_cases.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <sstream>

namespace isoslider::test {

const std::vector<std::array<std::uint8_t, 8>>& cubeSymmetries() {
    static const auto kSymmetries = [] {
        std::vector<std::array<std::uint8_t, 8>> symmetries;
        std::array<unsigned, 3> axes{0, 1, 2};
        do {
            for (unsigned flip = 0; flip < 8; ++flip) {
                std::array<std::uint8_t, 8> symmetry{};
                for (unsigned i = 0; i < 8; ++i) {
                    unsigned from = 0;
                    for (unsigned axis = 0; axis < 3; ++axis)
                        from |= (i >> axis & 1u) << axes[axis];
                    symmetry[i] = static_cast<std::uint8_t>(from ^ flip);
                }
                symmetries.push_back(symmetry);
            }
        } while (std::next_permutation(axes.begin(), axes.end()));
        return symmetries;
    }();
    return kSymmetries;
}

CellScalars turned(const CellScalars& scalars, int symmetry) {
    const auto& from = cubeSymmetries()[static_cast<std::size_t>(symmetry % 48)];
    CellScalars result;
    for (std::size_t i = 0; i < 8; ++i)
        result[i] = symmetry < 48 ? scalars[from[i]] : -scalars[from[i]];
    return result;
}

const char* cellKindName(CellKind kind) {
    static constexpr const char* kNames[kCellKinds] = {"uniform",   "tiny integers", "small integers", "saddle",
                                                       "decades",   "plane",         "near plane",     "degenerate",
                                                       "body ties", "powers of two", "scaled",         "signed zeros",
                                                       "denormal",  "huge floats",   "huge doubles"};
    return kNames[static_cast<int>(kind)];
}

namespace {

template <class Function>
CellScalars eachCorner(Function&& scalarAt) {
    CellScalars scalars;
    for (unsigned i = 0; i < 8; ++i)
        scalars[i] = scalarAt(i & 1u, i >> 1 & 1u, i >> 2 & 1u);
    return scalars;
}

CellScalars saddleCell(Random& random, double greatestSpread) {
    // Any signs, or two that leave most open: the checkerboard and its like with one corner changed.
    const auto any = static_cast<unsigned>(pickInt(random, 0, 255));
    const unsigned checker = pickInt(random, 0, 1) != 0 ? 0b10010110u : 0b01101001u;
    const unsigned signs =
        std::array{any, checker, checker ^ 1u << (any & 7u)}[static_cast<std::size_t>(pickInt(random, 0, 2))];
    const double spread = greatestSpread * pickUnit(random);
    CellScalars scalars;
    for (unsigned i = 0; i < 8; ++i)
        scalars[i] = ((signs >> i & 1u) != 0 ? 1.0 : -1.0) * std::exp(spread * pickUnit(random));
    return scalars;
}

CellScalars planeCell(Random& random) {
    const auto term = [&] { return static_cast<double>(pickInt(random, -3, 3)); };
    const double x = term(), y = term(), z = term(), xy = pickInt(random, 0, 2) == 0 ? term() : 0.0, constant = term();
    return eachCorner(
        [&](unsigned i, unsigned j, unsigned k) { return constant + x * i + y * j + z * k + xy * i * j; });
}

CellScalars nearPlaneCell(Random& random) {
    CellScalars scalars = planeCell(random);
    const double scale = pickInt(random, 0, 1) != 0 ? 1.0 : 0.1; // a tenth rounds
    for (double& scalar : scalars) {
        scalar *= scale;
        if (pickInt(random, 0, 2) == 0)
            scalar += static_cast<double>(pickInt(random, -2, 2)) * DBL_EPSILON * std::max(std::abs(scalar), 0.25);
    }
    return scalars;
}

CellScalars degenerateCell(Random& random) {
    const auto digit = [&] { return static_cast<double>(pickInt(random, -1, 1)); };
    if (pickInt(random, 0, 1) != 0) {
        const double low = digit(), high = digit();
        return eachCorner([&](unsigned, unsigned, unsigned) { return pickInt(random, 0, 1) != 0 ? low : high; });
    }
    std::array<double, 6> factor;
    for (double& f : factor)
        f = static_cast<double>(pickInt(random, -2, 2));
    return eachCorner([&](unsigned i, unsigned j, unsigned k) { return factor[i] * factor[2 + j] * factor[4 + k]; });
}

// XYZ - Y0 Z0 X - X0 Z0 Y - X0 Y0 Z + 2 X0 Y0 Z0 vanishes with its gradient at (X0, Y0, Z0); X = x - u and so
// on. All in eighths, and times a factor, so that values are integers of up to 40 bits.
CellScalars bodyTieCell(Random& random) {
    std::array<double, 3> origin, critical;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t place = pickInt(random, 1, 7); // of the critical point, from the cell's corner 0
        critical[a] = static_cast<double>(pickInt(random, 1, 12) * (pickInt(random, 0, 1) != 0 ? 1 : -1));
        origin[a] = static_cast<double>(place) - critical[a];
    }
    const double factor = static_cast<double>(pickInt(random, 1, 3) * (std::int64_t{1} << pickInt(random, 0, 25)) +
                                              pickInt(random, 0, 5)) *
                          (pickInt(random, 0, 1) != 0 ? 1.0 : -1.0);
    return eachCorner([&](unsigned i, unsigned j, unsigned k) {
        const double x = 8.0 * i - origin[0], y = 8.0 * j - origin[1], z = 8.0 * k - origin[2];
        const auto& [x0, y0, z0] = critical;
        return factor * (x * y * z - y0 * z0 * x - x0 * z0 * y - x0 * y0 * z + 2.0 * x0 * y0 * z0);
    });
}

CellScalars powersOfTwoCell(Random& random) {
    const int step = static_cast<int>(pickInt(random, 1, 4)) * 20;
    return eachCorner([&](unsigned, unsigned, unsigned) {
        const double sign = pickInt(random, 0, 1) != 0 ? 1.0 : -1.0;
        return std::ldexp(sign, step * static_cast<int>(pickInt(random, -1, 1)));
    });
}

CellScalars scaledCell(Random& random) {
    const int exponent = static_cast<int>(pickInt(random, 480, 545)) * (pickInt(random, 0, 1) != 0 ? 1 : -1);
    return eachCorner([&](unsigned, unsigned, unsigned) {
        const double digit = static_cast<double>(pickInt(random, -9, 9));
        return std::ldexp(pickInt(random, 0, 3) == 0 ? digit * 0.1 : digit, exponent);
    });
}

double hugeFloat(Random& random) {
    static constexpr std::array<float, 7> kValues = {FLT_MAX, -FLT_MAX,    FLT_MIN,     -FLT_TRUE_MIN,
                                                     1.0F,    FLT_MAX / 2, -FLT_MAX / 3};
    const auto pick = static_cast<std::size_t>(pickInt(random, 0, 13));
    if (pick < kValues.size())
        return static_cast<double>(kValues[pick]);
    return std::ldexp(2.0 * pickUnit(random) - 1.0, static_cast<int>(pickInt(random, -140, 128)));
}

double hugeDouble(Random& random) {
    static constexpr std::array<double, 7> kValues = {DBL_MAX, -DBL_MAX,    DBL_MIN,     -DBL_TRUE_MIN,
                                                      1.0,     DBL_MAX / 2, -DBL_MAX / 3};
    const auto pick = static_cast<std::size_t>(pickInt(random, 0, 13));
    if (pick < kValues.size())
        return kValues[pick];
    return std::ldexp(2.0 * pickUnit(random) - 1.0, static_cast<int>(pickInt(random, -1060, 1023)));
}

} // namespace

CellScalars randomCell(CellKind kind, Random& random) {
    const auto each = [&](auto&& draw) { return eachCorner([&](unsigned, unsigned, unsigned) { return draw(); }); };
    switch (kind) {
        case CellKind::Uniform: return each([&] { return 2.0 * pickUnit(random) - 1.0; });
        case CellKind::TinyIntegers: return each([&] { return static_cast<double>(pickInt(random, -2, 2)); });
        case CellKind::SmallIntegers: return each([&] { return static_cast<double>(pickInt(random, -9, 9)); });
        case CellKind::Saddle: return saddleCell(random, 4.0);
        case CellKind::Decades: return saddleCell(random, 80.0);
        case CellKind::Plane: return planeCell(random);
        case CellKind::NearPlane: return nearPlaneCell(random);
        case CellKind::Degenerate: return degenerateCell(random);
        case CellKind::BodyTies: return bodyTieCell(random);
        case CellKind::PowersOfTwo: return powersOfTwoCell(random);
        case CellKind::Scaled: return scaledCell(random);
        case CellKind::SignedZeros:
            return each(
                [&] { return std::copysign(static_cast<double>(pickInt(random, 0, 2) / 2), pickUnit(random) - 0.5); });
        case CellKind::Denormal:
            return each([&] { return static_cast<double>(pickInt(random, -9, 9)) * DBL_TRUE_MIN; });
        case CellKind::HugeFloats: return each([&] { return hugeFloat(random); });
        case CellKind::HugeDoubles: return each([&] { return hugeDouble(random); });
    }
    return {};
}

namespace {

double anyIsovalue(const CellScalars& scalars, Random& random) {
    const auto any = [&] { return scalars[static_cast<std::size_t>(pickInt(random, 0, 7))]; };
    switch (pickInt(random, 0, 7)) {
        case 0:
        case 1: return 0.0;
        case 2: return any();
        case 3: return std::nextafter(any(), std::numeric_limits<double>::infinity());
        case 4: return std::nextafter(any(), -std::numeric_limits<double>::infinity());
        case 5:
            if (const auto saddles = faceSaddleValues(scalars); !saddles.empty())
                return saddles[static_cast<std::size_t>(
                    pickInt(random, 0, static_cast<std::int64_t>(saddles.size()) - 1))];
            break;
        case 6:
            if (const auto saddles = bodySaddleValues(scalars); !saddles.empty())
                return saddles[static_cast<std::size_t>(
                    pickInt(random, 0, static_cast<std::int64_t>(saddles.size()) - 1))];
            break;
        default: break;
    }
    const double share = pickUnit(random), low = any(), high = any();
    return low * (1.0 - share) + high * share;
}

} // namespace

double randomIsovalue(const CellScalars& scalars, Random& random) {
    const double isovalue = anyIsovalue(scalars, random);
    return std::isfinite(isovalue) ? isovalue : 0.0;
}

std::vector<double> faceSaddleValues(const CellScalars& scalars) {
    std::vector<double> values;
    for (unsigned axis = 0; axis < 3; ++axis)
        for (unsigned side = 0; side < 2; ++side) {
            const unsigned base = side << axis, b = 1u << (axis + 1) % 3, c = 1u << (axis + 2) % 3;
            const double p = scalars[base], q = scalars[base | b], r = scalars[base | b | c], s = scalars[base | c];
            const double value = (p * r - q * s) / (p + r - q - s);
            const bool isSaddle = std::min(p, r) > std::max(q, s) || std::max(p, r) < std::min(q, s);
            if (isSaddle && std::isfinite(value))
                values.push_back(value);
        }
    return values;
}

std::vector<double> bodySaddleValues(const CellScalars& v) {
    // f = k xyz + a xy + b yz + c zx + d x + e y + g z + h; with the axes moved to where the mixed terms
    // vanish, k XYZ + p X + q Y + r Z + s, critical where pX = qY = rZ = -w, w^2 = -pqr / k.
    const double h = v[0], d = v[1] - h, e = v[2] - h, g = v[4] - h;
    const double a = v[3] - v[1] - v[2] + h, b = v[6] - v[2] - v[4] + h, c = v[5] - v[1] - v[4] + h;
    const double k = v[7] - v[3] - v[5] - v[6] + v[1] + v[2] + v[4] - h;
    const double p = d - c * a / k, q = e - a * b / k, r = g - b * c / k;
    const double square = -p * q * r / k;
    std::vector<double> values;
    if (!(square > 0.0) || !std::isfinite(square))
        return values;
    for (const double w : {std::sqrt(square), -std::sqrt(square)}) {
        const double x = -w / p - b / k, y = -w / q - c / k, z = -w / r - a / k;
        if (!(x > 0.0 && x < 1.0 && y > 0.0 && y < 1.0 && z > 0.0 && z < 1.0))
            continue;
        const double value = h + x * (d + a * y + c * z + k * y * z) + y * (e + b * z) + g * z;
        if (std::isfinite(value))
            values.push_back(value);
    }
    return values;
}

std::string toString(const CellScalars& scalars, double isovalue) {
    std::ostringstream text;
    text.precision(17);
    text << "{{";
    for (std::size_t i = 0; i < 8; ++i)
        text << (i > 0 ? ", " : "") << scalars[i];
    text << "}}, isovalue " << isovalue;
    return text.str();
}

} // namespace isoslider::test
