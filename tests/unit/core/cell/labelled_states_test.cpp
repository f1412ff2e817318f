// The labelled states are not written down anywhere: random cells and the cube's symmetries give them all.

#include <gtest/gtest.h>

#include "tests/unit/core/cell/state_labels.h"

namespace isoslider::cell {
namespace {

const ClassWitnesses& knownClasses() {
    static const ClassWitnesses kClasses = findClasses(7);
    return kClasses;
}

TEST(LabelledStates, AreSevenHundredSixtyEightInThirtyOneClasses) {
    EXPECT_EQ(knownClasses().classes.size(), 31u);
    EXPECT_EQ(knownClasses().classOf.size(), 768u);
}

TEST(LabelledStates, AllHaveAStateWithTheirPieces) {
    for (const auto& [label, number] : knownClasses().classOf) {
        SCOPED_TRACE(toString(label));
        const auto signs = static_cast<std::uint8_t>(label.signs),
                   joined = static_cast<std::uint8_t>(label.joinedFaces);
        if (label.tunnel != Tunnel::None) {
            EXPECT_NE(mayHaveTunnel(signs, joined) & (label.tunnel == Tunnel::Above ? 1u : 2u), 0u);
            EXPECT_TRUE(isAmbiguous(signs));
        }
        bool isThere = false;
        for (const CellState& state : cellStates())
            isThere |= labelOf(state) == label;
        EXPECT_TRUE(isThere);
    }
}

// Every witness in every position, at several scales and isovalues; as the eight-bit scalars that it rounds
// to where these have the same state.
TEST(LabelledStates, AreResolvedAtEveryScaleAndIsovalue) {
    int states = 0, roundedStates = 0;
    for (const auto& witnesses : knownClasses().classes)
        for (int symmetry = 0; symmetry < 96; ++symmetry) {
            const test::CellScalars cell = test::turned(witnesses.front(), symmetry);
            const test::CellTopology expected = test::sweepCell(cell, 0.0);
            for (const double scale : {1e-6, 1.0, 1e6})
                for (const double isovalue : {0.0, 17.0, -1000.0}) {
                    test::CellScalars scalars;
                    for (std::size_t i = 0; i < 8; ++i)
                        scalars[i] = cell[i] * scale + isovalue;
                    if (labelOf(test::sweepCell(scalars, isovalue)) != labelOf(expected))
                        continue; // lost in rounding to doubles
                    const CellState& state = stateAt(scalars, isovalue);
                    ASSERT_EQ(labelOf(state), labelOf(expected))
                        << toString(labelOf(expected)) << test::toString(scalars, isovalue);
                    EXPECT_EQ(state.components, expected.components);
                    EXPECT_EQ(state.loops, expected.loops);
                    ++states;
                }
            test::CellScalars rounded;
            for (std::size_t i = 0; i < 8; ++i)
                rounded[i] = static_cast<std::int8_t>(std::lround(cell[i] * 2.0));
            const StateLabel roundedLabel = labelOf(test::sweepCell(rounded, 0.0));
            ASSERT_EQ(labelOf(stateAt(rounded, 0.0)), roundedLabel) << test::toString(rounded, 0.0);
            ++roundedStates;
        }
    EXPECT_GT(states, 31 * 96 * 9 * 9 / 10);
    EXPECT_EQ(roundedStates, 31 * 96);
}

TEST(LabelledStates, TurnWithTheCell) {
    test::Random random(5);
    for (int i = 0; i < 300; ++i) {
        const test::CellScalars cell = untiedCell(random);
        const CellState& state = stateAt(cell, 0.0);
        for (int symmetry = 1; symmetry < 96; ++symmetry) {
            const CellState& turnedState = stateAt(test::turned(cell, symmetry), 0.0);
            ASSERT_EQ(turnedState.components, state.components)
                << test::toString(cell, 0.0) << " symmetry " << symmetry;
            ASSERT_EQ(turnedState.loops, state.loops);
            ASSERT_EQ(turnedState.tunnel == Tunnel::None, state.tunnel == Tunnel::None);
        }
    }
}

} // namespace
} // namespace isoslider::cell
