#include "core/cell/trilinear_cell.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <boost/multiprecision/cpp_int.hpp>

#include "core/cell/cell_polynomials.h"
#include "core/cell/cell_states.h"
#include "core/cell/exact_sign.h"
#include "core/cell/plain_decisions.h"
#include "core/grid/scalar_key.h"

namespace isoslider::cell {
namespace {

using BigInteger = boost::multiprecision::cpp_int;
// Without memory from the heap.
using MediumInteger = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    512, 512, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;
using WideInteger = __int128; // NOLINT: an extension that GCC and Clang share

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Signs: -1, 0, 1, or kUnknown where the error bound is larger than the value.
int signOf(const Bounded& x) { return x.isCertainlyPositive() ? 1 : x.isCertainlyNegative() ? -1 : kUnknown; }
int signOf(WideInteger x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
template <class Integer>
int signOf(const Integer& x) {
    return x.sign();
}

// Widths in bits of scalar - isovalue up to which the polynomials fit into 128 and 512 bits: the discriminant has
// degree 4, and its terms add 7 bits.
constexpr int kWideBits = 29;
constexpr int kMediumBits = 126;

template <class Integer>
Integer toInteger(double number, int lowest) {
    int exponent = 0;
    const double fraction = std::frexp(number, &exponent);
    Integer integer = static_cast<std::int64_t>(std::ldexp(fraction, 53));
    const int shift = exponent - 53 - lowest;
    if (shift >= 0)
        integer <<= shift;
    else
        integer >>= -shift; // zeros only
    return integer;
}

// Exact scalar - isovalue on a common lattice; the last of `numbers` is the isovalue.
template <class Integer, std::size_t N>
std::array<Integer, N - 1> differences(const std::array<double, N>& numbers) {
    const int lowest = latticeOf(numbers).lowest;
    const Integer isovalue = toInteger<Integer>(numbers[N - 1], lowest);
    std::array<Integer, N - 1> g;
    for (std::size_t i = 0; i + 1 < N; ++i)
        g[i] = toInteger<Integer>(numbers[i], lowest) - isovalue;
    return g;
}

std::array<WideInteger, 8> wideDifferences(const std::array<double, 9>& numbers) {
    const int lowest = latticeOf(numbers).lowest;
    std::array<WideInteger, 8> g;
    for (std::size_t i = 0; i < 8; ++i)
        g[i] = static_cast<std::int64_t>(std::ldexp(numbers[i], -lowest) - std::ldexp(numbers[8], -lowest));
    return g;
}

// AC - BD >= 0 for g >= 0 at A and C, g < 0 at B and D: at zero its derivative A + C - B - D decides, and
// that is positive.
bool isJoinedExactly(double a, double b, double c, double d, double isovalue) {
    const std::array<double, 5> numbers{a, b, c, d, isovalue};
    if (std::all_of(numbers.begin(), numbers.end(), isPlainFactor)) {
        const std::array<Product, 6> products{
            {{a, c}, {-b, d}, {-isovalue, a}, {-isovalue, c}, {isovalue, b}, {isovalue, d}}};
        return signOfSum(products) >= 0;
    }
    const auto g = differences<BigInteger>(numbers);
    return g[0] * g[2] >= g[1] * g[3];
}

// One ambiguous face in floating point: above corners a and c. Differences from the isovalue.
struct FaceSaddle {
    bool isJoined;
    double value; ///< isovalue of the saddle
    double margin; ///< its error at most; infinite or NaN where nothing is known
};

FaceSaddle saddleOfFace(double a, double b, double c, double d, double isovalue) {
    const double up1 = a - isovalue, up2 = c - isovalue, down1 = isovalue - b, down2 = isovalue - d;
    const double joining = up1 * up2, parting = down1 * down2;
    const double difference = joining - parting, size = joining + parting;
    const double rate = (up1 + up2) + (down1 + down2);
    const bool isSafe = isPlainSize(size);
    const bool isCertain = isSafe && std::abs(difference) > kFaceCertain * size;
    FaceSaddle saddle;
    saddle.isJoined = isCertain ? difference > 0.0 : isJoinedExactly(a, b, c, d, isovalue);
    saddle.value = isovalue + difference / rate;
    saddle.margin = isSafe         ? kSaddleError * (rate + std::abs(isovalue))
                    : rate < 1e150 ? rate + std::abs(isovalue)
                                   : kInfinity;
    return saddle;
}

// Conditions 1 and 2 of trilinear_cell.h. `isCertain` is false when a sign was unknown and no known one
// ruled the tunnel out.
struct TunnelTest {
    bool isCertain = true;
    TunnelDecision decision{};
};

class SignCollector {
public:
    /// One requirement; false when it certainly fails.
    bool require(int sign, int wanted) {
        isCertain_ = isCertain_ && sign != kUnknown;
        isPossible_ = isPossible_ && (sign == kUnknown || sign == wanted);
        return isPossible_;
    }
    TunnelTest result(const TunnelDecision& decision) const {
        return isPossible_ ? TunnelTest{isCertain_, decision} : TunnelTest{};
    }

private:
    bool isCertain_ = true;
    bool isPossible_ = true;
};

// At zero the derivative towards smaller isovalues, which is `rate`.
template <class Number>
int signFromBelow(const Number& value, const Number& rate) {
    const int sign = signOf(value);
    return sign == 0 ? signOf(rate) : sign;
}

// Of the three quadratics; they do not depend on the isovalue.
template <class Number>
std::array<int, 3> leadingSigns(const CellPolynomials<Number>& cell) {
    return {signOf(cell.leading(0)), signOf(cell.leading(1)), signOf(cell.leading(2))};
}

bool isKnown(const std::array<int, 3>& leading) {
    return std::find(leading.begin(), leading.end(), kUnknown) == leading.end();
}

// Condition 2 in other words. The box of the six roots has two corners off the hexagon; with the interpolant's values
// p and q there, each leading coefficient has the sign of -pq, times those of the two axes' directions along
// the diagonal, so that their product has the sign of -(pq)^3. A critical point lies between where p and q agree.
bool excludesTunnel(const std::array<int, 3>& leading) {
    return isKnown(leading) && leading[0] * leading[1] * leading[2] >= 0;
}

std::uint8_t diagonalOf(const std::array<int, 3>& leading) {
    return static_cast<std::uint8_t>((leading[1] > 0 ? 1 : 0) + (leading[0] > 0 ? 2 : 0));
}

template <class Number>
TunnelTest testTunnel(const CellPolynomials<Number>& cell) {
    const std::array<int, 3> leading = leadingSigns(cell);
    if (!isKnown(leading))
        return {false, {}};
    if (excludesTunnel(leading))
        return {};
    SignCollector signs;
    for (std::size_t i = 0; i < 3; ++i) {
        const int axis = static_cast<int>(i);
        const Number first = cell.face(axis, 0), second = cell.face(axis, 1);
        if (!signs.require(signFromBelow(first, cell.faceRate(axis, 0)), leading[i]) ||
            !signs.require(signFromBelow(second, cell.faceRate(axis, 1)), leading[i]))
            return signs.result({});
        // The parabola's vertex lies between the faces: |q(1) - q(0)| < |a|.
        const Number lead = leading[i] > 0 ? cell.leading(axis) : Number(-cell.leading(axis));
        const Number difference = second - first;
        if (!signs.require(signOf(Number(lead - difference)), 1) ||
            !signs.require(signOf(Number(lead + difference)), 1))
            return signs.result({});
    }
    const auto d = cell.discriminant();
    const Number descent = -d.slope; // towards smaller isovalues
    if (!signs.require(signFromBelow(d.value, descent), 1))
        return signs.result({});
    const int slope = signOf(d.slope);
    signs.require(slope, slope == kUnknown ? 1 : slope);
    return signs.result({slope < 0 ? Tunnel::Above : Tunnel::Below, diagonalOf(leading)});
}

CellPolynomials<Bounded> boundedCell(const CornerScalars& scalars, double isovalue) {
    CellPolynomials<Bounded> cell;
    for (std::size_t i = 0; i < 8; ++i)
        cell.g[i] = Bounded::difference(scalars[i], isovalue);
    return cell;
}

TunnelDecision decideExactly(const CornerScalars& scalars, double isovalue) {
    std::array<double, 9> numbers;
    std::copy(scalars.begin(), scalars.end(), numbers.begin());
    numbers[8] = isovalue;
    const int bits = latticeOf(numbers).bits + 1; // of a difference
    if (bits <= kWideBits)
        return testTunnel(CellPolynomials<WideInteger>{wideDifferences(numbers)}).decision;
    if (bits <= kMediumBits)
        return testTunnel(CellPolynomials<MediumInteger>{differences<MediumInteger>(numbers)}).decision;
    return testTunnel(CellPolynomials<BigInteger>{differences<BigInteger>(numbers)}).decision;
}

// Isovalues of the body saddles, as distances from the present one. Roots of value + slope h + square^2 h^2.
struct BodySaddles {
    int count = 0; ///< -1: not even that is certain
    std::array<Bounded, 2> distances; ///< ascending when there are two
};

BodySaddles bodySaddles(const CellPolynomials<Bounded>::Discriminant& d) {
    const Bounded square = d.square * d.square;
    const Bounded product = d.value * square;
    const Bounded root2 = d.slope * d.slope - (product + product + product + product);
    if (root2.isCertainlyNegative())
        return {};
    if (!root2.isCertainlyPositive())
        return {-1, {}};
    // The root with the larger numerator is taken from the sum, the other from the product: nothing cancels.
    const Bounded root = squareRoot(root2);
    const double sign = d.slope.value < 0.0 ? -1.0 : 1.0;
    const Bounded sum = d.slope + Bounded{sign, 0.0} * root;
    const Bounded numerator = Bounded{-0.5, 0.0} * sum;
    const Bounded near = d.value / numerator;
    if (!(square.value > square.error)) {
        // No xyz term, or one lost in rounding: the far root is beyond everything, or unknown.
        return square.value == 0.0 && d.square.value == 0.0 && d.square.error < 1e-290 ? BodySaddles{1, {near, {}}}
                                                                                       : BodySaddles{-1, {}};
    }
    const Bounded far = numerator / square;
    return near.value < far.value ? BodySaddles{2, {near, far}} : BodySaddles{2, {far, near}};
}

// A tunnel in a cell whose faces leave room for one, and the body saddles that may change it.
TunnelDecision resolveInside(const CornerScalars& scalars, unsigned allowed, double isovalue, StateInterval& interval) {
    const PlainLeading leading = plainLeading(scalars);
    if (leading.product == 1 || leading.product == 0) // at every isovalue: most cells are settled here for good
        return {};
    if (leading.product == -1 &&
        (hasRootOutside(scalars, leading, isovalue, interval) || hasNoHexagon(scalars, leading, isovalue, interval)))
        return {};
    const CellPolynomials<Bounded> cell = boundedCell(scalars, isovalue);
    if (leading.product == kUnknown && excludesTunnel(leadingSigns(cell)))
        return {};
    const BodySaddles saddles = bodySaddles(cell.discriminant());
    if (saddles.count < 0)
        interval = {kInfinity, -kInfinity};
    for (int i = 0; i < saddles.count; ++i)
        narrowTo(interval, isovalue, isovalue + saddles.distances[static_cast<std::size_t>(i)].value,
                 saddles.distances[static_cast<std::size_t>(i)].error + 4e-16 * std::abs(isovalue));
    const TunnelTest test = testTunnel(cell);
    const TunnelDecision decision = test.isCertain ? test.decision : decideExactly(scalars, isovalue);
    const unsigned bit = decision.tunnel == Tunnel::Above ? 1u : decision.tunnel == Tunnel::Below ? 2u : 0u;
    return (allowed & bit) != 0 ? decision : TunnelDecision{};
}

} // namespace

TunnelDecision decideTunnel(const CornerScalars& scalars, double isovalue) {
    const TunnelTest test = testTunnel(boundedCell(scalars, isovalue));
    return test.isCertain ? test.decision : decideExactly(scalars, isovalue);
}

ResolvedCell resolveCell(std::uint8_t signs, const CornerScalars& scalars, double isovalue) {
    StateInterval interval{-kInfinity, kInfinity};
    unsigned joined = 0;
    for (unsigned faces = ambiguousFaces(signs); faces != 0; faces &= faces - 1) {
        const int f = std::countr_zero(faces);
        const auto& c = kFaceCorners[static_cast<std::size_t>(f)];
        const int k = signs >> c[0] & 1 ? 0 : 1; // the above corners are k and k + 2
        const FaceSaddle saddle =
            saddleOfFace(scalars[c[k]], scalars[c[k + 1]], scalars[c[k + 2]], scalars[c[(k + 3) & 3]], isovalue);
        joined |= static_cast<unsigned>(saddle.isJoined) << f;
        narrowTo(interval, isovalue, saddle.value, saddle.margin);
    }
    const auto joinedFaces = static_cast<std::uint8_t>(joined);
    TunnelDecision inside;
    if (const unsigned allowed = mayHaveTunnel(signs, joinedFaces); allowed != 0)
        inside = resolveInside(scalars, allowed, isovalue, interval);
    return {stateOf(signs, joinedFaces, inside.tunnel, inside.diagonal), interval};
}

ResolvedTunnel resolveTunnel(const CornerScalars& scalars, unsigned allowed, double isovalue) {
    ResolvedTunnel resolved{{}, {-kInfinity, kInfinity}};
    resolved.decision = resolveInside(scalars, allowed, isovalue, resolved.interval);
    return resolved;
}

namespace {

// The saddle (ac - bd) / (a + c - b - d), and whether its numerator and denominator are free of rounding.
struct SaddleQuotient {
    double numerator, denominator;
    bool isExact;
};

SaddleQuotient saddleQuotient(double a, double b, double c, double d) {
    const double joining = a * c, parting = b * d, numerator = joining - parting;
    const double first = a - b, second = c - d, denominator = first + second;
    return {numerator, denominator, isSmallInteger(a) && isSmallInteger(b) && isSmallInteger(c) && isSmallInteger(d)};
}

} // namespace

double lastJoined(double a, double b, double c, double d) {
    if (const SaddleQuotient saddle = saddleQuotient(a, b, c, d); saddle.isExact) {
        // The greatest double up to a quotient of whole numbers: what is left over of a rounded quotient is exact.
        const double rounded = saddle.numerator / saddle.denominator;
        const bool isBeyond = std::fma(-rounded, saddle.denominator, saddle.numerator) < 0.0;
        return isBeyond ? sampleOfKey<double>(keyOf(rounded) - 1) : rounded + 0.0; // no -0
    }
    // Of doubles in their order: at `joined` the corners are joined, at `parted` not. Near the saddle as computed,
    // mostly.
    std::uint64_t joined = keyOf(std::max(b, d)), parted = keyOf(std::min(a, c));
    const double middle = 0.5 * std::max(b, d) + 0.5 * std::min(a, c);
    const double saddle = saddleOfFace(a, b, c, d, middle).value;
    const auto isJoinedAt = [&](std::uint64_t key) {
        return saddleOfFace(a, b, c, d, sampleOfKey<double>(key)).isJoined;
    };
    if (saddle > sampleOfKey<double>(joined) && saddle < sampleOfKey<double>(parted)) {
        const std::uint64_t start = keyOf(saddle);
        const bool goesUp = isJoinedAt(start);
        (goesUp ? joined : parted) = start;
        for (std::uint64_t step = 1; parted - joined > step; step *= 2) { // ever longer steps
            const std::uint64_t probe = goesUp ? joined + step : parted - step;
            const bool isJoined = isJoinedAt(probe);
            (isJoined ? joined : parted) = probe;
            if (isJoined != goesUp)
                break;
        }
    }
    while (parted - joined > 1) {
        const std::uint64_t probe = joined + (parted - joined) / 2;
        (isJoinedAt(probe) ? joined : parted) = probe;
    }
    return sampleOfKey<double>(joined);
}

TunnelWaist tunnelWaist(const CornerScalars& scalars, double isovalue, double least) {
    CellPolynomials<double> cell;
    // Halved, so that the largest doubles do not overflow here; roots do not change.
    double largest = 0.0;
    for (std::size_t i = 0; i < 8; ++i) {
        cell.g[i] = 0.5 * scalars[i] - 0.5 * isovalue;
        largest = std::max(largest, std::abs(cell.g[i]));
    }
    for (double& g : cell.g)
        g /= largest;
    std::array<std::array<double, 2>, 3> roots;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = cell.leading(axis), b = cell.middle(axis), c = cell.face(axis, 0);
        const double root = std::sqrt(std::max(0.0, b * b - 4.0 * a * c));
        const double numerator = -0.5 * (b + (b < 0.0 ? -root : root));
        double low = numerator / a, high = numerator != 0.0 ? c / numerator : low;
        if (high < low)
            std::swap(low, high);
        if (!(low >= 0.0 && high <= 1.0)) // rounding in a cell with next to no tunnel
            low = high = std::clamp(std::isfinite(low + high) ? 0.5 * (low + high) : 0.5, 0.0, 1.0);
        if (high - low < least) {
            const double middle = std::clamp(0.5 * (low + high), 1.5 * least, 1.0 - 1.5 * least);
            low = middle - 0.5 * least;
            high = middle + 0.5 * least;
        }
        low = std::clamp(low, least, 1.0 - 2.0 * least);
        high = std::clamp(high, low + least, 1.0 - least);
        roots[static_cast<std::size_t>(axis)] = {low, high};
    }
    return {roots[0], roots[1], roots[2]};
}

std::array<double, 3> gradientInCell(const CornerScalars& v, double x, double y, double z) {
    const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
    return {mix(mix(v[1] - v[0], v[3] - v[2], y), mix(v[5] - v[4], v[7] - v[6], y), z),
            mix(mix(v[2] - v[0], v[3] - v[1], x), mix(v[6] - v[4], v[7] - v[5], x), z),
            mix(mix(v[4] - v[0], v[5] - v[1], x), mix(v[6] - v[2], v[7] - v[3], x), y)};
}

} // namespace isoslider::cell
