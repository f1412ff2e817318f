#include "ui/model/jobs/job_words.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace isoslider::model {
namespace {

constexpr double kLeastElapsedMs = 1500.0, kLeastFraction = 0.02; // the first part of a job is no measure of the rest
constexpr double kMinuteMs = 60'000.0;

} // namespace

std::optional<double> millisecondsLeft(double fraction, double elapsedMs) {
    if (elapsedMs < kLeastElapsedMs || !(fraction >= kLeastFraction))
        return std::nullopt;
    return elapsedMs * (1.0 - std::min(fraction, 1.0)) / fraction;
}

std::string timeLeftText(double fraction, double elapsedMs) {
    const auto left = millisecondsLeft(fraction, elapsedMs);
    if (!left)
        return {};
    if (*left < 90'000.0) {
        const double seconds = std::max(1.0, std::ceil(*left / 1000.0));
        const double step = seconds > 20.0 ? 5.0 : 1.0; // a number that jumps at every look says less
        return "about " + std::to_string(std::lround(step * std::ceil(seconds / step))) + " s left";
    }
    return "about " + std::to_string(std::lround(std::ceil(*left / kMinuteMs))) + " min left";
}

std::string runningText(const JobEntry& job) {
    std::string text = job.stage;
    if (!text.empty())
        text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    text += " · " + std::to_string(std::lround(100.0 * std::clamp(job.fraction, 0.0, 1.0))) + " %";
    if (const std::string left = timeLeftText(job.fraction, job.elapsedMs); !left.empty())
        text += " · " + left;
    return text;
}

} // namespace isoslider::model
