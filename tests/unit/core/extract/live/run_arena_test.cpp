#include "core/extract/live/run_arena.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/process_memory.h"
#include "core/extract/edge_interpolation.h"
#include "core/extract/live/edge_record.h"

namespace isoslider::extract {
namespace {

using Arena = RunArena<std::uint32_t, 16, 12>;

// Random growth, shrinking and release: runs never overlap, keep what is in them, and never cross a chunk.
TEST(RunArena, KeepsRunsApart) {
    std::mt19937 random(11);
    Arena arena;
    struct Owned {
        ArenaRun run;
        std::uint32_t count = 0;
    };
    std::vector<Owned> runs(60);
    for (int round = 0; round < 4000; ++round) {
        const std::size_t i = random() % runs.size();
        Owned& owned = runs[i];
        owned.count = random() % 5 == 0 ? 0 : random() % 900;
        arena.resize(owned.run, owned.count);
        ASSERT_GE(owned.run.capacity, owned.count);
        ASSERT_EQ(owned.run.begin % Arena::kGranule, 0u);
        if (owned.run.capacity > 0) {
            ASSERT_EQ(owned.run.begin >> 12, (owned.run.begin + owned.run.capacity - 1) >> 12) << "inside one chunk";
            std::fill_n(arena.at(owned.run.begin), owned.run.capacity, static_cast<std::uint32_t>(i));
        }
        for (std::size_t k = 0; k < runs.size(); ++k)
            if (runs[k].run.capacity > 0) {
                ASSERT_EQ(*arena.at(runs[k].run.begin), k);
                ASSERT_EQ(*arena.at(runs[k].run.begin + runs[k].run.capacity - 1), k);
            }
    }
    EXPECT_LT(arena.top(), 4u * 60 * 1024) << "freed runs are used again";
}

TEST(RunArena, KeepsARunThatFits) {
    Arena arena;
    ArenaRun run;
    arena.resize(run, 100);
    const ArenaRun before = run;
    arena.resize(run, 112);
    EXPECT_EQ(run.begin, before.begin);
    arena.resize(run, 60);
    EXPECT_EQ(run.begin, before.begin);
    arena.resize(run, 10);
    EXPECT_LE(run.capacity, 32u) << "much too large a run is given back";
    const ArenaRun small = run;
    ArenaRun other;
    for (const std::uint32_t count : {1u, 3u, 7u}) { // less than half of the smallest that there is
        arena.resize(run, count);
        EXPECT_EQ(run.begin, small.begin);
        EXPECT_EQ(run.capacity, Arena::kGranule);
    }
    arena.resize(other, 5);
    EXPECT_NE(other.begin, run.begin);
}

// Threads that take runs ahead, in turns: what they were given is nobody else's, and all of it comes back.
TEST(RunArena, GivesRunsAheadToOneOnly) {
    std::mt19937 random(12);
    Arena arena;
    std::array<Arena::Ahead, 3> aheads;
    std::vector<ArenaRun> runs(200);
    std::uint64_t mostTop = 0;
    for (int move = 0; move < 40; ++move) {
        for (int k = 0; k < 500; ++k) {
            const std::size_t i = random() % runs.size();
            if (random() % 2 == 0)
                arena.release(runs[i]);
            const std::uint32_t count = random() % 7 == 0 ? 3000 : random() % 300;
            arena.resize(runs[i], count, aheads[random() % aheads.size()]);
            ASSERT_GE(runs[i].capacity, count);
            if (runs[i].capacity > 0)
                std::fill_n(arena.at(runs[i].begin), runs[i].capacity, static_cast<std::uint32_t>(i));
        }
        for (std::size_t i = 0; i < runs.size(); ++i)
            for (std::uint32_t k = 0; k < runs[i].capacity; ++k)
                ASSERT_EQ(*arena.at(runs[i].begin + k), i);
        for (Arena::Ahead& ahead : aheads)
            arena.takeBack(ahead);
        if (move == 20)
            mostTop = arena.top();
    }
    EXPECT_LT(arena.top(), 2 * mostTop) << "what comes back is used again";
    for (ArenaRun& run : runs)
        arena.release(run);
    EXPECT_EQ(arena.unusedBytes(), arena.top() * sizeof(std::uint32_t));
}

// Owners come and go by phases, so that the array is often sparse; it is emptied from above while runs go on being
// taken and given back, and what they hold stays. After few rounds it is at most half as long again as what is in use.
TEST(RunArena, EndsWhereItIsEmptiedFrom) {
    std::mt19937 random(14);
    RunArena<std::uint32_t, 16, 14> arena;
    std::vector<ArenaRun> runs(400);
    std::vector<ArenaRun> retired; // as those that pictures are of: given back some steps later
    int finished = 0, givenUp = 0, sparseMoves = 0;
    const auto moveDown = [&](std::size_t i) {
        if (!arena.isEvacuating() || !arena.reachesAbove(runs[i]))
            return;
        const auto moved = arena.takeBelow(runs[i]);
        if (!moved) {
            ++givenUp;
            return;
        }
        ASSERT_EQ(moved->capacity, runs[i].capacity);
        ASSERT_FALSE(arena.reachesAbove(*moved));
        ASSERT_EQ(moved->begin >> 14, (moved->begin + moved->capacity - 1) >> 14) << "inside one chunk";
        std::copy_n(arena.at(runs[i].begin), runs[i].capacity, arena.at(moved->begin));
        retired.push_back(std::exchange(runs[i], *moved));
    };
    const auto releaseRetired = [&](std::size_t most) {
        for (; retired.size() > most; retired.pop_back())
            arena.release(retired.back());
    };
    const auto finish = [&] {
        const std::uint64_t top = arena.top();
        const bool wasEvacuating = arena.isEvacuating();
        arena.finishEvacuation();
        if (!wasEvacuating || arena.isEvacuating())
            return;
        ++finished;
        ASSERT_LT(arena.top(), top);
    };
    for (int phase = 0; phase < 60; ++phase) {
        const std::size_t most = phase % 2 == 0 ? runs.size() : runs.size() / (2 + random() % 8);
        for (int step = 0; step < 1000; ++step) {
            const std::size_t i = random() % runs.size();
            if (i >= most) {
                arena.release(runs[i]);
            } else {
                arena.resize(runs[i], 1 + random() % (random() % 16 == 0 ? 900 : 300));
                std::fill_n(arena.at(runs[i].begin), runs[i].capacity, static_cast<std::uint32_t>(i));
            }
            sparseMoves = arena.isSparse(3, 4) ? sparseMoves + 1 : 0;
            if (!arena.isEvacuating() && sparseMoves >= 8)
                arena.evacuate();
            for (int k = 0; k < 8; ++k)
                ASSERT_NO_FATAL_FAILURE(moveDown(random() % runs.size()));
            releaseRetired(step % 7 == 0 ? 0 : 20);
            ASSERT_NO_FATAL_FAILURE(finish());
        }
        for (int round = 0; round < 4; ++round) {
            if (!arena.isEvacuating() && arena.isSparse(3, 4))
                arena.evacuate();
            for (std::size_t i = 0; i < runs.size(); ++i)
                ASSERT_NO_FATAL_FAILURE(moveDown(i));
            releaseRetired(0);
            ASSERT_NO_FATAL_FAILURE(finish());
        }
        std::uint64_t used = 0;
        for (std::size_t i = 0; i < runs.size(); ++i) {
            used += runs[i].capacity;
            ASSERT_LE(std::uint64_t{runs[i].begin} + runs[i].capacity, arena.top());
            for (std::uint32_t k = 0; k < runs[i].capacity; ++k)
                ASSERT_EQ(*arena.at(runs[i].begin + k), i);
        }
        ASSERT_EQ(arena.unusedBytes(), (arena.top() - used) * sizeof(std::uint32_t));
    }
    EXPECT_GT(finished, 30);
    EXPECT_GT(givenUp, 0);
    EXPECT_LT(givenUp, finished);
}

TEST(RunArena, GivesMemoryBackInsideAChunk) {
    RunArena<std::uint32_t, 1024, 24> arena; // one chunk of 64 MB
    std::vector<ArenaRun> runs(1u << 14);
    for (std::size_t i = 0; i < runs.size(); ++i) {
        arena.resize(runs[i], 1024);
        std::fill_n(arena.at(runs[i].begin), 1024, static_cast<std::uint32_t>(i));
    }
    for (std::size_t i = 0; i < runs.size(); ++i)
        if (i % 16 != 7)
            arena.release(runs[i]);
    const std::uint64_t before = residentBytes();
    arena.evacuate();
    for (std::size_t i = 7; i < runs.size(); i += 16)
        if (arena.reachesAbove(runs[i])) {
            const ArenaRun moved = arena.takeBelow(runs[i]).value();
            std::copy_n(arena.at(runs[i].begin), moved.capacity, arena.at(moved.begin));
            arena.release(runs[i]);
            runs[i] = moved;
        }
    ASSERT_TRUE(arena.finishEvacuation());
    EXPECT_LT(arena.top(), (1u << 24) / 12);
    EXPECT_LT(residentBytes() + (std::uint64_t{50} << 20), before);
    ArenaRun again;
    arena.resize(again, 1024);
    for (std::size_t i = 7; i < runs.size(); i += 16) {
        ASSERT_EQ(*arena.at(runs[i].begin), i);
        ASSERT_EQ(*arena.at(runs[i].begin + 1023), i);
    }
}

// Where there is no room below, the array is as long as it was, and what was set aside serves again.
TEST(RunArena, GivesUpBeingEmptiedWithoutRoomBelow) {
    for (const bool isTakenByOwner : {true, false}) {
        Arena arena;
        std::vector<ArenaRun> small(512), large(4);
        for (ArenaRun& run : small)
            arena.resize(run, 16);
        for (ArenaRun& run : large)
            arena.resize(run, 2000);
        for (std::size_t i = 0; i < small.size(); ++i)
            if (i % 2 == 0)
                arena.release(small[i]); // room enough, but in pieces
        const std::uint64_t top = arena.top();
        arena.evacuate();
        ASSERT_TRUE(arena.isEvacuating());
        ASSERT_TRUE(arena.reachesAbove(large[3]));
        if (isTakenByOwner) {
            EXPECT_EQ(arena.takeBelow(large[3]), std::nullopt);
        } else { // a part of it is above
            arena.release(large[3]);
            arena.resize(large[3], 2000);
        }
        EXPECT_FALSE(arena.isEvacuating());
        arena.finishEvacuation();
        EXPECT_EQ(arena.top(), top);
        arena.release(large[3]);
        arena.resize(large[3], 2000);
        EXPECT_EQ(arena.top(), top);
    }
}

// Small runs fill two chunks; then larger ones take their places, as far as what is kept between them lets them.
TEST(RunArena, JoinsAdjacentFreeRuns) {
    Arena arena;
    constexpr std::size_t kSmall = 2 * 4096 / 16;
    std::vector<ArenaRun> small(kSmall);
    for (ArenaRun& run : small)
        arena.resize(run, 16);
    const std::uint64_t full = arena.top();
    ASSERT_EQ(full, 2u * 4096);
    const auto isKept = [](std::size_t i) { return i % 32 == 5; }; // else 31 are adjacent
    for (std::size_t i = 0; i < kSmall; ++i) {
        std::fill_n(arena.at(small[i].begin), 16, 0xffffu);
        if (!isKept(i))
            arena.release(small[i]);
    }
    std::vector<ArenaRun> large;
    for (std::size_t k = 0; k < kSmall / 32 - 2; ++k) { // between 16 kept ones, but where chunks meet
        ArenaRun& run = large.emplace_back();
        arena.resize(run, 31 * 16);
        std::fill_n(arena.at(run.begin), run.capacity, static_cast<std::uint32_t>(k));
        EXPECT_EQ(run.begin >> 12, (run.begin + run.capacity - 1) >> 12) << "inside one chunk";
    }
    EXPECT_EQ(arena.top(), full);
    for (std::size_t i = 0; i < kSmall; ++i)
        for (std::uint32_t e = 0; isKept(i) && e < 16; ++e)
            ASSERT_EQ(*arena.at(small[i].begin + e), 0xffffu);
    for (std::size_t k = 0; k < large.size(); ++k)
        for (std::uint32_t e = 0; e < large[k].capacity; ++e)
            ASSERT_EQ(*arena.at(large[k].begin + e), k);
    for (ArenaRun& run : small)
        arena.release(run);
    for (ArenaRun& run : large)
        arena.release(run);
    std::array<ArenaRun, 2> whole;
    for (ArenaRun& run : whole)
        arena.resize(run, 4096);
    EXPECT_EQ(arena.top(), full) << "each fills a chunk";
    EXPECT_EQ(arena.unusedBytes(), 0u);
    arena.release(whole[0].begin < whole[1].begin ? whole[0] : whole[1]);
    for (std::size_t k = 0; k < 4096 / 64; ++k)
        arena.resize(small[k], 64);
    EXPECT_EQ(arena.top(), full) << "what is left of a run stays free";
    EXPECT_EQ(arena.unusedBytes(), 0u);
}

// As in a slide through a surface whose bricks grow and shrink: not much more memory than the most that was used.
TEST(RunArena, GrowsLittleBeyondWhatIsUsed) {
    std::mt19937 random(13);
    ShortArena arena;
    std::vector<ArenaRun> runs(4000);
    std::uint64_t mostUsed = 0;
    for (int move = 0; move < 60; ++move) {
        const auto typical = static_cast<std::uint32_t>(400 + 300 * std::sin(0.4 * move));
        for (std::size_t i = 0; i < runs.size(); ++i)
            if (random() % 3 != 0)
                arena.resize(runs[i], typical / 2 + static_cast<std::uint32_t>(random() % typical));
        mostUsed = std::max(mostUsed, arena.top() - arena.unusedBytes() / sizeof(std::uint16_t));
    }
    EXPECT_LT(4 * arena.top(), 5 * mostUsed);
}

TEST(EdgeRecord, GivesThePlaceOfAVertexInsideACellBack) {
    const glm::vec3 place(1.25f, 7.0009765625f, 0.1f);
    const auto record = EdgeRecord<float>::inside({place, encodeNormal({0.0f, 1.0f, 0.0f}), 0});
    EXPECT_TRUE(record.isInside());
    EXPECT_EQ(record.insidePlace(), place);
    const MeshVertex vertex = vertexOf(record, {8, 16, 24}, 5.0f);
    EXPECT_EQ(vertex.position, glm::vec3(8.0f, 16.0f, 24.0f) + place);
    EXPECT_EQ(vertex.normal, glm::vec3(0.0f, 1.0f, 0.0f));
    const auto precise = EdgeRecord<double>::inside({place, 0, 0});
    EXPECT_EQ(precise.insidePlace(), place);
}

// From first principles: on the line, exactly at the end where the isovalue is that end's scalar, never outside.
TEST(EdgeRecord, PlacesAVertexWhereTheLineCrossesTheIsovalue) {
    EdgeRecord<float> record{closedEdge(1, closedPoint(3, 4, 5)), 0, 0, 0, 10.0f, 20.0f};
    EXPECT_EQ(vertexOf(record, {8, 8, 8}, 12.5f).position, glm::vec3(11.0f, 12.25f, 13.0f));
    EXPECT_EQ(vertexOf(record, {8, 8, 8}, 10.0f).position, glm::vec3(11.0f, 12.0f, 13.0f));
    EXPECT_EQ(vertexOf(record, {8, 8, 8}, 20.0f).position, glm::vec3(11.0f, 13.0f, 13.0f));
    constexpr float kMax = std::numeric_limits<float>::max();
    record.scalar1 = -kMax;
    record.scalar2 = kMax;
    EXPECT_EQ(vertexOf(record, {0, 0, 0}, 0.0f).position, glm::vec3(3.0f, 4.5f, 5.0f));
    record.scalar1 = 0.0f;
    record.scalar2 = std::numeric_limits<float>::denorm_min();
    const float y = vertexOf(record, {0, 0, 0}, record.scalar2).position.y;
    EXPECT_GE(y, 4.0f);
    EXPECT_LE(y, 5.0f);
}

// From where the leaf edge begins, over its whole length, whichever of its edges is active.
TEST(EdgeRecord, PlacesAVertexOnALeafEdge) {
    for (const int y : {4, 5, 6, 7}) {
        const EdgeRecord<float> record{closedEdge(1, closedPoint(3, y, 5)), 2, 0, 0, 10.0f, 20.0f};
        EXPECT_EQ(vertexOf(record, {8, 8, 8}, 12.5f).position, glm::vec3(11.0f, 13.0f, 13.0f));
    }
}

// Flat at both ends, and normals that cancel: along the edge, towards lower scalars.
TEST(EdgeRecord, HasANormalWhereTheEndsHaveNone) {
    const NormalCode up = encodeNormal({1.0f, 0.0f, 0.0f}), down = encodeNormal({-1.0f, 0.0f, 0.0f});
    for (int axis = 0; axis < 3; ++axis)
        for (const auto& [first, second] : {std::pair{kNoNormal, kNoNormal}, std::pair{up, down}}) {
            glm::vec3 expected(0.0f);
            expected[axis] = -1.0f;
            EXPECT_EQ(edgeNormal(first, second, 0.5f, axis, true), expected);
            EXPECT_EQ(edgeNormal(first, second, 0.5f, axis, false), -expected);
        }
    EXPECT_EQ(edgeNormal(up, kNoNormal, 0.5f, 1, true).y, 0.0f);
    EXPECT_NEAR(edgeNormal(up, kNoNormal, 0.5f, 1, true).x, 1.0f, 1e-6f);
}

} // namespace
} // namespace isoslider::extract
