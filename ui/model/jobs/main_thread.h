#pragma once

#include <functional>

namespace isoslider::model {

/// Runs a function later on the window's thread. May be called from any thread; after the window is
/// gone the function is dropped without being run.
using MainThread = std::function<void(std::function<void()>)>;

} // namespace isoslider::model
