#pragma once

#include <string>

namespace isoslider::test {

/// The folder of the sources.
const char* sourceFolder();
/// The folder of further data, which may be absent (CMake option ISOSLIDER_SHARED_DIR).
const char* sharedFolder();
/// A program or library of this build, by its file's name.
std::string builtFile(const std::string& name);

} // namespace isoslider::test
