#pragma once

namespace isoslider::test {

/// Whether this is a build with sanitizers, in which all takes three to five times as long: tests of times have less to
/// do.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kHasSanitizers = true;
#else
inline constexpr bool kHasSanitizers = false;
#endif

} // namespace isoslider::test
