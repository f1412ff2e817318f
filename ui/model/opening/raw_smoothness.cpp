#include "ui/model/opening/raw_smoothness.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace isoslider::model {
namespace {

constexpr std::uint64_t kPlaces = 96;
constexpr std::uint64_t kRun = 96; ///< samples at each place
constexpr double kOutliers = 0.01; ///< share of the samples at either end that the usual range leaves out
constexpr double kLeastMagnitude = 1e-30;
constexpr double kMostMagnitude = 1e30;

template <class T>
T swapped(T value) {
    auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
}

bool isPlausible(double value) {
    if (std::isnan(value)) // a missing value, as like as not
        return true;
    const double magnitude = std::abs(value);
    return magnitude == 0.0 || (magnitude > kLeastMagnitude && magnitude < kMostMagnitude);
}

} // namespace

struct RawSmoothness::MeanDifference {
    Place sum;
    double count = 0.0;

    void add(const Place& a, const Place& b) {
        sum.rank += std::abs(a.rank - b.rank);
        sum.value += std::abs(a.value - b.value);
        ++count;
    }
    Place mean() const { return count > 0.0 ? Place{sum.rank / count, sum.value / count} : Place(); }
};

RawSmoothness::RawSmoothness(const RandomAccessFile& file, const SampleFormat& format) : file_(file), format_(format) {
    const auto size = scalarTypeSizeBytes(format.type);
    samples_ = file.sizeBytes() > format.skipBytes ? (file.sizeBytes() - format.skipBytes) / size : 0;
    if (samples_ < 8)
        return;
    choosePlaces();
    std::vector<std::vector<double>> runs;
    std::vector<double> all;
    for (const auto place : places_) {
        runs.push_back(read(place, std::min(kRun, samples_ - place)));
        all.insert(all.end(), runs.back().begin(), runs.back().end());
    }
    measure(all);
    for (const auto& run : runs) {
        auto& places = runs_.emplace_back();
        for (const double value : run)
            places.push_back(placeOf(value));
    }
    // Any two: each with some of those at places far from it, in reverse.
    MeanDifference difference;
    for (std::size_t i = 0; i < runs_.size(); ++i)
        for (std::size_t quarter = 1; quarter < 4; ++quarter) {
            const auto& other = runs_[(i + quarter * runs_.size() / 4) % runs_.size()];
            for (std::size_t k = 0; k < std::min(runs_[i].size(), other.size()); ++k)
                difference.add(runs_[i][k], other[other.size() - 1 - k]);
        }
    spread_ = difference.mean();
}

// Even steps would fall in with rows or planes: each place is moved by a share of the step that a fixed
// sequence of low discrepancy gives.
void RawSmoothness::choosePlaces() {
    constexpr double kGoldenShare = 0.6180339887498949;
    const double step = static_cast<double>(samples_) / static_cast<double>(kPlaces);
    for (std::uint64_t i = 0; i < kPlaces; ++i) {
        const double shift = std::fmod(static_cast<double>(i) * kGoldenShare, 1.0);
        const auto place = static_cast<std::uint64_t>((static_cast<double>(i) + shift) * step);
        places_.push_back(std::min(place, samples_ - 1));
    }
}

void RawSmoothness::measure(const std::vector<double>& values) {
    double least = 0.0, most = 0.0, absurd = 0.0;
    for (const double value : values) {
        absurd += isPlausible(value) ? 0.0 : 1.0;
        if (!std::isfinite(value))
            continue;
        least = sorted_.empty() ? value : std::min(least, value);
        most = sorted_.empty() ? value : std::max(most, value);
        sorted_.push_back(value);
    }
    std::sort(sorted_.begin(), sorted_.end());
    range_ = most - least;
    if (!sorted_.empty()) {
        low_ = sorted_[static_cast<std::size_t>(kOutliers * static_cast<double>(sorted_.size()))];
        high_ = sorted_[sorted_.size() - 1 - static_cast<std::size_t>(kOutliers * static_cast<double>(sorted_.size()))];
    }
    if (low_ == high_) { // all but a few are one value
        low_ = least;
        high_ = most;
    }
    implausibleShare_ = values.empty() ? 1.0 : absurd / static_cast<double>(values.size());
}

RawSmoothness::Place RawSmoothness::placeOf(double value) const {
    if (sorted_.empty() || std::isnan(value))
        return {0.5, 0.5};
    const auto [low, high] = std::equal_range(sorted_.begin(), sorted_.end(), value);
    const auto twice = (low - sorted_.begin()) + (high - sorted_.begin());
    // Halved, so that the width of a range of doubles does not overflow.
    const double width = high_ / 2.0 - low_ / 2.0;
    return {0.5 * static_cast<double>(twice) / static_cast<double>(sorted_.size()),
            width > 0.0 ? (std::clamp(value, low_, high_) / 2.0 - low_ / 2.0) / width : 0.5};
}

std::vector<double> RawSmoothness::read(std::uint64_t first, std::uint64_t count) const {
    const auto size = scalarTypeSizeBytes(format_.type);
    std::vector<std::byte> bytes(count * size);
    std::vector<double> values;
    if (!file_.readExactlyAt(format_.skipBytes + first * size, bytes).isOk())
        return values;
    const bool swaps = format_.isBigEndian == (std::endian::native == std::endian::little);
    visitScalarType(format_.type, [&](auto sample) {
        for (std::uint64_t i = 0; i < count; ++i) {
            std::memcpy(&sample, bytes.data() + i * size, size);
            values.push_back(static_cast<double>(swaps ? swapped(sample) : sample));
        }
    });
    return values;
}

double RawSmoothness::roughness(std::uint64_t lag) {
    if (!isUsable())
        return 1.0;
    if (const auto found = known_.find(lag); found != known_.end())
        return found->second;
    MeanDifference difference;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        const auto& run = runs_[i];
        const bool isWithin = lag < run.size() / 2;
        for (std::size_t k = 0; isWithin && k + lag < run.size(); ++k)
            difference.add(run[k], run[k + lag]);
        if (isWithin || places_[i] + lag >= samples_)
            continue;
        const auto further = read(places_[i] + lag, std::min<std::uint64_t>(run.size(), samples_ - places_[i] - lag));
        for (std::size_t k = 0; k < further.size(); ++k)
            difference.add(run[k], placeOf(further[k]));
    }
    const Place mean = difference.mean();
    const double rough = difference.count > 0.0
                             ? std::min(2.0, std::sqrt(mean.rank / spread_.rank * (mean.value / spread_.value)))
                             : 1.0;
    known_.emplace(lag, rough);
    return rough;
}

} // namespace isoslider::model
