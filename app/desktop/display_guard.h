#pragma once

namespace isoslider::desktop {

/// While it lives: a display that the platform's plugin cannot use ends the program with ExitCode::IoFailure and one
/// line, where Qt would end it by a signal. For the time in which the application object is made.
class DisplayGuard {
public:
    DisplayGuard();
    ~DisplayGuard();
    DisplayGuard(const DisplayGuard&) = delete;
    DisplayGuard& operator=(const DisplayGuard&) = delete;
};

} // namespace isoslider::desktop
