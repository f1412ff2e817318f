#include "app/cli/progress_bar.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <fmt/format.h>

namespace isoslider::cli {
namespace {

constexpr int kBarWidth = 32;
constexpr std::chrono::milliseconds kBetweenDraws{100};

} // namespace

std::string durationText(double seconds) {
    if (seconds < 95.0)
        return fmt::format("{:.0f} s", std::max(5.0, 5.0 * std::ceil(seconds / 5.0)));
    const double minutes = std::ceil(seconds / 60.0);
    if (minutes < 60.0)
        return fmt::format("{:.0f} min", minutes);
    const double tens = std::ceil(minutes / 10.0);
    return fmt::format("{:.0f} h {:.0f} min", std::floor(tens / 6.0), 10.0 * std::fmod(tens, 6.0));
}

// As long as before, for what is left: stages are weighed by how long they take.
std::string ProgressBar::timeLeft(double fraction, std::chrono::steady_clock::time_point now) const {
    constexpr double kLeastSeconds = 5.0, kLeastFraction = 0.02;
    const double spent = std::chrono::duration<double>(now - begin_).count();
    if (spent < kLeastSeconds || fraction < kLeastFraction)
        return {};
    return ", about " + durationText(spent / fraction * (1.0 - fraction)) + " left";
}

JobControl ProgressBar::job() {
    JobControl job;
    job.stop = stop_;
    if (isShown_)
        job.progress = [this](double fraction, std::string_view stage) { draw(fraction, stage); };
    return job;
}

void ProgressBar::draw(double fraction, std::string_view stage) {
    const auto now = std::chrono::steady_clock::now();
    if (now < nextDraw_)
        return;
    nextDraw_ = now + kBetweenDraws;
    const double part = std::clamp(fraction, 0.0, 1.0);
    const auto filled = static_cast<std::size_t>(part * kBarWidth);
    const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
    fmt::print(stderr, "\r\x1b[K[{}] {:3.0f} %  {}{}", bar, 100.0 * part, stage, timeLeft(part, now));
    std::fflush(stderr);
    hasDrawn_ = true;
}

void ProgressBar::wipe() {
    if (!hasDrawn_)
        return;
    fmt::print(stderr, "\r\x1b[K");
    std::fflush(stderr);
    hasDrawn_ = false;
}

} // namespace isoslider::cli
