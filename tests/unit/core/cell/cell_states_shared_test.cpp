// The published list of labelled states, where the folder with further test data is there.

#include <filesystem>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/csv_rows.h"
#include "tests/support/test_paths.h"
#include "tests/unit/core/cell/state_labels.h"

namespace isoslider::cell {
namespace {

struct ListedState {
    test::CellScalars scalars{};
    int signs = 0, loops = 0, components = 0, euler = 0, tunnel = 0, aboveRegions = 0, belowRegions = 0;
    std::string faces; // by face: 0 not ambiguous, 1 above corners joined, 2 apart
};

std::vector<ListedState> readStates(const std::filesystem::path& path) {
    std::vector<ListedState> states;
    test::forEachCsvRow(path, [&](std::istringstream& columns) {
        ListedState state;
        std::string name;
        columns >> name >> state.signs;
        for (double& scalar : state.scalars)
            columns >> scalar;
        columns >> state.loops >> state.components >> state.euler >> state.tunnel >> state.aboveRegions >>
            state.belowRegions;
        columns >> state.faces;
        states.push_back(state);
    });
    return states;
}

std::string facesOf(std::uint8_t signs, std::uint8_t joined) {
    std::string faces(6, '0');
    for (std::size_t f = 0; f < 6; ++f)
        if ((ambiguousFaces(signs) >> f & 1) != 0)
            faces[f] = (joined >> f & 1) != 0 ? '1' : '2';
    return faces;
}

class ListedStates : public testing::Test {
protected:
    void SetUp() override {
        const auto path =
            std::filesystem::path(test::sharedFolder()) / "reference" / "topology" / "cell_states_768.csv";
        if (!std::filesystem::exists(path))
            GTEST_SKIP() << "further test data is not here: " << path;
        states_ = readStates(path);
        ASSERT_EQ(states_.size(), 768u);
    }
    std::vector<ListedState> states_;
};

TEST_F(ListedStates, AreWhatTheOracleFinds) {
    for (const ListedState& listed : states_)
        for (int axis = 0; axis < 3; ++axis) {
            const test::CellTopology t = test::sweepCell(listed.scalars, 0.0, axis);
            ASSERT_EQ(t.signs, listed.signs);
            EXPECT_EQ(facesOf(t.signs, t.joinedFaces), listed.faces);
            EXPECT_EQ(t.loops, listed.loops);
            EXPECT_EQ(t.components, listed.components);
            EXPECT_EQ(t.euler, listed.euler);
            EXPECT_EQ(t.aboveJoinsInside + t.belowJoinsInside, listed.tunnel);
            EXPECT_EQ(t.aboveRegions, listed.aboveRegions);
            EXPECT_EQ(t.belowRegions, listed.belowRegions);
        }
}

TEST_F(ListedStates, AreResolvedAtEveryScaleAndIsovalue) {
    int checked = 0;
    for (const ListedState& listed : states_)
        for (const double scale : {1e-6, 1.0, 1e6})
            for (const double isovalue : {0.0, 17.0, -1000.0}) {
                test::CellScalars scalars;
                for (std::size_t i = 0; i < 8; ++i)
                    scalars[i] = listed.scalars[i] * scale + isovalue;
                const CellState& state = stateAt(scalars, isovalue);
                SCOPED_TRACE(test::toString(scalars, isovalue));
                ASSERT_EQ(state.signs, listed.signs);
                EXPECT_EQ(facesOf(state.signs, state.joinedFaces), listed.faces);
                EXPECT_EQ(state.loops, listed.loops);
                EXPECT_EQ(state.components, listed.components);
                EXPECT_EQ(state.tunnel != Tunnel::None, listed.tunnel != 0);
                EXPECT_EQ(2 * state.components - state.loops, listed.euler);
                ASSERT_FALSE(HasFailure());
                ++checked;
            }
    EXPECT_EQ(checked, 768 * 9);
}

TEST_F(ListedStates, AreAllThatTheirSymmetriesGive) {
    std::set<StateLabel> labels, turnedLabels;
    for (const ListedState& listed : states_)
        for (int symmetry = 0; symmetry < 96; ++symmetry) {
            const test::CellScalars cell = test::turned(listed.scalars, symmetry);
            const CellState& state = stateAt(cell, 0.0);
            ASSERT_EQ(state.loops, listed.loops) << test::toString(cell, 0.0);
            ASSERT_EQ(state.components, listed.components) << test::toString(cell, 0.0);
            turnedLabels.insert(labelOf(state));
            if (symmetry == 0)
                labels.insert(labelOf(state));
        }
    EXPECT_EQ(labels.size(), 768u);
    EXPECT_EQ(turnedLabels, labels);
}

} // namespace
} // namespace isoslider::cell
