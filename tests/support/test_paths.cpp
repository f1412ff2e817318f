// The only file of the tests that depends on where they are built: others, compiled in one clone, serve in the next.
#include "tests/support/test_paths.h"

namespace isoslider::test {

const char* sourceFolder() { return ISOSLIDER_SOURCE_DIR; }
const char* sharedFolder() { return ISOSLIDER_SHARED_DIR; }
std::string builtFile(const std::string& name) { return std::string(ISOSLIDER_BUILT_FILES) + "/" + name; }

} // namespace isoslider::test
