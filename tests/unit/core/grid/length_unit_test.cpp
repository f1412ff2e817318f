#include "core/grid/length_unit.h"

#include <gtest/gtest.h>

namespace isoslider {
namespace {

TEST(LengthUnit, OneUnitHasOneSymbol) {
    for (const char* text : {"mm", "MM", "millimeter", "Millimetres", "millimeters"})
        EXPECT_EQ(knownLengthUnit(text), "mm") << text;
    for (const char* text :
         {"um", "µm", "\xce\xbcm", "\xb5m", "\\u00B5m", "&#181;m", "micron", "microns", "Micrometers"})
        EXPECT_EQ(knownLengthUnit(text), "µm") << text;
    for (const char* text : {"angstrom", "Angstroms", "Å", "\xe2\x84\xab"})
        EXPECT_EQ(knownLengthUnit(text), "Å") << text;
    EXPECT_EQ(knownLengthUnit("metres"), "m");
    EXPECT_EQ(knownLengthUnit("inches"), "in");
    for (const char* text : {"", "ms", "degrees_north", "K", "furlong"})
        EXPECT_EQ(knownLengthUnit(text), "") << text;
}

TEST(LengthUnit, UnknownOnesAreKeptWhereTheyCanBeShown) {
    EXPECT_EQ(lengthUnitOf("furlong"), "furlong");
    EXPECT_EQ(lengthUnitOf("micron"), "µm");
    EXPECT_EQ(lengthUnitOf("light-nanosecond"), "light-nanosecond") << "16 characters";
    for (const char* text : {"pixel", "Pixels", "light-nanoseconds", "a b", "a\nb", "\x1b[2J", "\xff", "\xc3",
                             "\xc0\x80", "\xed\xa0\x80", "\xe2\x80\xae", "\xc2\x85"})
        EXPECT_EQ(lengthUnitOf(text), "") << text;
}

TEST(LengthUnit, ASymbolIsCountedInCharacters) {
    std::string symbol;
    for (int i = 0; i < 16; ++i)
        symbol += "Å";
    EXPECT_TRUE(isLengthUnit(symbol));
    EXPECT_FALSE(isLengthUnit(symbol + "Å"));
    EXPECT_TRUE(isLengthUnit(""));
}

TEST(LengthUnit, IsNamedByItsMetres) {
    EXPECT_EQ(lengthUnitOfMetres(1.0), "m");
    EXPECT_EQ(lengthUnitOfMetres(1e-3), "mm");
    EXPECT_EQ(lengthUnitOfMetres(9.9999999e-7), "µm");
    EXPECT_EQ(lengthUnitOfMetres(2.0), "");
    EXPECT_EQ(lengthUnitOfMetres(0.0), "");
    EXPECT_EQ(lengthUnitOfMetres(-1.0), "");
}

} // namespace
} // namespace isoslider
