#include "ui/model/topology/event_words.h"

#include <limits>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

using topology::SurfaceCounts;
using topology::TopologyEvent;

/// Handles follow from the Euler number.
SurfaceCounts counts(std::int64_t pieces, std::int64_t tunnels, std::int64_t voids = 0, std::int64_t loops = 0) {
    return {pieces, 2 * pieces - loops - 2 * tunnels, loops, voids};
}

TopologyEvent change(const SurfaceCounts& below, const SurfaceCounts& above) {
    TopologyEvent event;
    event.below = below;
    event.above = above;
    return event;
}

TopologyEvent listed(std::uint32_t births, std::uint32_t deaths, std::uint32_t joins, std::uint32_t splits) {
    TopologyEvent event = change(counts(5, 1), counts(5, 1));
    event.pieces = {births, deaths, joins, splits};
    return event;
}

TEST(EventWords, NameWhatHappensToPieces) {
    EXPECT_EQ(wordsOf(listed(1, 0, 0, 0)), "A piece appears");
    EXPECT_EQ(wordsOf(listed(2, 0, 0, 0)), "2 pieces appear");
    EXPECT_EQ(wordsOf(listed(0, 1, 0, 0)), "A piece disappears");
    EXPECT_EQ(wordsOf(listed(0, 1200, 0, 0)), "1,200 pieces disappear");
    EXPECT_EQ(wordsOf(listed(0, 0, 1, 0)), "Two pieces join");
    EXPECT_EQ(wordsOf(listed(0, 0, 3, 0)), "Pieces join 3 times");
    EXPECT_EQ(wordsOf(listed(0, 0, 0, 1)), "A piece splits");
    EXPECT_EQ(wordsOf(listed(1, 0, 0, 2)), "A piece appears, pieces split 2 times");
}

TEST(EventWords, FallBackOnCounts) {
    EXPECT_EQ(wordsOf(change(counts(1, 0), counts(2, 0))), "Pieces appear or split");
    EXPECT_EQ(wordsOf(change(counts(2, 0), counts(1, 0))), "Pieces join or go");
    EXPECT_EQ(wordsOf(change(counts(1, 0), counts(1, 1))), "A tunnel opens");
    EXPECT_EQ(wordsOf(change(counts(1, 3), counts(1, 1))), "2 tunnels close");
    EXPECT_EQ(wordsOf(change(counts(1, 0, 0), counts(1, 0, 1))), "A void appears");
    EXPECT_EQ(wordsOf(change(counts(1, 0, 0, 3), counts(1, 0, 0, 1))), "2 boundary loops disappear");
    EXPECT_EQ(wordsOf(change(counts(1, 0), counts(1, 0))), "No count changes");
}

TEST(EventWords, DrawTheMostFrequentChange) {
    EXPECT_EQ(classOf(listed(1, 0, 0, 0)), EventClass::PieceComes);
    EXPECT_EQ(classOf(listed(0, 2, 0, 1)), EventClass::PieceGoes);
    EXPECT_EQ(classOf(listed(1, 1, 1, 1)), EventClass::PiecesJoin);
    EXPECT_EQ(classOf(listed(1, 0, 0, 1)), EventClass::PieceSplits);
    EXPECT_EQ(classOf(change(counts(1, 0), counts(2, 0))), EventClass::PieceComes);
    EXPECT_EQ(classOf(change(counts(3, 0), counts(2, 0))), EventClass::PieceGoes);
    EXPECT_EQ(classOf(change(counts(1, 0), counts(1, 1))), EventClass::Other);
}

TEST(EventWords, FilterByWhatHappens) {
    const auto joins = listed(0, 0, 1, 0);
    EXPECT_TRUE(passes(EventFilter::All, joins));
    EXPECT_TRUE(passes(EventFilter::PiecesJoin, joins));
    EXPECT_FALSE(passes(EventFilter::PiecesCome, joins));
    EXPECT_FALSE(passes(EventFilter::Tunnels, joins));
    // Not listed: one more piece has either appeared or been split off.
    const auto more = change(counts(1, 0), counts(2, 1));
    EXPECT_TRUE(passes(EventFilter::PiecesCome, more));
    EXPECT_TRUE(passes(EventFilter::PiecesSplit, more));
    EXPECT_FALSE(passes(EventFilter::PiecesGo, more));
    EXPECT_TRUE(passes(EventFilter::Tunnels, more));
    EXPECT_FALSE(passes(EventFilter::Voids, more));
    EXPECT_TRUE(passes(EventFilter::Loops, change(counts(1, 0, 0, 0), counts(1, 0, 0, 1))));
    for (int filter = 0; filter < kEventFilters; ++filter)
        EXPECT_NE(std::string(nameOf(static_cast<EventFilter>(filter))), "") << filter;
}

TEST(EventWords, CountInSingularAndPlural) {
    EXPECT_EQ(countsText(counts(12, 3, 1, 2)), "12 pieces · 3 tunnels · 1 void · 2 boundary loops");
    EXPECT_EQ(countsText(counts(1, 1, 0, 1)), "1 piece · 1 tunnel · 0 voids · 1 boundary loop");
    EXPECT_EQ(countsText(counts(12, 3, 1, 2), false), "at least 12 pieces · 1 void · at least 2 boundary loops");
    EXPECT_EQ(countsText(counts(123456, 0)), "123,456 pieces · 0 tunnels · 0 voids · 0 boundary loops");
    EXPECT_EQ(changeText(1200, 1201), "1,200 → 1,201");
    EXPECT_EQ(changeText(7, 7), "7");
}

TEST(EventWords, DescribeAnEventInLines) {
    auto event = change(counts(1, 0), counts(2, 0));
    event.isovalue = 42.5;
    event.persistence = 3.25;
    EXPECT_EQ(describe(event), "Isovalue 42.5\nPieces appear or split\nPersistence 3.25\n"
                               "Before: 1 piece · 0 tunnels · 0 voids · 0 boundary loops\n"
                               "After: 2 pieces · 0 tunnels · 0 voids · 0 boundary loops");
    event.persistence = 0.0;
    EXPECT_EQ(describe(event).find("Persistence"), std::string::npos);
}

TEST(EventWords, TakeAnyCount) {
    SurfaceCounts least, most;
    least.voids = std::numeric_limits<std::int64_t>::min();
    most.voids = std::numeric_limits<std::int64_t>::max();
    EXPECT_EQ(wordsOf(change(least, most)), "18,446,744,073,709,551,615 voids appear");
}

} // namespace
} // namespace isoslider::model
