// Pages of events, coded by several threads while events come.

#include "core/topology/event_coder.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "tests/support/result_matchers.h"

namespace isoslider::topology {
namespace {

std::vector<TopologyEvent> someEvents(std::size_t count) {
    std::mt19937 random(1);
    std::vector<TopologyEvent> events(count);
    SurfaceCounts counts;
    for (std::size_t i = 0; i < count; ++i) {
        TopologyEvent& event = events[i];
        event.isovalue = static_cast<double>(i) + 1e-9 * static_cast<double>(random() % 1000);
        event.kind = static_cast<EventKind>(random() % 3);
        event.position = {0.5f * static_cast<float>(random() % 100), static_cast<float>(random() % 100), 1.0f};
        event.below = counts;
        counts.components += static_cast<std::int64_t>(random() % 5);
        counts.euler -= static_cast<std::int64_t>(random() % 9);
        event.above = counts;
        event.pieces.births = random() % 5;
        event.persistence = static_cast<double>(random() % 7);
    }
    return events;
}

EventPages coded(const std::vector<TopologyEvent>& events, int threads) {
    EventPages pages;
    tbb::task_arena(threads).execute([&] {
        EventCoder coder;
        for (const TopologyEvent& event : events)
            coder.add(event);
        pages = coder.take();
    });
    return pages;
}

TEST(EventCoder, CodesTheSamePagesWithAnyNumberOfThreads) {
    // More pages than may wait, and a last one that is not full.
    const std::vector<TopologyEvent> events = someEvents(40 * EventPage::kMostEvents + 17);
    const EventPages alone = coded(events, 1), together = coded(events, 4);
    ASSERT_EQ(alone.pages.size(), 41U);
    EXPECT_EQ(alone.bytes, together.bytes);
    std::uint64_t offset = 0;
    std::size_t next = 0;
    for (std::size_t i = 0; i < alone.pages.size(); ++i) {
        const EventPage& page = together.pages[i];
        EXPECT_EQ(page.offset, offset);
        ASSERT_EQ(page.bytes, together.bytes[i].size());
        offset += page.bytes;
        EXPECT_EQ(page.firstIsovalue, events[next].isovalue);
        const auto decoded = decodeEvents(page, together.bytes[i], "test");
        ASSERT_THAT(decoded, test::IsOk());
        for (const TopologyEvent& event : decoded.value()) {
            const TopologyEvent& expected = events[next++];
            ASSERT_EQ(event.isovalue, expected.isovalue);
            ASSERT_EQ(event.kind, expected.kind);
            ASSERT_EQ(event.position, expected.position);
            ASSERT_EQ(event.below, expected.below);
            ASSERT_EQ(event.above, expected.above);
            ASSERT_EQ(event.pieces, expected.pieces);
            ASSERT_EQ(event.persistence, expected.persistence);
        }
    }
    EXPECT_EQ(next, events.size());
}

TEST(EventCoder, MayBeUsedAgainAndMayBeGivenUp) {
    const std::vector<TopologyEvent> events = someEvents(3 * EventPage::kMostEvents);
    EventCoder coder;
    EXPECT_TRUE(coder.take().pages.empty());
    for (int round = 0; round < 2; ++round) {
        for (const TopologyEvent& event : events)
            coder.add(event);
        const EventPages pages = coder.take();
        ASSERT_EQ(pages.pages.size(), 3U);
        EXPECT_EQ(pages.pages.front().offset, 0U);
    }
    for (const TopologyEvent& event : events)
        coder.add(event); // and nobody takes them
}

} // namespace
} // namespace isoslider::topology
