#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

namespace isoslider {

/// Shares a short loop among a team of threads: calls body(begin, end) for pieces of [0, count) of at most `grain`, and
/// returns when all are done. What the first failing piece throws is thrown here; pieces not begun by then are left
/// out.
///
/// For loops of a few milliseconds or less, such as those of a move of the isovalue. The threads wait for the next loop
/// where one call wakes them; those of TBB, which serve everything else, were seen to sleep through one loop in ten of
/// 3 ms.
///
/// Takes as many threads as TBB would here (its limits and arenas count), and the caller's alone while another loop
/// runs, so loops may be nested, and any thread may call. Cost of a loop: some microseconds.
template <class Body>
void forRanges(std::size_t count, std::size_t grain, Body&& body);

/// The same for single elements: body(i).
template <class Body>
void forEachIndex(std::size_t count, std::size_t grain, Body&& body) {
    forRanges(count, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            body(i);
    });
}

namespace detail {
using RangeCall = void (*)(void* body, std::size_t begin, std::size_t end);
void runOnTeam(std::size_t count, std::size_t grain, void* body, RangeCall call);
} // namespace detail

template <class Body>
void forRanges(std::size_t count, std::size_t grain, Body&& body) {
    using Plain = std::remove_reference_t<Body>;
    detail::runOnTeam(
        count, grain, const_cast<void*>(static_cast<const void*>(&body)),
        [](void* called, std::size_t begin, std::size_t end) { (*static_cast<Plain*>(called))(begin, end); });
}

} // namespace isoslider
