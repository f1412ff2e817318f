#pragma once

#include <cstddef>

namespace isoslider::render {

/// A surface whose drawing can be stopped is drawn in parts of so many indices: software OpenGL takes some 10 ms for
/// one.
constexpr std::size_t kIndicesTogether = 300'000;

} // namespace isoslider::render
