// Pages of events, coded by several threads while events come.

#include "core/topology/event_coder.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

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
        pages = coder.take().value();
    });
    return pages;
}

std::vector<std::vector<std::byte>> bytesOf(const EventPages& pages) {
    std::vector<std::vector<std::byte>> all;
    for (std::size_t i = 0; i < pages.pages.size(); ++i) {
        auto bytes = pages.bytesOf(i);
        EXPECT_THAT(bytes, test::IsOk());
        all.push_back(std::move(bytes).value());
    }
    return all;
}

TEST(EventCoder, CodesTheSamePagesWithAnyNumberOfThreads) {
    // More pages than may wait, and a last one that is not full.
    const std::vector<TopologyEvent> events = someEvents(40 * EventPage::kMostEvents + 17);
    const EventPages alone = coded(events, 1), together = coded(events, 4);
    ASSERT_EQ(alone.pages.size(), 41U);
    ASSERT_EQ(bytesOf(alone), bytesOf(together));
    std::uint64_t offset = 0;
    std::size_t next = 0;
    for (std::size_t i = 0; i < alone.pages.size(); ++i) {
        const EventPage& page = together.pages[i];
        EXPECT_EQ(page.offset, offset);
        ASSERT_EQ(page.bytes, bytesOf(together)[i].size());
        offset += page.bytes;
        EXPECT_EQ(page.firstIsovalue, events[next].isovalue);
        const auto decoded = decodeEvents(page, together.bytesOf(i).value(), "test");
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

TEST(EventCoder, PutsPagesOffToAFile) {
    const test::TemporaryFolder folder;
    const std::vector<TopologyEvent> events = someEvents(30 * EventPage::kMostEvents);
    const EventPages whole = coded(events, 1);
    EventPages parted;
    {
        const auto scratch = std::make_shared<ScratchFile>(folder / "pages");
        EventCoder coder(scratch, 100'000); // a few pages
        for (const TopologyEvent& event : events)
            coder.add(event);
        parted = coder.take().value();
        EXPECT_GT(scratch->sizeBytes(), 100'000u);
        const auto isHeld = [](const EventPages::Bytes& bytes) { return !bytes.held.empty(); };
        EXPECT_TRUE(std::any_of(parted.bytes.begin(), parted.bytes.end(), isHeld));
    }
    EXPECT_EQ(bytesOf(parted), bytesOf(whole)) << "the file lasts as long as the pages";
    const auto unused = std::make_shared<ScratchFile>(folder / "pages");
    EventCoder roomy(unused, 100'000'000);
    for (const TopologyEvent& event : events)
        roomy.add(event);
    EXPECT_EQ(roomy.take().value().scratch, nullptr) << "all are held";
    EventCoder lost(std::make_shared<ScratchFile>("/nowhere/at/all"), 0);
    for (const TopologyEvent& event : events)
        lost.add(event);
    EXPECT_THAT(lost.take(), test::HasError(ErrorCode::NotFound));
}

TEST(EventCoder, MayBeUsedAgainAndMayBeGivenUp) {
    const std::vector<TopologyEvent> events = someEvents(3 * EventPage::kMostEvents);
    EventCoder coder;
    EXPECT_TRUE(coder.take().value().pages.empty());
    for (int round = 0; round < 2; ++round) {
        for (const TopologyEvent& event : events)
            coder.add(event);
        const EventPages pages = coder.take().value();
        ASSERT_EQ(pages.pages.size(), 3U);
        EXPECT_EQ(pages.pages.front().offset, 0U);
    }
    for (const TopologyEvent& event : events)
        coder.add(event); // and nobody takes them
}

} // namespace
} // namespace isoslider::topology
