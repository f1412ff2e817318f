#pragma once

#include <vector>

#include "core/base/job_control.h"
#include "ui/model/opening/raw_smoothness.h"

namespace isoslider::model {

/// A way to read a headerless file, and how well it goes with its bytes.
struct RawGuess {
    io::RawLayout layout;
    double smoothness = 0.0; ///< of neighbours along x, y and z: 0 noise, 1 constant
    bool isNamed = false; ///< the file's name gives these dims
    double cost = 0.0; ///< what the order is by, least first
};

/// Most guesses that are given.
inline constexpr std::size_t kMostRawGuesses = 12;

/// Ways to read the file that take all of its bytes, the best first: dims, type, byte order and the bytes to
/// skip, by name, by size and by how smooth the samples come out. May be empty. Worker thread.
/// Errors: Cancelled; NotFound, InvalidArgument (no regular file), IoError.
Result<std::vector<RawGuess>> rankRawLayouts(const std::filesystem::path& path, const JobControl& job = {});

/// What becomes of a layout's samples when their bytes are taken in the other order.
struct ByteOrderCheck {
    double roughness = 1.0; ///< along x and y, 0 smooth to 1 noise, as the layout has it
    double swappedRoughness = 1.0;

    /// The other order is far smoother, so that this one is most likely wrong.
    bool looksSwapped() const { return swappedRoughness < 0.5 * roughness && roughness > 0.1; }
};

/// Samples of one byte are never swapped. Worker thread. Errors: as above.
Result<ByteOrderCheck> checkByteOrder(const std::filesystem::path& path, const io::RawLayout& layout);

} // namespace isoslider::model
