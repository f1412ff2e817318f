#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "ui/model/isovalue/deviation_text.h"

#include "ui/model/isovalue/number_text.h"

#include "ui/model/opening/raw_guess.h"

namespace isoslider::model {
namespace {

TEST(NumberText, GroupsThousands) {
    EXPECT_EQ(groupedText(std::uint64_t{0}), "0");
    EXPECT_EQ(groupedText(std::uint64_t{999}), "999");
    EXPECT_EQ(groupedText(std::uint64_t{1000}), "1,000");
    EXPECT_EQ(groupedText(std::uint64_t{1234567}), "1,234,567");
    EXPECT_EQ(groupedText(std::int64_t{-1234}), "-1,234");
    EXPECT_EQ(groupedText(std::numeric_limits<std::int64_t>::min()), "-9,223,372,036,854,775,808");
}

TEST(NumberText, ShortensCountsAndBytes) {
    EXPECT_EQ(compactText(9999), "9999");
    EXPECT_EQ(compactText(12'400), "12.4 k");
    EXPECT_EQ(compactText(999'999), "1.00 M");
    EXPECT_EQ(compactText(3'810'000), "3.81 M");
    EXPECT_EQ(bytesText(1023), "1023 B");
    EXPECT_EQ(bytesText(1536), "1.50 KiB");
    EXPECT_EQ(bytesText(std::uint64_t{5} << 30), "5.00 GiB");
}

TEST(NumberText, WritesValuesAndTimes) {
    EXPECT_EQ(valueText(0.0), "0");
    EXPECT_EQ(valueText(-0.0), "0");
    EXPECT_EQ(valueText(1016.53), "1016.53");
    EXPECT_EQ(valueText(1.5e-7), "1.5e-07");
}

TEST(NumberText, MeasuresAreGroupedWhereTheyAreLarge) {
    EXPECT_EQ(measureText(0.0, 4), "0");
    EXPECT_EQ(measureText(521.84, 4), "521.8");
    EXPECT_EQ(measureText(9999.4, 4), "9999");
    EXPECT_EQ(measureText(9999.7, 4), "10,000");
    EXPECT_EQ(measureText(290'163.0, 4), "290,200");
    EXPECT_EQ(measureText(-290'163.0, 4), "-290,200");
    EXPECT_EQ(measureText(99'999.0, 4), "100,000");
    EXPECT_EQ(measureText(1.2345678e14, 4), "123,500,000,000,000");
    EXPECT_EQ(measureText(1.2345678e15, 4), "1.235e+15");
    EXPECT_EQ(measureText(1.5e-7, 4), "1.5e-07");
    EXPECT_EQ(measureText(HUGE_VAL, 4), "inf");
    EXPECT_EQ(measureText(9999.25), "9999.25");
    EXPECT_EQ(measureText(35112.468), "35,112.47");
    EXPECT_EQ(measureText(-1234567.8), "-1,234,568");
    EXPECT_EQ(measureText(123456.0), "123,456");
    EXPECT_EQ(measureText(12345678.0), "12,345,680");
    EXPECT_EQ(estimateText(209'812.0), "\xE2\x89\x88 209,800");
    EXPECT_EQ(estimateText(0.012346), "\xE2\x89\x88 0.01235");
    EXPECT_EQ(millisecondsText(0.417), "0.42 ms");
    EXPECT_EQ(millisecondsText(18.34), "18.3 ms");
    EXPECT_EQ(millisecondsText(1240.0), "1.24 s");
    EXPECT_EQ(millisecondsText(125'000.0), "2 min 05 s");
}

TEST(RawGuess, ReadsDimsAndTypeFromTheName) {
    const auto layout = guessRawLayout("Skull_256x256x113_UINT16.raw", 256 * 256 * 113 * 2);
    EXPECT_EQ(layout.dims, (GridDims{256, 256, 113}));
    EXPECT_EQ(layout.type, ScalarType::U16);
    EXPECT_EQ(layoutBytes(layout), std::uint64_t{256 * 256 * 113 * 2});
}

TEST(RawGuess, TakesTheTypeThatFitsTheNamedDims) {
    const auto layout = guessRawLayout("head_64x32x16.raw", 64 * 32 * 16 * 4);
    EXPECT_EQ(layout.dims, (GridDims{64, 32, 16}));
    EXPECT_EQ(layout.type, ScalarType::F32);
}

TEST(RawGuess, FindsCubesAndSquareSlices) {
    EXPECT_EQ(guessRawLayout("a.raw", 41 * 41 * 41).dims, (GridDims{41, 41, 41}));
    EXPECT_EQ(guessRawLayout("a.raw", 256 * 256 * 99).dims, (GridDims{256, 256, 99}));
    EXPECT_EQ(guessRawLayout("a_float.raw", 64 * 64 * 64 * 4).type, ScalarType::F32);
}

TEST(RawGuess, GivesNothingForASizeThatFitsNothing) {
    EXPECT_EQ(guessRawLayout("a.raw", 1000003).dims, (GridDims{0, 0, 0}));
    EXPECT_EQ(guessRawLayout("", 0).dims, (GridDims{0, 0, 0}));
    EXPECT_EQ(guessRawLayout("999999_999999_999999.raw", 5).dims, (GridDims{999999, 999999, 999999}));
}

TEST(NumberFrom, TakesAPointOrAComma) {
    EXPECT_EQ(numberFrom("92.5"), 92.5);
    EXPECT_EQ(numberFrom("92,5"), 92.5);
    EXPECT_EQ(numberFrom("-0,001"), -0.001);
    EXPECT_EQ(numberFrom("1,5e-3"), 1.5e-3);
    EXPECT_EQ(numberFrom(" +7 "), 7.0);
    EXPECT_EQ(numberFrom("1,234"), 1.234);
    EXPECT_EQ(numberFrom("1,234,567"), 1234567.0);
    EXPECT_EQ(numberFrom("1.234.567"), 1234567.0);
    EXPECT_EQ(numberFrom("1,234.5"), 1234.5);
    EXPECT_EQ(numberFrom("1.234,5"), 1234.5);
    EXPECT_EQ(numberFrom("1'234.5"), 1234.5);
    EXPECT_EQ(numberFrom("1\xE2\x80\xAF"
                         "234,5"),
              1234.5);
    EXPECT_EQ(numberFrom("\xE2\x88\x92"
                         "12,5"),
              -12.5);
}

TEST(NumberFrom, BoundsWhatIsTooLarge) {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    EXPECT_EQ(numberFrom("1e999"), kInf);
    EXPECT_EQ(numberFrom("-1e999"), -kInf);
    EXPECT_EQ(numberFrom("1e-999"), 0.0);
    EXPECT_EQ(numberFrom("inf"), kInf);
}

TEST(NumberFrom, RefusesWhatIsNone) {
    for (const char* text :
         {"",     " ",    "bone", "nan",       "1e", "1,2,3", "1.2.3", "1,23,456", "--1",  "+-1",
          "1,5,", "5 mm", "0x10", "1,234.5.6", ",",  ".",     "5 6",   "-5 -6",    "1 23", "1.5 000"})
        EXPECT_FALSE(numberFrom(text)) << text;
}

TEST(IsovalueFrom, TakesValuesAndStandardDeviations) {
    EXPECT_EQ(isovalueFrom("1,5")->number, 1.5);
    EXPECT_FALSE(isovalueFrom("1,5")->isInDeviations);
    for (const char* text : {"-2,5 sigma", "-2.5\xCF\x83",
                             "\xE2\x88\x92"
                             "2.5 sd"}) {
        ASSERT_TRUE(isovalueFrom(text)) << text;
        EXPECT_EQ(isovalueFrom(text)->number, -2.5) << text;
        EXPECT_TRUE(isovalueFrom(text)->isInDeviations) << text;
    }
    for (const char* text : {"", "sigma", "bone sd", "2 sigma sigma", "2 sigma 3"})
        EXPECT_FALSE(isovalueFrom(text)) << text;
}

TEST(DeviationsText, StatesTheIsovalueFromTheMean) {
    EXPECT_EQ(deviationsText(20.0, {10.0, 4.0, true}), "mean + 2.5 \xCF\x83");
    EXPECT_EQ(deviationsText(5.0, {10.0, 4.0, false}), "\xE2\x89\x88 mean \xE2\x88\x92 1.25 \xCF\x83");
    EXPECT_EQ(deviationsText(5.0, {5.0, 0.0, true}), "");
    EXPECT_EQ(spreadText({10.0, 4.0, true}), "10 \xC2\xB1 4");
}

TEST(ExactText, IsShortAndReadsTheSame) {
    EXPECT_EQ(exactText(92.4), "92.4");
    EXPECT_EQ(exactText(100.0), "100");
    EXPECT_EQ(exactText(-1024.0), "-1024");
    EXPECT_EQ(exactText(3.14159265359), "3.14159265359");
    EXPECT_EQ(exactText(std::nextafter(92.0, 100.0)), "92");
    EXPECT_EQ(exactText(1.0 / 3.0), "0.33333333");
    EXPECT_EQ(exactText(3e38), "3e+38");
    EXPECT_EQ(exactText(0.0), "0");
}

TEST(ResolvedText, HasTheDigitsThatPixelsTellApart) {
    EXPECT_EQ(resolvedText(92.387695, 0.18), "92.4");
    EXPECT_EQ(resolvedText(92.387695, 2.0), "92");
    EXPECT_EQ(resolvedText(92.387695, 0.001), "92.388");
    EXPECT_EQ(resolvedText(0.01, 0.18), "0");
}

} // namespace
} // namespace isoslider::model
