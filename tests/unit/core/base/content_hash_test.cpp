#include "core/base/content_hash.h"

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider {
namespace {

std::uint64_t hashOf(std::string_view text) {
    ContentHash hash;
    hash.add(std::as_bytes(std::span(text)));
    return hash.value();
}

TEST(ContentHash, IsXxh3) {
    EXPECT_EQ(hashOf(""), 0x2d06800538d394c2u); // of the algorithm's own description
}

TEST(ContentHash, OfPiecesIsThatOfTheWhole) {
    ContentHash hash;
    for (const std::string_view piece : {"iso", "", "slider"})
        hash.add(std::as_bytes(std::span(piece)));
    EXPECT_EQ(hash.value(), hashOf("isoslider"));
    EXPECT_NE(hash.value(), hashOf("isoslidER"));
}

TEST(ContentHash, OfAFileIsThatOfItsBytesWhateverItsSize) {
    const test::TemporaryFolder folder;
    for (const std::size_t size :
         {std::size_t{0}, std::size_t{1}, (std::size_t{1} << 20), (std::size_t{1} << 21) + 1}) {
        std::string bytes(size, 'a');
        for (std::size_t i = 0; i < size; i += 37)
            bytes[i] = static_cast<char>(i);
        const auto found = hashFile(folder.write("a", bytes));
        ASSERT_THAT(found, test::IsOk());
        EXPECT_EQ(found.value(), hashOf(bytes)) << size;
    }
}

TEST(ContentHash, OfAFileCanBeCancelledAndFails) {
    const test::TemporaryFolder folder;
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_THAT(hashFile(folder.write("a", "text"), job), test::HasError(ErrorCode::Cancelled));
    EXPECT_THAT(hashFile(folder / "missing"), test::HasError(ErrorCode::NotFound));
    EXPECT_THAT(hashFile(folder.path()), test::HasError(ErrorCode::InvalidArgument));
}

} // namespace
} // namespace isoslider
