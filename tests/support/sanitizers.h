#pragma once

#include "core/base/sanitizers.h"

namespace isoslider::test {

/// Whether this is a build with sanitizers, in which all takes three to five times as long: tests of times have less to
/// do.
inline constexpr bool kHasSanitizers = ISO_HAS_SANITIZER != 0;

} // namespace isoslider::test
