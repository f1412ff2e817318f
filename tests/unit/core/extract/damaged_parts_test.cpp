// What lies around a damaged part of an index stays usable: each part of a small index is damaged in turn, and every
// isovalue that does not need it gives the same surface as before.

#include <algorithm>
#include <fstream>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "core/cell/cell_numbering.h"
#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/grid/scalar_key.h"
#include "core/index/index_places.h"
#include "core/index/sample_store.h"
#include "core/index/validation/index_validation.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using index::IndexKind;
using test::HasError;
using test::IsOk;

constexpr GridDims kDims = {23, 17, 19};
constexpr unsigned kValues = 60;

struct Case {
    IndexKind kind;
    double mergeError; ///< in percent of the values
};

/// A stretch of the file, and whether the surface at an isovalue cannot be found without it.
struct Part {
    std::string name;
    std::uint64_t offset = 0, bytes = 0;
    std::function<bool(double isovalue)> isNeeded;
};

class DamagedParts : public testing::TestWithParam<Case> {
protected:
    void SetUp() override {
        preprocess::BuildOptions options;
        options.kind = GetParam().kind;
        options.redundancyThreshold = 0.3;
        options.mergeError.amount = GetParam().mergeError;
        ASSERT_THAT(test::buildIndexOf(grid_, path_, options), IsOk());
        for (unsigned value = 0; value <= kValues; value += 2)
            isovalues_.push_back(value);
        isovalues_.push_back(17.5);
        auto engine = open(path_);
        for (const double isovalue : isovalues_)
            whole_.push_back(surface(*engine, isovalue).value());
    }

    static std::unique_ptr<SlideEngine> open(const std::filesystem::path& path) {
        auto engine = SlideEngine::open(path);
        EXPECT_THAT(engine, IsOk());
        return std::move(engine).value();
    }
    static Result<SurfaceMesh> surface(SlideEngine& engine, double isovalue) {
        if (auto stats = engine.slideTo(isovalue); !stats.isOk())
            return stats.error();
        return engine.mesh();
    }

    // The pages of all levels, of which none is needed: samples say the same.
    void addPages(const index::IndexReader& reader) {
        for (std::size_t level = 0; level < reader.meta().levels.size(); ++level)
            for (const index::PageEntry& page : reader.meta().levels[level].pages)
                parts_.push_back(
                    {"level " + std::to_string(level), page.offset, page.bytes, [](double) { return false; }});
    }
    // Chunks and the tables of their groups, needed where a brick is active that has points there, or beside.
    void addChunks(const index::IndexReader& reader) {
        constexpr int kApron = 1;
        const index::SampleStore store(reader);
        const index::ChunkGroupEntry& group = reader.meta().chunkGroups.at(0);
        for (const index::ChunkIndex chunk : firstIds<index::ChunkIndex>(store.chunks().chunkCount())) {
            std::uint64_t read = 0;
            const auto place = store.find(chunk, read).value();
            const auto coords = store.chunks().chunkCoords(chunk);
            parts_.push_back({"chunk", place.offset, place.bytes, [this, coords](double at) {
                                  return anyActiveBrick(
                                      [&](const std::array<std::int64_t, 3>& brick) {
                                          for (std::size_t a = 0; a < 3; ++a)
                                              if (const std::int64_t first = 8 * brick[a] - kApron,
                                                  last = 8 * brick[a] + 8 + kApron;
                                                  last < 16 * coords[a] || first >= 16 * (coords[a] + 1))
                                                  return false;
                                          return true;
                                      },
                                      at);
                              }});
        }
        parts_.push_back({"chunk group", group.offset + group.chunkBytes, 1,
                          [this](double at) { return anyActiveBrick([](const auto&) { return true; }, at); }});
    }

    template <class Which>
    bool anyActiveBrick(const Which& which, double isovalue) const {
        const BrickGrid bricks(kDims);
        for (const BrickIndex brick : firstIds<BrickIndex>(bricks.brickCount())) {
            const auto at = bricks.brickCoords(brick);
            bool isAnyAbove = false, isAnyBelow = false;
            for (std::int64_t z = 8 * at[2]; z < std::min(kDims[2], 8 * at[2] + 9); ++z)
                for (std::int64_t y = 8 * at[1]; y < std::min(kDims[1], 8 * at[1] + 9); ++y)
                    for (std::int64_t x = 8 * at[0]; x < std::min(kDims[0], 8 * at[0] + 9); ++x)
                        (grid_->valueAt(x, y, z) >= isovalue ? isAnyAbove : isAnyBelow) = true;
            if (isAnyAbove && isAnyBelow && which(at))
                return true;
        }
        return false;
    }

    void findParts() {
        const auto reader = index::IndexReader::open(path_);
        ASSERT_THAT(reader, IsOk());
        ASSERT_GE(reader.value()->meta().levels.size(), 2u);
        addPages(*reader.value());
        addChunks(*reader.value());
        std::vector<Part> some;
        for (std::size_t i = 0; i < parts_.size(); i += test::kSparser)
            some.push_back(parts_[i]);
        parts_ = std::move(some);
    }
    void write(const std::string& bytes) const { std::ofstream(folder_ / "damaged.isx", std::ios::binary) << bytes; }
    std::filesystem::path damaged(const Part& part) const {
        std::string bytes = test::readText(path_);
        bytes[part.offset + part.bytes / 2] ^= 0x10;
        write(bytes);
        return folder_ / "damaged.isx";
    }

    const test::TemporaryFolder folder_;
    const std::filesystem::path path_ = folder_ / "whole.isx";
    /// Slopes with some noise: not every brick is active at every isovalue.
    const std::shared_ptr<const ScalarGrid> grid_ = [] {
        GridGeometry geometry;
        geometry.dims = kDims;
        std::mt19937 random(5);
        return test::makeVolume<std::uint8_t>(
            ScalarType::U8, geometry, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
                return std::min<std::int64_t>(kValues, x + y + z / 2 + static_cast<std::int64_t>(random() % 14));
            });
    }();
    std::vector<double> isovalues_;
    std::vector<SurfaceMesh> whole_;
    std::vector<Part> parts_;
};

// What a refusal says of the one fault of an index, in the words of its validation.
std::string nameOfFault(const std::filesystem::path& path) {
    const auto report = index::validateIndex(path);
    EXPECT_THAT(report, IsOk());
    EXPECT_EQ(report.value().faultCount, 1u);
    const index::IndexFault& fault = report.value().faults.at(0);
    EXPECT_NE(fault.isovalues.has_value(), fault.box.has_value());
    return path.string() + ": " + fault.part + " (" +
           (fault.isovalues ? index::textOf(*fault.isovalues) : index::textOf(*fault.box)) + ") " + fault.problem +
           " (at byte " + std::to_string(*fault.offset) + ")";
}

TEST_P(DamagedParts, LeaveEveryIsovalueThatDoesNotNeedThemAndAreNamed) {
    findParts();
    for (const Part& part : parts_) {
        const std::filesystem::path path = damaged(part);
        const std::string name = nameOfFault(path);
        for (std::size_t i = 0; i < isovalues_.size(); ++i) {
            SCOPED_TRACE(part.name + " at byte " + std::to_string(part.offset) + ", isovalue " +
                         std::to_string(isovalues_[i]));
            const auto found = surface(*open(path), isovalues_[i]);
            if (part.isNeeded(isovalues_[i])) {
                ASSERT_THAT(found, HasError(ErrorCode::Corruption));
                ASSERT_EQ(found.error().line(), name);
            } else {
                ASSERT_THAT(found, IsOk());
                ASSERT_TRUE(test::isSameSurface(found.value(), whole_[i]));
            }
        }
    }
}

// One engine that goes on after it was refused something.
TEST_P(DamagedParts, LeaveSlidesOverThem) {
    findParts();
    std::mt19937 random(11);
    std::vector<std::size_t> order(2 * isovalues_.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i % isovalues_.size();
    for (const Part& part : parts_) {
        const auto engine = open(damaged(part));
        std::shuffle(order.begin(), order.end(), random);
        for (const std::size_t i : order) {
            SCOPED_TRACE(part.name + " at byte " + std::to_string(part.offset) + ", isovalue " +
                         std::to_string(isovalues_[i]));
            const auto found = surface(*engine, isovalues_[i]);
            ASSERT_TRUE(found.isOk() || part.isNeeded(isovalues_[i])) << found.error().line();
            if (found.isOk()) {
                ASSERT_TRUE(test::isSameSurface(found.value(), whole_[i]));
            }
        }
    }
}

// All levels above the first are worth nothing, and the first gives everything.
TEST_P(DamagedParts, LeaveTheFirstLevel) {
    const auto reader = index::IndexReader::open(path_);
    ASSERT_THAT(reader, IsOk());
    std::string bytes = test::readText(path_);
    for (std::size_t level = 1; level < reader.value()->meta().levels.size(); ++level)
        for (const index::PageEntry& page : reader.value()->meta().levels[level].pages)
            bytes[page.offset + page.bytes / 2] ^= 0x10;
    write(bytes);
    const auto sliding = open(folder_ / "damaged.isx");
    for (std::size_t i = 0; i < isovalues_.size(); ++i) {
        const auto fresh = open(folder_ / "damaged.isx");
        for (SlideEngine* engine : {sliding.get(), fresh.get()}) {
            const auto found = surface(*engine, isovalues_[i]);
            ASSERT_THAT(found, IsOk()) << isovalues_[i];
            ASSERT_TRUE(test::isSameSurface(found.value(), whole_[i])) << isovalues_[i];
        }
    }
}

// Samples say what pages of the list say: with any of several pages of level 0 damaged all isovalues are found, from
// each other and from nothing. All samples are read only where there is damage on either side.
TEST(DamagedPages, OfAnIndexWithSamplesCostTimeOnly) {
    GridGeometry geometry;
    geometry.dims = {65, 330, 330}; // 8 x 42 x 42 bricks, each twice in the list
    std::mt19937 random(8);
    std::uniform_real_distribution<float> noise(0.0f, 2.0f);
    const auto grid = test::makeVolume<float>(ScalarType::F32, geometry, [&](auto x, auto y, auto z) {
        return x == 3 && y == 90 ? std::numeric_limits<float>::quiet_NaN()
                                 : static_cast<float>(y) + 0.5f * static_cast<float>(z) + noise(random);
    });
    const test::TemporaryFolder folder;
    preprocess::BuildOptions options;
    options.kind = IndexKind::Metacells;
    ASSERT_THAT(test::buildIndexOf(grid, folder / "whole.isx", options), IsOk());
    const auto reader = index::IndexReader::open(folder / "whole.isx");
    ASSERT_THAT(reader, IsOk());
    const auto& pages = reader.value()->meta().levels.at(0).pages;
    ASSERT_GE(pages.size(), 3u);
    const std::uint64_t sampleBytes = reader.value()->info().chunkBytes;
    const std::vector<double> isovalues{40.0, 400.0, 120.5, 250.0, 180.0};
    std::vector<SurfaceMesh> whole;
    for (const double isovalue : isovalues)
        whole.push_back(extractFull(*grid, isovalue).value());

    const std::string good = test::readText(folder / "whole.isx");
    const std::size_t last = pages.size() - 1;
    int scans = 0; // mostly a block of a higher level leads over a damaged page
    for (const std::vector<std::size_t>& lost : {std::vector<std::size_t>{1}, {0, last}, {0, 1, last}}) {
        std::string bytes = good;
        for (const std::size_t page : lost)
            bytes[pages[page].offset + pages[page].bytes / 2] ^= 0x10;
        std::ofstream(folder / "damaged.isx", std::ios::binary) << bytes;
        const auto open = [&] {
            auto engine = SlideEngine::open(folder / "damaged.isx");
            EXPECT_THAT(engine, IsOk());
            return std::move(engine).value();
        };
        const auto sliding = open();
        for (std::size_t i = 0; i < isovalues.size(); ++i) {
            const KeyThreshold threshold = thresholdOf<float>(isovalues[i]);
            const bool isBetween = pages[lost.front()].firstKey < threshold && pages[lost.back()].lastKey >= threshold;
            const auto fresh = open();
            for (SlideEngine* engine : {sliding.get(), fresh.get()}) {
                const auto stats = engine->slideTo(isovalues[i]);
                ASSERT_THAT(stats, IsOk()) << isovalues[i];
                const auto found = engine->mesh();
                ASSERT_THAT(found, IsOk());
                ASSERT_TRUE(test::isSameSurface(found.value(), whole[i])) << isovalues[i];
                const bool hasReadAll = stats.value().bytesRead > sampleBytes / 2;
                EXPECT_TRUE(isBetween || !hasReadAll) << isovalues[i];
                scans += hasReadAll;
            }
        }
        // A region that changes looks at all active bricks, too.
        const auto bounded = open();
        ASSERT_THAT(bounded->slideTo(isovalues.back()), IsOk());
        const std::uint64_t all = bounded->slideTo(isovalues.back()).value().activeEdges;
        bounded->setRegion(BrickBox{{0, 0, 0}, {3, 41, 41}});
        const auto part = bounded->slideTo(isovalues.back());
        ASSERT_THAT(part, IsOk());
        EXPECT_LT(part.value().activeEdges, all);
        EXPECT_GT(part.value().activeEdges, all / 4);
        bounded->setRegion(std::nullopt);
        ASSERT_THAT(bounded->slideTo(isovalues.back()), IsOk());
        ASSERT_TRUE(test::isSameSurface(bounded->mesh().value(), whole.back()));
    }
    EXPECT_GT(scans, 0);
}

// No way from either end, but a sound one between two isovalues: what the list names there is looked up, no more.
TEST(DamagedPages, OnBothSidesAreReplacedByAllSamplesOnce) {
    const auto noiseOf = [](const GridDims& dims) {
        GridGeometry geometry;
        geometry.dims = dims;
        std::mt19937 random(9);
        std::uniform_real_distribution<float> noise(0.0f, 2.0f);
        return test::makeVolume<float>(ScalarType::F32, geometry, [&](auto x, auto y, auto z) {
            return x == 3 && y == 90 ? std::numeric_limits<float>::quiet_NaN()
                                     : static_cast<float>(y) + 0.5f * static_cast<float>(z) + noise(random);
        });
    };
    // More bricks, of which there are fewer records than of edges.
    const auto ofEdges = noiseOf({33, 130, 130}), ofBricks = noiseOf({65, 170, 170});
    const test::TemporaryFolder folder;
    for (const Case& of : {Case{IndexKind::Metacells, 0.0}, Case{IndexKind::Edges, 0.0}, Case{IndexKind::Edges, 1.0}}) {
        SCOPED_TRACE(std::string(index::indexKindName(of.kind)) + " " + std::to_string(of.mergeError));
        preprocess::BuildOptions options;
        options.kind = of.kind;
        options.mergeError.amount = of.mergeError;
        options.skipLevels = 1;
        ASSERT_THAT(test::buildIndexOf(of.kind == IndexKind::Edges ? ofEdges : ofBricks, folder / "whole.isx", options),
                    IsOk());
        const auto reader = index::IndexReader::open(folder / "whole.isx");
        ASSERT_THAT(reader, IsOk());
        const auto& pages = reader.value()->meta().levels.at(0).pages;
        ASSERT_GE(pages.size(), 3u);
        const index::PageEntry& sound = pages[pages.size() / 2];
        const auto range = index::isovaluesOf(ScalarType::F32, sound.firstKey, sound.lastKey);
        ASSERT_TRUE(range);
        std::string bytes = test::readText(folder / "whole.isx");
        for (const index::PageEntry* page : {&pages.front(), &pages.back()})
            bytes[page->offset + page->bytes / 2] ^= 0x10;
        std::ofstream(folder / "damaged.isx", std::ios::binary) << bytes;

        const auto engine = SlideEngine::open(folder / "damaged.isx", {.cacheBytes = 1 << 20, .readsAhead = false});
        const auto whole = SlideEngine::open(folder / "whole.isx");
        ASSERT_THAT(engine, IsOk());
        ASSERT_THAT(whole, IsOk());
        const auto slideTo = [&](double isovalue) {
            const auto stats = engine.value()->slideTo(isovalue);
            EXPECT_THAT(stats, IsOk());
            EXPECT_THAT(whole.value()->slideTo(isovalue), IsOk());
            EXPECT_TRUE(test::isSameSurface(engine.value()->mesh().value(), whole.value()->mesh().value())) << isovalue;
            return stats.value().bytesRead > reader.value()->info().chunkBytes / 2;
        };
        const double middle = 0.5 * ((*range)[0] + (*range)[1]), step = 0.002 * ((*range)[1] - (*range)[0]);
        EXPECT_TRUE(slideTo(middle)) << "all samples are read";
        for (const double away : {1.0, -0.5, 0.2, 2.0})
            EXPECT_FALSE(slideTo(middle + away * step)) << away;
        const BrickBox part{{0, 0, 0}, {3, 14, 14}}; // of which all samples must be read
        engine.value()->setRegion(part);
        whole.value()->setRegion(part);
        slideTo(middle);
        EXPECT_FALSE(slideTo(middle + step));
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, DamagedParts,
                         testing::Values(Case{IndexKind::Edges, 0.0}, Case{IndexKind::Edges, 8.0},
                                         Case{IndexKind::Metacells, 0.0}),
                         [](const auto& which) {
                             return std::string(index::indexKindName(which.param.kind)) +
                                    (which.param.mergeError > 0.0 ? "Merged" : "");
                         });

} // namespace
} // namespace isoslider::extract
