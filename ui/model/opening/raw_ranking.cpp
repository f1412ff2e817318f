#include "ui/model/opening/raw_ranking.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <tuple>

#include "ui/model/opening/raw_guess.h"

namespace isoslider::model {
namespace {

/// Costs are natural logarithms of roughness, so that half as rough is worth 0.7, wherever it is. What speaks
/// for or against a reading besides is worth so much of that:
constexpr double kAgainstNamedType = 1.5;
constexpr double kAgainstNamedDims = 3.0;
constexpr double kAgainstNamedOrder = 1.0;
constexpr double kBigEndian = 0.05;
constexpr double kSkippedBytes = 0.5;
constexpr double kPerBitOfRange = 0.04; ///< integers that span less are the likelier ones
constexpr double kFloat = 0.45;
constexpr double kImplausible = 6.0; ///< times the share of implausible samples
constexpr double kPerDoublingOfSides = 0.15; ///< the longest side against the shortest, beyond four times
constexpr double kUnequalSides = 0.08; ///< rows and columns of a plane

constexpr double kLeastRoughness = 0.004; ///< below, all is equally smooth
constexpr std::size_t kMostFormats = 5; ///< whose dims are looked for
constexpr std::size_t kMostRowLengths = 40;
constexpr std::int64_t kLeastSide = 4;
constexpr std::int64_t kMostSide = 16384;
constexpr std::uint64_t kMostHeaderBytes = 16384; ///< of files without dims in their name
constexpr double kMostNamedSkip = 1e9; ///< bytes
constexpr double kMostSideRatio = 256.0;

double logOf(double roughness) { return std::log(std::max(roughness, kLeastRoughness)); }

double formatCost(RawSmoothness& samples, const NamedLayout& named) {
    const auto& format = samples.format();
    double cost = logOf(samples.roughness(1)) + kImplausible * samples.implausibleShare();
    cost += isFloatType(format.type) ? kFloat : kPerBitOfRange * std::log2(samples.range() + 1.0);
    if (named.type && *named.type != format.type)
        cost += kAgainstNamedType;
    const bool hasOrder = scalarTypeSizeBytes(format.type) > 1;
    if (hasOrder && named.isBigEndian && *named.isBigEndian != format.isBigEndian)
        cost += kAgainstNamedOrder;
    return cost + (format.isBigEndian ? kBigEndian : 0.0) + (format.skipBytes > 0 ? kSkippedBytes : 0.0);
}

double shapeCost(const GridDims& dims) {
    const auto [least, most] = std::minmax_element(dims.begin(), dims.end());
    const double ratio = static_cast<double>(*most) / static_cast<double>(*least);
    return kPerDoublingOfSides * std::max(0.0, std::log2(ratio) - 2.0) + (dims[0] != dims[1] ? kUnequalSides : 0.0);
}

bool hasUsualSides(const GridDims& dims) {
    const auto [least, most] = std::minmax_element(dims.begin(), dims.end());
    return *least >= kLeastSide && *most <= kMostSide &&
           static_cast<double>(*most) <= kMostSideRatio * static_cast<double>(*least);
}

/// Divisors of `count` that a side may have, ascending.
std::vector<std::int64_t> sidesOf(std::uint64_t count) {
    std::vector<std::int64_t> sides;
    for (std::int64_t side = kLeastSide; side <= kMostSide; ++side)
        if (count % static_cast<std::uint64_t>(side) == 0)
            sides.push_back(side);
    return sides;
}

/// The likeliest row lengths of all `sides`: those at which samples are most alike.
std::vector<std::int64_t> rowLengths(RawSmoothness& samples, std::vector<std::int64_t> sides) {
    const auto isSmoother = [&](std::int64_t a, std::int64_t b) {
        const double first = samples.roughness(static_cast<std::uint64_t>(a));
        const double second = samples.roughness(static_cast<std::uint64_t>(b));
        return std::tie(first, a) < std::tie(second, b);
    };
    std::sort(sides.begin(), sides.end(), isSmoother);
    sides.resize(std::min(sides.size(), kMostRowLengths));
    return sides;
}

RawGuess judged(RawSmoothness& samples, const GridDims& dims, double formatCost, const NamedLayout& named) {
    const auto row = static_cast<std::uint64_t>(dims[0]);
    const auto plane = static_cast<std::uint64_t>(dims[0] * dims[1]);
    const double x = samples.roughness(1), y = samples.roughness(row), z = samples.roughness(plane);
    RawGuess guess;
    guess.layout.dims = dims;
    guess.layout.type = samples.format().type;
    guess.layout.isBigEndian = samples.format().isBigEndian;
    guess.layout.skipBytes = samples.format().skipBytes;
    guess.smoothness = std::clamp(1.0 - (x + y + z) / 3.0, 0.0, 1.0);
    guess.isNamed = named.dims == dims;
    guess.cost = formatCost + logOf(y) + logOf(z) + shapeCost(dims) +
                 (named.dims[0] > 0 && !guess.isNamed ? kAgainstNamedDims : 0.0);
    return guess;
}

void addShapes(RawSmoothness& samples, double cost, const NamedLayout& named, const JobControl& job,
               std::vector<RawGuess>& guesses) {
    const auto count = samples.samples();
    const auto sides = sidesOf(count);
    for (const std::int64_t row : rowLengths(samples, sides)) {
        if (job.isStopRequested())
            return;
        for (const std::int64_t column : sides) {
            const auto plane = static_cast<std::uint64_t>(row * column);
            if (count % plane != 0 || count / plane > static_cast<std::uint64_t>(kMostSide))
                continue;
            const GridDims dims{row, column, static_cast<std::int64_t>(count / plane)};
            if (hasUsualSides(dims))
                guesses.push_back(judged(samples, dims, cost, named));
        }
    }
}

bool fitsExactly(const GridDims& dims, const SampleFormat& format, std::uint64_t fileBytes) {
    io::RawLayout layout;
    layout.dims = dims;
    layout.type = format.type;
    layout.skipBytes = format.skipBytes;
    return dims[0] > 0 && std::all_of(dims.begin(), dims.end(), [](auto n) { return n >= 2 && n <= kMaxDim; }) &&
           static_cast<double>(dims[0]) * static_cast<double>(dims[1]) * static_cast<double>(dims[2]) <=
               static_cast<double>(kMaxPoints) &&
           layoutBytes(layout) == fileBytes;
}

/// Bytes that may lie before the samples: none, what the named dims leave, or what the largest cube or pile
/// of square slices leaves, if that is as little as a header.
std::set<std::uint64_t> skipsFor(ScalarType type, std::uint64_t fileBytes, const NamedLayout& named) {
    std::set<std::uint64_t> skips{0};
    const auto size = scalarTypeSizeBytes(type);
    const double namedPoints =
        static_cast<double>(named.dims[0]) * static_cast<double>(named.dims[1]) * static_cast<double>(named.dims[2]);
    const double left = static_cast<double>(fileBytes) - namedPoints * static_cast<double>(size);
    if (namedPoints > 0.0 && left > 0.0 && left <= kMostNamedSkip)
        skips.insert(fileBytes - static_cast<std::uint64_t>(pointCount(named.dims)) * size);
    const auto points = fileBytes / size;
    const auto offer = [&](std::uint64_t used) {
        if (used > 0 && used * size < fileBytes && fileBytes - used * size <= kMostHeaderBytes)
            skips.insert(fileBytes - used * size);
    };
    const auto side = static_cast<std::uint64_t>(std::cbrt(static_cast<double>(points)));
    offer(side * side * side);
    for (const std::uint64_t slice : {64u, 128u, 256u, 512u, 1024u})
        if (points >= 8 * slice * slice)
            offer(points / (slice * slice) * (slice * slice));
    return skips;
}

struct Candidate {
    std::unique_ptr<RawSmoothness> samples;
    double cost = 0.0;
    bool isJumping = false;
};

/// The same bytes with and without a sign: where the ranges differ, values cross zero in one reading and jump
/// from one end of the range to the other in the other, which spans far more.
bool isJumpingTwin(const Candidate& candidate, const std::vector<Candidate>& all) {
    constexpr double kFarMore = 1.5;
    const auto& format = candidate.samples->format();
    return std::any_of(all.begin(), all.end(), [&](const Candidate& other) {
        SampleFormat twin = other.samples->format();
        const bool isTwin = twin.type != format.type && !isFloatType(twin.type) && !isFloatType(format.type) &&
                            scalarTypeSizeBytes(twin.type) == scalarTypeSizeBytes(format.type);
        twin.type = format.type;
        return isTwin && twin == format && candidate.samples->range() > kFarMore * other.samples->range();
    });
}

std::vector<Candidate> candidatesOf(const RandomAccessFile& file, const NamedLayout& named, const JobControl& job) {
    std::vector<Candidate> candidates;
    for (const ScalarType type : kAllScalarTypes)
        for (const std::uint64_t skip : skipsFor(type, file.sizeBytes(), named))
            for (const bool isBigEndian : {false, true}) {
                const auto size = scalarTypeSizeBytes(type);
                if ((isBigEndian && size == 1) || (file.sizeBytes() - skip) % size != 0 || job.isStopRequested())
                    continue;
                Candidate candidate;
                candidate.samples = std::make_unique<RawSmoothness>(file, SampleFormat{type, isBigEndian, skip});
                candidate.cost = formatCost(*candidate.samples, named);
                candidates.push_back(std::move(candidate));
            }
    for (auto& candidate : candidates)
        candidate.isJumping = named.type != candidate.samples->format().type && isJumpingTwin(candidate, candidates);
    std::erase_if(candidates, [](const Candidate& candidate) { return candidate.isJumping; });
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.cost < b.cost; });
    return candidates;
}

/// With and without a sign, and no sample looked at that it would matter for.
bool areTwins(const RawGuess& a, const RawGuess& b) {
    io::RawLayout other = a.layout;
    other.type = b.layout.type;
    return other == b.layout && scalarTypeSizeBytes(a.layout.type) == scalarTypeSizeBytes(b.layout.type) &&
           isFloatType(a.layout.type) == isFloatType(b.layout.type) && std::abs(a.cost - b.cost) < 1e-9;
}

/// Other types and byte orders look as smooth now and then: a few readings of each dims, and no twins.
void keepBest(std::vector<RawGuess>& guesses) {
    constexpr std::ptrdiff_t kMostAlike = 2;
    std::stable_sort(guesses.begin(), guesses.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
    std::vector<RawGuess> best;
    for (const auto& guess : guesses) {
        const auto alike = std::count_if(best.begin(), best.end(),
                                         [&](const auto& other) { return other.layout.dims == guess.layout.dims; });
        const bool isTwin =
            std::any_of(best.begin(), best.end(), [&](const auto& other) { return areTwins(other, guess); });
        if (!isTwin && alike < kMostAlike && best.size() < kMostRawGuesses)
            best.push_back(guess);
    }
    guesses = std::move(best);
}

} // namespace

Result<std::vector<RawGuess>> rankRawLayouts(const std::filesystem::path& path, const JobControl& job) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    const auto named = layoutInName(path.filename().string());
    auto candidates = candidatesOf(*file.value(), named, job);
    std::vector<RawGuess> guesses;
    std::size_t searched = 0;
    for (std::size_t i = 0; i < candidates.size() && !job.isStopRequested(); ++i) {
        auto& samples = candidates[i].samples;
        const double cost = candidates[i].cost;
        if (fitsExactly(named.dims, samples->format(), file.value()->sizeBytes()))
            guesses.push_back(judged(*samples, named.dims, cost, named));
        if (searched++ < kMostFormats)
            addShapes(*samples, cost, named, job, guesses);
        job.report(static_cast<double>(i + 1) / static_cast<double>(candidates.size()), "comparing ways to read it");
    }
    if (job.isStopRequested())
        return cancelledError();
    std::set<std::tuple<GridDims, ScalarType, bool, std::uint64_t>> seen;
    std::erase_if(guesses, [&](const RawGuess& guess) {
        const auto& layout = guess.layout;
        return !seen.emplace(layout.dims, layout.type, layout.isBigEndian, layout.skipBytes).second;
    });
    keepBest(guesses);
    return guesses;
}

Result<ByteOrderCheck> checkByteOrder(const std::filesystem::path& path, const io::RawLayout& layout) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    const auto roughnessOf = [&](bool isBigEndian) {
        RawSmoothness samples(*file.value(), {layout.type, isBigEndian, layout.skipBytes});
        return (samples.roughness(1) + samples.roughness(static_cast<std::uint64_t>(layout.dims[0]))) / 2.0 +
               samples.implausibleShare();
    };
    ByteOrderCheck check;
    if (scalarTypeSizeBytes(layout.type) == 1)
        return check;
    check.roughness = roughnessOf(layout.isBigEndian);
    check.swappedRoughness = roughnessOf(!layout.isBigEndian);
    return check;
}

} // namespace isoslider::model
