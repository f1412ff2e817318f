// Records of merged cells that contradict each other, under checksums that fit: what a damaged builder or a forger
// would write. Nothing of it may crash or hang.

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/extract/merged/merged_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/index/format/block_codec.h"
#include "core/index/index_reader.h"
#include "core/index/index_writer.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/index_chunks.h"
#include "tests/support/page_records.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;
using Key = std::uint16_t;
using Record = PointRecord<Key>;

constexpr GridDims kMergedDims{21, 19, 17};

Record edgeRecord(std::array<std::int64_t, 3> point, int axis, int level) {
    namespace form = record_form;
    Record record;
    record.setId(BrickGrid(kMergedDims).pointId(point[0], point[1], point[2]));
    record.form = form::edge(axis, level);
    record.edgeMask = form::maskOf(record.form);
    record.key = 20;
    record.farKeys[form::kOtherEnd] = 30;
    record.farKeys[form::kLowerEnd] = 15;
    record.farKeys[form::kUpperEnd] = 33;
    return record;
}

Record leafRecord(std::array<std::int64_t, 3> cell, int level) {
    Record record;
    record.setId(BrickGrid(kMergedDims).pointId(cell[0], cell[1], cell[2]));
    record.form = record_form::leaf(level);
    record.edgeMask = record_form::maskOf(record.form);
    record.key = 20;
    record.farKeys[record_form::kOtherEnd] = 10;
    return record;
}

Status decodeOne(const Record& record, DecodedPage<Key>& page, FarEnds farEnds = FarEnds::Directions) {
    const BrickGrid grid(kMergedDims);
    return decodePage<Key>(encodePage<Key>(std::span(&record, 1), PageOrder::Value, farEnds, grid), grid, page,
                           "a.isx");
}

TEST(MergedRecords, GiveBackWhatTheyTook) {
    DecodedPage<Key> page;
    for (const FarEnds farEnds : {FarEnds::Keys, FarEnds::Directions})
        for (const Record& record :
             {edgeRecord({4, 8, 16}, 1, 2), edgeRecord({1, 2, 3}, 0, 0), leafRecord({8, 8, 8}, 3)}) {
            ASSERT_THAT(decodeOne(record, page, farEnds), IsOk());
            ASSERT_EQ(page.forms.size(), 1u);
            EXPECT_EQ(page.forms[0], record.form);
            EXPECT_EQ(page.ids[0], record.id().number());
            EXPECT_EQ(page.keys[0], record.key);
            EXPECT_EQ(page.masks[0], record.edgeMask);
            EXPECT_EQ(page.entries, static_cast<std::size_t>(std::popcount(unsigned{record.edgeMask})));
            EXPECT_EQ(page.farKeys[0], record.farKeys[record_form::kOtherEnd]);
            EXPECT_EQ(page.rising[0], record_form::isEdge(record.form) ? record.edgeMask : 0);
            if (!record_form::isEdge(record.form))
                continue;
            EXPECT_EQ(page.farKeys[1], 15);
            EXPECT_EQ(page.farKeys[2], 33);
        }
    Record point;
    point.setId(BrickGrid(kMergedDims).pointId(1, 1, 1));
    point.key = 5;
    point.edgeMask = 2;
    point.farKeys[1] = 9;
    ASSERT_THAT(decodeOne(point, page), IsOk());
    EXPECT_TRUE(page.forms.empty()) << "pages of points alone are those of version 3";
}

TEST(MergedRecords, AreRefusedWhereTheyCannotBe) {
    DecodedPage<Key> page;
    const auto refuses = [&](const Record& record) {
        return testing::Value(decodeOne(record, page), HasError(ErrorCode::Corruption));
    };
    EXPECT_TRUE(refuses(edgeRecord({5, 8, 16}, 1, 2))) << "not aligned";
    EXPECT_TRUE(refuses(edgeRecord({20, 8, 8}, 0, 0))) << "leaves the box";
    EXPECT_TRUE(refuses(edgeRecord({16, 8, 8}, 0, 3))) << "its leaf edge leaves the box";
    EXPECT_TRUE(refuses(leafRecord({16, 8, 8}, 3)));
    EXPECT_TRUE(refuses(leafRecord({10, 8, 8}, 2)));
    Record record = leafRecord({8, 8, 8}, 2);
    record.form = record_form::kEnd;
    EXPECT_TRUE(refuses(record)) << "no such form";
    record = leafRecord({8, 8, 8}, 2);
    record.edgeMask = 0b100010;
    EXPECT_TRUE(refuses(record)) << "entries of another form";
    for (const auto& [lower, upper] : {std::pair{21, 33}, {15, 29}, {33, 33}, {5, 9}}) {
        record = edgeRecord({4, 8, 16}, 1, 2);
        record.farKeys[record_form::kLowerEnd] = static_cast<Key>(lower);
        record.farKeys[record_form::kUpperEnd] = static_cast<Key>(upper);
        EXPECT_TRUE(refuses(record)) << lower << " " << upper << " do not enclose 20 to 30";
    }
}

class MergedForgery : public testing::Test {
protected:
    void SetUp() override {
        GridGeometry geometry;
        geometry.dims = kMergedDims;
        build(test::makeVolume<std::uint8_t>(
                  ScalarType::U8, geometry,
                  [](std::int64_t x, std::int64_t y, std::int64_t z) {
                      const double dx = static_cast<double>(x) - 9.3, dy = static_cast<double>(y) - 9.1,
                                   dz = static_cast<double>(z) - 8.4;
                      const double rough = x > 14 ? 2.0 * std::sin(static_cast<double>(3 * x + 5 * y * z)) : 0.0;
                      return std::floor(6.0 * (std::sqrt(dx * dx + dy * dy + dz * dz) + rough)) + 15.0;
                  }),
              0.5);
    }

    void build(const std::shared_ptr<const ScalarGrid>& grid, double cells) {
        grid_ = grid;
        preprocess::BuildOptions options;
        options.mergeError = {extract::MergeBound::Measure::Distance, cells};
        ASSERT_THAT(test::buildIndexOf(grid, folder_ / "good.isx", options), IsOk());
    }

    // Level 0 only, its records changed.
    template <class Change>
    void forge(const Change& change) {
        const auto reader = IndexReader::open(folder_ / "good.isx");
        ASSERT_THAT(reader, IsOk());
        auto writer = IndexWriter::create(folder_ / "forged.isx", 7);
        ASSERT_THAT(writer, IsOk());
        ASSERT_THAT(test::copyChunks(*reader.value(), *writer.value()), IsOk());
        IndexMeta meta = reader.value()->meta();
        const std::vector<PageEntry> pages = meta.levels[0].pages;
        for (PageEntry entry : pages) {
            std::vector<std::byte> bytes;
            ASSERT_THAT(reader.value()->readPage(entry, bytes), IsOk());
            DecodedPage<Key> page;
            ASSERT_THAT(decodePage<Key>(bytes, reader.value()->grid(), page, "good.isx"), IsOk());
            std::vector<Record> records = test::recordsOf(page);
            change(records);
            std::stable_sort(records.begin(), records.end(),
                             [](const auto& a, const auto& b) { return a.key < b.key; });
            entry.points = static_cast<std::uint32_t>(records.size());
            entry.edges = 0;
            entry.firstKey = records.front().key;
            entry.lastKey = records.back().key;
            for (const Record& record : records)
                entry.edges += static_cast<std::uint32_t>(std::popcount(record.edgeMask));
            ASSERT_THAT(writer.value()->addPage(
                            kLevel0, entry,
                            encodePage<Key>(records, PageOrder::Value, FarEnds::Directions, reader.value()->grid())),
                        IsOk());
        }
        meta.info.levels.resize(1);
        meta.levels.clear();
        ASSERT_THAT(writer.value()->finish(std::move(meta)), IsOk());
    }

    // How many moves were refused. Other surfaces are those of the samples, merged within the index's error.
    int slide(const std::vector<double>& isovalues = {20.5, 25.5, 40.5, 41.5, 60.5, 30.5, 200.5}) {
        auto engine = extract::SlideEngine::open(folder_ / "forged.isx");
        EXPECT_THAT(engine, IsOk());
        int refused = 0;
        for (const double isovalue : isovalues) {
            const auto moved = engine.value()->slideTo(isovalue);
            if (!moved.isOk()) {
                EXPECT_EQ(moved.error().code, ErrorCode::Corruption) << moved.error().line();
                ++refused;
                continue;
            }
            const auto mesh = engine.value()->mesh();
            EXPECT_THAT(mesh, IsOk());
            const auto merged =
                extract::extractMerged(*grid_, isovalue, engine.value()->mergeBound(), extract::kMaxBrickMergeLevel);
            isRight_ = isRight_ && test::isSameSurface(mesh.value(), merged.value());
        }
        return refused;
    }

    std::shared_ptr<const ScalarGrid> grid_;
    bool isRight_ = true; ///< all surfaces were
    test::TemporaryFolder folder_;
};

TEST_F(MergedForgery, IsNoneWhereNothingIsChanged) {
    forge([](std::vector<Record>&) {});
    EXPECT_EQ(slide(), 0);
    EXPECT_TRUE(isRight_);
}

// Leaves follow from the samples, whatever is stated of them.
TEST_F(MergedForgery, LeavesAreThoseOfTheSamples) {
    forge([](std::vector<Record>& records) {
        std::erase_if(records, [](const Record& record) { return record.form >= record_form::kLeaves; });
    });
    EXPECT_EQ(slide(), 0);
    EXPECT_TRUE(isRight_);
    forge([](std::vector<Record>& records) {
        for (Record& record : records)
            if (record_form::isEdge(record.form))
                record.form = record_form::edge(record_form::axisOf(record.form), 0);
    });
    EXPECT_EQ(slide(), 0);
    EXPECT_TRUE(isRight_);
}

TEST_F(MergedForgery, EdgesThatGoButNeverCameAreFound) {
    forge([](std::vector<Record>& records) {
        std::erase_if(records, [](const Record& record) {
            return record_form::isEdge(record.form) && record.farKeys[record_form::kOtherEnd] > record.key;
        });
    });
    EXPECT_GT(slide(), 3);
}

TEST_F(MergedForgery, NeverCrashes) {
    namespace form = record_form;
    int refused = 0;
    for (unsigned seed = 1; seed <= 60; ++seed) {
        std::mt19937 random(seed);
        const unsigned oneIn = seed % 3 == 0 ? 400 : seed % 3 == 1 ? 40 : 4;
        forge([&](std::vector<Record>& records) {
            for (std::size_t i = 0; i < records.size(); ++i) {
                Record& record = records[i];
                if (record.form == form::kPoint || random() % oneIn != 0)
                    continue;
                switch (random() % 5) {
                    case 0: { // another edge or cell
                        const Record& other = records[random() % records.size()];
                        if (other.form == record.form)
                            record.setId(other.id());
                        break;
                    }
                    case 1: std::swap(record.farKeys[form::kLowerEnd], record.farKeys[form::kUpperEnd]); break;
                    case 2: // another level, where that is aligned
                        if (form::isEdge(record.form) && form::levelOf(record.form) > 0)
                            record.form = form::edge(form::axisOf(record.form), form::levelOf(record.form) - 1);
                        else if (!form::isEdge(record.form) && form::levelOf(record.form) > 1)
                            record.form = form::leaf(form::levelOf(record.form) - 1);
                        break;
                    case 3: record.farKeys[form::kOtherEnd] = records[random() % records.size()].key; break;
                    default: records.erase(records.begin() + static_cast<std::ptrdiff_t>(i)); break;
                }
            }
        });
        if (HasFatalFailure())
            return;
        refused += slide();
    }
    EXPECT_GT(refused, 0) << "most pages are refused before, and done without";
    EXPECT_TRUE(isRight_) << "what was not refused";
}

} // namespace
} // namespace isoslider::index
