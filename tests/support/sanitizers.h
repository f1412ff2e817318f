#pragma once

#include <cstddef>

#include "core/base/sanitizers.h"

namespace isoslider::test {

/// Whether this is a build with sanitizers, in which all takes three to five times as long: tests of times have less to
/// do.
inline constexpr bool kHasSanitizers = ISO_HAS_SANITIZER != 0;

/// Tests that damage one place after another look, with sanitizers, at every so many of these places only.
inline constexpr std::size_t kSparser = kHasSanitizers ? 5 : 1;

} // namespace isoslider::test
