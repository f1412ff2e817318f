#include "app/cli/progress_bar.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include <fmt/format.h>

namespace isoslider::cli {
namespace {

constexpr int kBarWidth = 32;
constexpr std::chrono::milliseconds kBetweenDraws{100};

} // namespace

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
    fmt::print(stderr, "\r\x1b[K[{}] {:3.0f} %  {}", bar, 100.0 * part, stage);
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
