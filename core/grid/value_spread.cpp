#include "core/grid/value_spread.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <type_traits>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/grid/classification.h"
#include "core/grid/scalar_type.h"

namespace isoslider {
namespace {

constexpr std::size_t kSpreadBlock = 4096; // summed as plain numbers, from their mean
constexpr std::size_t kSpreadGrain = std::size_t{1} << 18;
constexpr int kSpreadFigures = 11; // of the deviation

/// As a decimal, which is printed with few digits.
double withDecimals(double value, int firstFigure) {
    if (value == 0.0 || !std::isfinite(value))
        return value;
    const int ownFigure = static_cast<int>(std::floor(std::log10(std::abs(value))));
    const int figures = kSpreadFigures + ownFigure - firstFigure;
    if (figures < 0)
        return 0.0;
    std::array<char, 64> text{};
    const auto printed = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific,
                                       std::min(figures, 17));
    double rounded = value;
    std::from_chars(text.data(), printed.ptr, rounded);
    return rounded;
}

} // namespace

template <class Sample>
void SpreadSum::add(std::span<const Sample> samples) {
    using Number = std::conditional_t<std::is_same_v<Sample, double>, long double, double>;
    for (std::size_t begin = 0; begin < samples.size(); begin += kSpreadBlock) {
        const auto block = samples.subspan(begin, std::min(kSpreadBlock, samples.size() - begin));
        std::uint64_t count = 0;
        Number sum = 0;
        for (const Sample sample : block) {
            const bool isThere = !isMissing(sample);
            count += isThere ? 1u : 0u;
            sum += isThere ? static_cast<Number>(sample) : Number(0);
        }
        if (count == 0)
            continue;
        for (const Sample sample : block)
            if (!doesAnyDiffer_ && !isMissing(sample))
                note(static_cast<double>(sample));
        const Number mean = sum / static_cast<Number>(count);
        Number squares = 0;
        for (const Sample sample : block) {
            const Number difference = isMissing(sample) ? Number(0) : static_cast<Number>(sample) - mean;
            squares += difference * difference;
        }
        mergePart(count, mean, squares);
    }
}

void SpreadSum::add(double value, std::uint64_t count) {
    if (count == 0)
        return;
    note(value);
    mergePart(count, value, 0.0L);
}

void SpreadSum::merge(const SpreadSum& other) {
    if (other.count_ == 0)
        return;
    note(other.first_);
    doesAnyDiffer_ = doesAnyDiffer_ || other.doesAnyDiffer_;
    mergePart(other.count_, other.mean_, other.squares_);
}

void SpreadSum::note(double value) {
    if (!hasFirst_)
        first_ = value;
    hasFirst_ = true;
    doesAnyDiffer_ = doesAnyDiffer_ || value != first_;
}

// Chan, Golub and LeVeque 1979: parts of any size, without the cancellation of plain sums of squares.
void SpreadSum::mergePart(std::uint64_t count, long double mean, long double squares) {
    const auto before = static_cast<long double>(count_), added = static_cast<long double>(count);
    const long double difference = mean - mean_;
    const long double share = added / (before + added);
    mean_ += difference * share;
    squares_ += squares + difference * difference * before * share;
    count_ += count;
}

ValueSpread SpreadSum::spread() const {
    ValueSpread found;
    if (count_ == 0)
        return found;
    const auto deviation = static_cast<double>(std::sqrt(squares_ / static_cast<long double>(count_)));
    found.mean = static_cast<double>(mean_);
    if (!doesAnyDiffer_)
        found.mean = first_;
    if (!doesAnyDiffer_ || !(deviation > 0.0))
        return found;
    const int firstFigure = static_cast<int>(std::floor(std::log10(deviation)));
    found.mean = withDecimals(found.mean, firstFigure);
    found.deviation = withDecimals(deviation, firstFigure);
    return found;
}

Result<ValueSpread> spreadOf(const ScalarGrid& grid, const JobControl& job) {
    tbb::enumerable_thread_specific<SpreadSum> sums;
    grid.visit([&](auto values) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, values.size(), kSpreadGrain), [&](const auto& part) {
            if (!job.isStopRequested())
                sums.local().add(values.subspan(part.begin(), part.size()));
        });
    });
    if (job.isStopRequested())
        return cancelledError();
    return SpreadSum::spreadOfAll(sums);
}

Result<double> AskedIsovalue::in(const ValueSpread& spread) const {
    if (!isInDeviations)
        return number;
    if (!(spread.deviation > 0.0))
        return makeError(ErrorCode::InvalidArgument,
                         "no two samples differ: an isovalue cannot be given in standard deviations");
    return spread.mean + number * spread.deviation;
}

bool removeDeviationWord(std::string_view& text) {
    constexpr std::string_view kBlanks = " \t\r\n";
    const auto end = text.find_last_not_of(kBlanks);
    const std::string_view trimmed = text.substr(0, end == std::string_view::npos ? 0 : end + 1);
    constexpr std::array<std::string_view, 5> kWords{"sigma", "\xCF\x83", "\xCE\xA3", "sd", "std"}; // σ and Σ
    const auto isSame = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? static_cast<char>(a + 32) : a) == b; };
    for (const std::string_view word : kWords) {
        if (trimmed.size() < word.size())
            continue;
        const std::string_view found = trimmed.substr(trimmed.size() - word.size());
        if (!std::equal(found.begin(), found.end(), word.begin(), isSame))
            continue;
        text = trimmed.substr(0, trimmed.size() - word.size());
        const auto last = text.find_last_not_of(kBlanks);
        text = text.substr(0, last == std::string_view::npos ? 0 : last + 1);
        return true;
    }
    return false;
}

#define ISO_INSTANTIATE(Sample, Name) template void SpreadSum::add(std::span<const Sample>);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider
