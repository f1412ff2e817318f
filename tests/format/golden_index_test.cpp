// Index files of each released format version, kept for ever.

#include <gtest/gtest.h>

#include "core/index/index_reader.h"
#include "tests/support/result_matchers.h"

namespace isoslider::index {
namespace {

using test::HasError;

const std::filesystem::path kData = std::filesystem::path(ISOSLIDER_SOURCE_DIR) / "tests/data";

// It lacks samples that its surfaces need.
TEST(GoldenIndex, VersionOneIsRefusedByName) {
    const auto opened = IndexReader::open(kData / "golden_v1.isx");
    ASSERT_THAT(opened, HasError(ErrorCode::UnsupportedVersion));
    const std::string line = opened.error().line();
    EXPECT_NE(line.find("golden_v1.isx"), std::string::npos) << line;
    EXPECT_NE(line.find("format version 1, this program reads version 2: build it anew from its volume"), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
}

} // namespace
} // namespace isoslider::index
