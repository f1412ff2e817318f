#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>

#include "core/base/result.h"

// Bytes from standard input and to standard output. A stop request ends the waiting for either within a moment, however
// long the program at the other end takes.

namespace isoslider::cli {

bool isInputTerminal();
bool isOutputTerminal();

/// What is left of standard input where that is a file; none of a pipe.
std::optional<std::uint64_t> inputBytesLeft();

/// Fills `out`; fewer bytes only where the input ends. Errors: IoError, Cancelled.
Result<std::size_t> readInput(std::span<std::byte> out, const std::stop_token& stop);

/// Errors: IoError (also when nobody reads any more), OutOfSpace, Cancelled; some of the bytes may have been written.
Status writeOutput(std::span<const std::byte> bytes, const std::stop_token& stop);

} // namespace isoslider::cli
