#pragma once

#include <functional>

#include <QElapsedTimer>
#include <QTimer>

namespace isoslider::widgets {

/// Calls a function at most once per interval, and at least once after the last trigger.
class Throttle {
public:
    Throttle(int intervalMs, std::function<void()> function) : intervalMs_(intervalMs), function_(std::move(function)) {
        timer_.setSingleShot(true);
        QObject::connect(&timer_, &QTimer::timeout, &timer_, [this] { fire(); });
    }

    void trigger() {
        if (timer_.isActive())
            return;
        const qint64 sinceLast = last_.isValid() ? last_.elapsed() : intervalMs_;
        if (sinceLast >= intervalMs_)
            fire();
        else
            timer_.start(static_cast<int>(intervalMs_ - sinceLast));
    }

private:
    void fire() {
        last_.start();
        function_();
    }

    int intervalMs_;
    std::function<void()> function_;
    QTimer timer_;
    QElapsedTimer last_;
};

} // namespace isoslider::widgets
