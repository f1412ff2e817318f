#include "app/cli/number_parsing.h"

#include <cstdint>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace isoslider::cli {

using ::testing::ElementsAre;
using ::testing::Eq;
using ::testing::Optional;

TEST(NumberParsing, TakesWholeFiniteNumbers) {
    EXPECT_THAT(parseFinite("0.1"), Optional(0.1));
    EXPECT_THAT(parseFinite("-1e-3"), Optional(-0.001));
    EXPECT_THAT(parseFinite("+7"), Optional(7.0));
    for (const auto* text : {"", "+", "-", "+-1", "1 ", " 1", "1,5", "nan", "inf", "1e999", "1e", "0x1p3"})
        EXPECT_THAT(parseFinite(text), Eq(std::nullopt)) << text;
}

TEST(NumberParsing, TakesWholeIntegers) {
    EXPECT_THAT(parseInteger("-12"), Optional(-12));
    EXPECT_THAT(parseInteger("9223372036854775807"), Optional(std::numeric_limits<std::int64_t>::max()));
    for (const auto* text : {"", "1.0", "9223372036854775808", "1e3", "0x10"})
        EXPECT_THAT(parseInteger(text), Eq(std::nullopt)) << text;
}

TEST(NumberParsing, TakesSizesWithBinarySuffixes) {
    EXPECT_THAT(parseSizeBytes("4096"), Optional(4096U));
    EXPECT_THAT(parseSizeBytes("512M"), Optional(std::uint64_t{512} << 20));
    EXPECT_THAT(parseSizeBytes("2g"), Optional(std::uint64_t{2} << 30));
    EXPECT_THAT(parseSizeBytes("1KiB"), Optional(1024U));
    EXPECT_THAT(parseSizeBytes("1KB"), Optional(1024U));
    EXPECT_THAT(parseSizeBytes("16777215T"), Optional(std::uint64_t{16777215} << 40));
    for (const auto* text :
         {"", "M", "-1", "+1", "1.5G", "12parsecs", "1 M", "1Mi", "16777216T", "18446744073709551616"})
        EXPECT_THAT(parseSizeBytes(text), Eq(std::nullopt)) << text;
}

TEST(NumberParsing, SplitsKeepingEmptyParts) {
    EXPECT_THAT(splitAt("1,2", ','), ElementsAre("1", "2"));
    EXPECT_THAT(splitAt("", ','), ElementsAre(""));
    EXPECT_THAT(splitAt("1,,", ','), ElementsAre("1", "", ""));
}

TEST(NumberParsing, NamesSizesForPeople) {
    EXPECT_EQ(sizeText(0), "0 B");
    EXPECT_EQ(sizeText(std::uint64_t{64} << 20), "64 MiB");
    EXPECT_EQ(sizeText(1536), "1.5 KiB");
}

} // namespace isoslider::cli
