#pragma once

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace isoslider::test {

/// A gyroid within a ball in n^3 16-bit samples as a header and a raw file, like a CT of 12 bits; air around it is 0.
/// `angle`: its phase from one side of the volume to the other, radians; the surface grows with it.
std::filesystem::path writeGyroid(const TemporaryFolder& folder, int n, float angle = 7.0f);

} // namespace isoslider::test
