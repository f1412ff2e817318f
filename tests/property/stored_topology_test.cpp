// What is added to an index behind it in its file, whole, cut off, damaged, and on failing disks.

#include "core/topology/stored_topology.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/byte_codec.h"
#include "core/index/index_appendix.h"
#include "core/index/index_reader.h"
#include "core/topology/index_topology.h"
#include "core/topology/topology_queries.h"
#include "tests/property/test_volumes.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::topology {
namespace {

namespace fs = std::filesystem;
using test::HasError;
using test::IsOk;
using Bytes = std::vector<char>;

std::shared_ptr<const ScalarGrid> noise(const GridDims& dims, ScalarType type, unsigned seed) {
    GridGeometry geometry;
    geometry.dims = dims;
    std::mt19937 random(seed);
    return visitScalarType(type, [&](auto sample) {
        using Sample = decltype(sample);
        std::vector<Sample> samples(static_cast<std::size_t>(pointCount(dims)));
        for (Sample& each : samples)
            each = static_cast<Sample>(std::uniform_real_distribution<double>(-100.0, 100.0)(random));
        return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<Sample>(geometry, type, samples));
    });
}

Bytes readFile(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
void writeFile(const fs::path& path, const Bytes& bytes) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

std::vector<TopologyEvent> eventsOf(const TopologySummary& summary) {
    std::vector<TopologyEvent> events;
    EXPECT_THAT(summary.visitEvents([&](const TopologyEvent& event) {
        events.push_back(event);
        return true;
    }),
                IsOk());
    return events;
}

// A directory of one page, as FORMAT.md has it.
std::vector<std::byte> directoryOf(std::uint32_t pageBytes, std::uint32_t events) {
    std::vector<std::byte> directory;
    ByteWriter out(directory);
    out.put<std::uint32_t>(1);
    out.put<std::uint8_t>(1);
    out.put<std::uint64_t>(1);
    for (int field = 0; field < 3; ++field) // isovalue, offset, checksum
        out.put<std::uint64_t>(0);
    out.put<std::uint32_t>(pageBytes);
    out.put<std::uint32_t>(events);
    for (int count = 0; count < 4; ++count)
        out.put<std::uint64_t>(0);
    out.put<std::uint32_t>(0);
    return directory;
}

void expectSame(const TopologySummary& stored, const TopologySummary& made) {
    EXPECT_EQ(stored.eventCount(), made.eventCount());
    EXPECT_EQ(stored.areCountsExact(), made.areCountsExact());
    EXPECT_EQ(stored.hasEvents(), made.hasEvents());
    const auto found = eventsOf(stored), expected = eventsOf(made);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        ASSERT_EQ(found[i].isovalue, expected[i].isovalue);
        ASSERT_EQ(found[i].kind, expected[i].kind);
        ASSERT_EQ(found[i].position, expected[i].position);
        ASSERT_EQ(found[i].below, expected[i].below);
        ASSERT_EQ(found[i].above, expected[i].above);
        ASSERT_EQ(found[i].pieces, expected[i].pieces);
        ASSERT_EQ(found[i].persistence, expected[i].persistence);
    }
    ASSERT_EQ(stored.curves().isovalues, made.curves().isovalues);
    for (std::size_t i = 0; i < made.curves().measures.size(); ++i)
        ASSERT_EQ(stored.curves().measures[i].area, made.curves().measures[i].area);
}

class StoredTopologyTest : public testing::Test {
protected:
    void build(const std::shared_ptr<const ScalarGrid>& grid) {
        preprocess::BuildOptions options;
        options.kind = index::IndexKind::Metacells;
        ASSERT_THAT(test::buildIndexOf(grid, path_, options), IsOk());
        bare_ = readFile(path_);
    }
    std::unique_ptr<index::IndexReader> reader() {
        auto opened = index::IndexReader::open(path_);
        EXPECT_THAT(opened, IsOk());
        return std::move(opened).value();
    }
    TopologyCurve analysed(const ScalarGrid& grid) {
        AnalysisOptions options;
        options.measures = planMeasures(grid);
        auto curve = analyseTopology(planesOf(grid), options);
        EXPECT_THAT(curve, IsOk());
        return std::move(curve).value();
    }

    test::TemporaryFolder folder_;
    fs::path path_ = folder_ / "a.isx";
    Bytes bare_; ///< the index before anything was added
};

/// Events from an isovalue on: at events, beside them and beyond them all.
void expectSameFrom(const TopologySummary& stored, const TopologyCurve& curve) {
    std::vector<double> starts{-1e9, 1e9};
    const std::vector<TopologyEvent> events = curve.events();
    for (std::size_t i = 0; i < events.size(); i += 31) {
        starts.push_back(events[i].isovalue);
        starts.push_back(std::nextafter(events[i].isovalue, 1e9));
    }
    for (const double start : starts) {
        std::vector<double> expected, found;
        const auto visitInto = [](std::vector<double>& isovalues) {
            return [&isovalues](const TopologyEvent& event) {
                isovalues.push_back(event.isovalue);
                return isovalues.size() < 1500; // more than a page
            };
        };
        ASSERT_THAT(curve.visitEventsFrom(start, visitInto(expected)), IsOk());
        ASSERT_THAT(stored.visitEventsFrom(start, visitInto(found)), IsOk());
        ASSERT_EQ(found, expected) << start;
    }
}

TEST_F(StoredTopologyTest, IsReadAsItWasMade) {
    for (const ScalarType type : {ScalarType::U8, ScalarType::I16, ScalarType::F32, ScalarType::F64}) {
        const auto grid = noise({17, 16, 18}, type, 7);
        build(grid);
        ASSERT_THAT(openTopology(path_), IsOk());
        EXPECT_EQ(openTopology(path_).value(), nullptr) << "there is none yet";
        const TopologyCurve curve = analysed(*grid);
        ASSERT_THAT(storeTopology(*reader(), curve), IsOk());
        const auto stored = openTopology(path_);
        ASSERT_THAT(stored, IsOk());
        ASSERT_NE(stored.value(), nullptr);
        expectSame(*stored.value(), curve);
        if (type == ScalarType::F32) {
            EXPECT_GT(curve.eventCount(), 3000u) << "several pages";
        }
        std::mt19937 random(3);
        for (int i = 0; i < 500; ++i) {
            const double isovalue = std::uniform_real_distribution<double>(-110.0, 110.0)(random);
            ASSERT_EQ(stored.value()->at(isovalue).value(), curve.countsAt(isovalue)) << isovalue;
        }
        for (const TopologyEvent& event : curve.events())
            ASSERT_EQ(stored.value()->at(event.isovalue).value(), event.below);
        expectSameFrom(*stored.value(), curve);
        // The index itself is as it was.
        const Bytes now = readFile(path_);
        EXPECT_TRUE(std::equal(bare_.begin(), bare_.end(), now.begin()));
        EXPECT_THAT(index::IndexReader::open(path_), IsOk());
    }
}

TEST_F(StoredTopologyTest, OfCountsWithoutEventsHasNone) {
    const auto grid = noise({30, 30, 60}, ScalarType::F32, 7);
    build(grid);
    AnalysisOptions options;
    options.measures = planMeasures(*grid);
    options.memoryBytes = 4 << 20;
    const auto counts = analyseTopology(planesOf(*grid), options);
    ASSERT_THAT(counts, IsOk());
    ASSERT_FALSE(counts.value().hasEvents());
    ASSERT_THAT(storeTopology(*reader(), counts.value()), IsOk());
    const auto stored = openTopology(path_);
    ASSERT_THAT(stored, IsOk());
    ASSERT_NE(stored.value(), nullptr);
    EXPECT_FALSE(stored.value()->hasEvents());
    expectSame(*stored.value(), counts.value());
    EXPECT_TRUE(stored.value()->mostNotable(5).value().empty());
}

// FORMAT.md, "Limits": looked at when the directory is opened, before a page is read.
TEST_F(StoredTopologyTest, IsRefusedOnePastItsLimits) {
    build(noise({5, 5, 5}, ScalarType::U8, 1));
    constexpr std::uint32_t kMostBytes = 1u << 20, kMostEvents = 1024;
    const auto body = [](std::size_t) { return std::vector<std::byte>(kMostBytes + 1); };
    const auto open = [&](std::uint32_t pageBytes, std::uint32_t events) {
        EXPECT_THAT(index::writeAppendix(*reader(), 1, body, directoryOf(pageBytes, events), true), IsOk());
        return openTopology(path_);
    };
    const auto atLimit = open(kMostBytes, kMostEvents);
    ASSERT_THAT(atLimit, IsOk());
    ASSERT_NE(atLimit.value(), nullptr);
    EXPECT_EQ(atLimit.value()->eventCount(), kMostEvents);
    EXPECT_THAT(open(kMostBytes + 1, kMostEvents), HasError(ErrorCode::Corruption));
    EXPECT_THAT(open(kMostBytes, kMostEvents + 1), HasError(ErrorCode::Corruption));
    EXPECT_THAT(open(kMostBytes, 0), HasError(ErrorCode::Corruption));
}

TEST_F(StoredTopologyTest, IsMadeOfTheIndexAsOfTheVolume) {
    for (const GridDims& dims : {GridDims{5, 7, 2}, GridDims{33, 18, 16}, GridDims{16, 17, 17}, GridDims{18, 20, 49}}) {
        const auto grid = noise(dims, ScalarType::F32, 11);
        build(grid);
        const auto found = topologyOfIndex(path_, {}, {});
        ASSERT_THAT(found, IsOk());
        EXPECT_THAT(found.value().storing, IsOk());
        EXPECT_EQ(eventsOf(*found.value().summary).size(), analysed(*grid).eventCount());
        const auto again = topologyOfIndex(path_, {}, {});
        ASSERT_THAT(again, IsOk());
        expectSame(*again.value().summary, *found.value().summary);
    }
}

// A program that is killed leaves the index, and what was added or nothing.
TEST_F(StoredTopologyTest, CutOffAnywhereIsNone) {
    const auto grid = noise({16, 16, 16}, ScalarType::F32, 5);
    build(grid);
    ASSERT_THAT(storeTopology(*reader(), analysed(*grid)), IsOk());
    const Bytes whole = readFile(path_);
    for (std::size_t size = bare_.size(); size < whole.size(); size += 1 + (whole.size() - bare_.size()) / 97) {
        writeFile(path_, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
        const auto stored = openTopology(path_);
        if (size > bare_.size() && size < bare_.size() + 64) { // a header is written whole: this was not us
            EXPECT_THAT(stored, HasError(ErrorCode::Corruption)) << size;
            continue;
        }
        ASSERT_THAT(stored, IsOk()) << size;
        EXPECT_EQ(stored.value(), nullptr) << size;
        EXPECT_THAT(index::IndexReader::open(path_), IsOk());
    }
    writeFile(path_, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(bare_.size()) - 1});
    EXPECT_THAT(openTopology(path_), HasError(ErrorCode::Corruption)) << "not even an index";
    // Zeros are one that was not finished, but fewer than a header has are not ours.
    for (const std::size_t zeros : {1u, 63u, 64u, 1000u}) {
        Bytes unfinished = bare_;
        unfinished.resize(bare_.size() + zeros, '\0');
        writeFile(path_, unfinished);
        const auto stored = openTopology(path_);
        EXPECT_EQ(stored.isOk(), zeros >= 64) << zeros;
        if (stored.isOk()) {
            EXPECT_EQ(stored.value(), nullptr);
        }
    }
    // What is left over is replaced.
    writeFile(path_, {whole.begin(), whole.end() - 10});
    ASSERT_THAT(storeTopology(*reader(), analysed(*grid)), IsOk());
    EXPECT_EQ(readFile(path_), whole);
}

TEST_F(StoredTopologyTest, DamagedIsNeverTakenForAnother) {
    const auto grid = noise({16, 16, 16}, ScalarType::F32, 5);
    build(grid);
    const TopologyCurve curve = analysed(*grid);
    const std::vector<TopologyEvent> events = curve.events();
    ASSERT_THAT(storeTopology(*reader(), curve), IsOk());
    const Bytes whole = readFile(path_);
    const std::size_t size = bare_.size();
    int refused = 0, none = 0;
    for (std::size_t at = bare_.size(); at < whole.size(); at += 1 + (whole.size() - bare_.size()) / 331) {
        Bytes damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
        writeFile(path_, damaged);
        const auto stored = openTopology(path_);
        if (at < bare_.size() + 8) { // its name
            EXPECT_THAT(stored, HasError(ErrorCode::Corruption));
            continue;
        }
        ASSERT_THAT(stored, IsOk());
        if (stored.value() == nullptr) {
            ++none;
            continue;
        }
        std::size_t seen = 0;
        const Status status = stored.value()->visitEvents([&](const TopologyEvent& event) {
            EXPECT_EQ(event.isovalue, events[seen++].isovalue);
            return true;
        });
        EXPECT_THAT(status, HasError(ErrorCode::Corruption)) << "byte " << at;
        ++refused;
    }
    EXPECT_GT(none, 10);
    EXPECT_GT(refused, 50);
    // Of another index: its seed differs.
    build(noise({16, 16, 16}, ScalarType::F32, 6));
    const auto added = whole.end() - static_cast<std::ptrdiff_t>(whole.size() - size);
    Bytes other = bare_;
    other.insert(other.end(), added, whole.end());
    writeFile(path_, other);
    ASSERT_THAT(openTopology(path_), IsOk());
    EXPECT_EQ(openTopology(path_).value(), nullptr);
}

TEST_F(StoredTopologyTest, LosesNothingOnAFailingDisk) {
    const auto grid = noise({12, 12, 12}, ScalarType::I16, 5);
    build(grid);
    const TopologyCurve curve = analysed(*grid);
    test::FaultyFileSystem counting(-1, 0);
    ASSERT_THAT(storeTopology(*reader(), curve, false, counting), IsOk());
    ASSERT_GT(counting.calls(), 5);
    for (int call = 0; call < counting.calls(); ++call) {
        writeFile(path_, bare_);
        test::FaultyFileSystem faulty(call, ENOSPC);
        EXPECT_THAT(storeTopology(*reader(), curve, false, faulty), HasError(ErrorCode::OutOfSpace)) << call;
        EXPECT_THAT(index::IndexReader::open(path_), IsOk()) << call;
        const Bytes now = readFile(path_);
        EXPECT_TRUE(std::equal(bare_.begin(), bare_.end(), now.begin()));
        const auto stored = openTopology(path_);
        ASSERT_THAT(stored, IsOk()) << call;
        if (stored.value() != nullptr) // all was written, but for what syncs and closes
            expectSame(*stored.value(), curve);
        ASSERT_THAT(storeTopology(*reader(), curve), IsOk()) << "the next time it works";
    }
}

TEST_F(StoredTopologyTest, IsAddedByOneProgramAtATime) {
    const auto grid = noise({8, 8, 8}, ScalarType::U8, 5);
    build(grid);
    {
        const auto first = defaultFileSystem().extend(path_, {}, bare_.size());
        ASSERT_THAT(first, IsOk());
        EXPECT_THAT(storeTopology(*reader(), analysed(*grid)), HasError(ErrorCode::InvalidArgument));
    }
    EXPECT_THAT(defaultFileSystem().extend(folder_ / "nowhere", {}, 0), HasError(ErrorCode::NotFound));
    EXPECT_THAT(defaultFileSystem().extend(path_, {}, bare_.size() + 1), HasError(ErrorCode::InvalidArgument));
}

// While one volume was analysed another index may have taken the name.
TEST_F(StoredTopologyTest, IsAddedToNoOtherIndex) {
    const auto grid = noise({12, 12, 12}, ScalarType::U8, 5);
    build(grid);
    const auto before = reader();
    build(noise({14, 14, 14}, ScalarType::U8, 6)); // renamed to the same name
    const Bytes other = readFile(path_);
    EXPECT_THAT(storeTopology(*before, analysed(*grid)), HasError(ErrorCode::InvalidArgument));
    EXPECT_EQ(readFile(path_), other);
}

TEST_F(StoredTopologyTest, StaysWhereItIsWhole) {
    const auto grid = noise({12, 12, 12}, ScalarType::U8, 5);
    build(grid);
    ASSERT_THAT(storeTopology(*reader(), analysed(*grid)), IsOk());
    const Bytes whole = readFile(path_);
    ASSERT_THAT(storeTopology(*reader(), TopologyCurve()), IsOk());
    EXPECT_EQ(readFile(path_), whole);
    ASSERT_THAT(storeTopology(*reader(), TopologyCurve(), true), IsOk());
    EXPECT_NE(readFile(path_), whole);
}

TEST_F(StoredTopologyTest, DamagedIsMadeAgain) {
    const auto grid = noise({12, 12, 12}, ScalarType::F32, 5);
    build(grid);
    const auto made = topologyOfIndex(path_, {}, {});
    ASSERT_THAT(made, IsOk());
    const auto events = eventsOf(*made.value().summary);
    const Bytes whole = readFile(path_);
    Bytes damaged = whole;
    damaged[bare_.size() + 500] = static_cast<char>(damaged[bare_.size() + 500] ^ 4);
    writeFile(path_, damaged);
    const auto again = topologyOfIndex(path_, {}, {});
    ASSERT_THAT(again, IsOk());
    EXPECT_EQ(eventsOf(*again.value().summary).size(), events.size());
    EXPECT_EQ(readFile(path_), whole);
}

// Counts without events were stored where memory was scarce, and the disk could not help.
TEST_F(StoredTopologyTest, EventsAreAddedWhereThereIsMemory) {
    const auto grid = noise({20, 20, 60}, ScalarType::F32, 5);
    build(grid);
    AnalysisOptions little;
    little.memoryBytes = 9 << 17;
    little.scratch = path_.parent_path() / "no folder" / "found"; // and nowhere to put it off to
    const auto counts = topologyOfIndex(path_, little, {});
    ASSERT_THAT(counts, IsOk());
    ASSERT_THAT(counts.value().storing, IsOk());
    EXPECT_FALSE(counts.value().summary->hasEvents());
    EXPECT_TRUE(counts.value().isNew) << "there is no use in trying again at once";
    EXPECT_FALSE(topologyOfIndex(path_, little, {}).value().isNew);
    const Bytes before = readFile(path_);
    EXPECT_THAT(addEvents(path_, little, {}), HasError(ErrorCode::OutOfSpace));
    EXPECT_EQ(readFile(path_), before) << "what is stored stays";
    const auto added = addEvents(path_, {}, {});
    ASSERT_THAT(added, IsOk());
    EXPECT_THAT(added.value().storing, IsOk());
    const auto again = topologyOfIndex(path_, little, {});
    ASSERT_THAT(again, IsOk());
    EXPECT_TRUE(again.value().summary->hasEvents());
    EXPECT_EQ(eventsOf(*again.value().summary).size(), analysed(*grid).eventCount());
    EXPECT_GT(analysed(*grid).eventCount(), 1000u);
}

// Ranges beyond doubles and below them.
TEST_F(StoredTopologyTest, HoldsTheEndsOfDoubles) {
    for (const double scale : {1.7e308, 5e-324, 1e300, 1e-310}) {
        GridGeometry geometry;
        geometry.dims = {6, 6, 6};
        std::mt19937 random(9);
        std::vector<double> samples(216);
        for (double& sample : samples)
            sample = scale * (static_cast<double>(random() % 3) - 1.0);
        const auto grid =
            std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<double>(geometry, ScalarType::F64, samples));
        build(grid);
        const auto made = topologyOfIndex(path_, {}, {});
        ASSERT_THAT(made, IsOk());
        ASSERT_THAT(made.value().storing, IsOk());
        const Bytes whole = readFile(path_);
        const auto again = topologyOfIndex(path_, {}, {});
        ASSERT_THAT(again, IsOk());
        EXPECT_EQ(readFile(path_), whole) << "not made again";
        EXPECT_GT(again.value().summary->eventCount(), 0u);
        const auto suggestions = suggestIsovalues(*again.value().summary);
        ASSERT_THAT(suggestions, IsOk());
        for (const Suggestion& suggestion : suggestions.value())
            EXPECT_TRUE(std::isfinite(suggestion.isovalue));
    }
}

TEST(AnalysisLimits, AreKept) {
    const auto grid = noise({24, 24, 24}, ScalarType::F32, 5);
    AnalysisOptions options;
    options.memoryBytes = 100'000;
    EXPECT_THAT(analyseTopology(planesOf(*grid), options), HasError(ErrorCode::OutOfSpace));
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_THAT(analyseTopology(planesOf(*grid), {}, job), HasError(ErrorCode::Cancelled));
    PlaneSource broken = planesOf(*grid);
    broken.read = [inner = broken.read](std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) -> Status {
        if (zEnd > 10)
            return makeError(ErrorCode::IoError, "cannot read");
        return inner(zBegin, zEnd, out);
    };
    options = {};
    options.planesAtOnce = 4;
    EXPECT_THAT(analyseTopology(broken, options), HasError(ErrorCode::IoError));
}

} // namespace
} // namespace isoslider::topology
