// Damage in a small index of noise, hidden corners among it: found, or without effect on any surface.

#include <bit>
#include <random>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/grid/scalar_key.h"
#include "core/index/format/block_codec.h"
#include "core/index/hidden_corners.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

class DamagedNoise : public testing::Test {
protected:
    void SetUp() override {
        grid_ = test::noiseVolume({10, 5, 5}, 4, 60);
        ASSERT_THAT(test::buildIndexOf(grid_, folder_ / "good.isx"), IsOk());
        bytes_ = test::readText(folder_ / "good.isx");
        const auto reader = IndexReader::open(folder_ / "good.isx");
        ASSERT_THAT(reader, IsOk());
        meta_ = reader.value()->meta();
        preamble_ = decodePreamble(std::as_bytes(std::span(bytes_)), bytes_.size(), "p").value();
        for (double isovalue = -0.5; isovalue < 61.0; isovalue += 1.25)
            fresh_.push_back(extract::extractFull(*grid_, isovalue).value());
    }

    // A new file each time: some file systems sync a file that is written over when it is closed.
    std::filesystem::path write(const std::string& bytes) {
        std::filesystem::remove(folder_ / "damaged.isx");
        return folder_.write("damaged.isx", bytes);
    }

    // Up through all isovalues and at once back: whether a fault was found. A surface is never wrong.
    bool isFound(const std::filesystem::path& path, ErrorCode expected = ErrorCode::Corruption) {
        const auto engine = extract::SlideEngine::open(path, {1});
        Status status;
        if (!engine.isOk()) {
            status = engine.error();
        } else {
            for (std::size_t i = 0; i <= fresh_.size() && status.isOk(); ++i) {
                const auto& fresh = fresh_[i % fresh_.size()];
                const auto moved = engine.value()->slideTo(fresh.isovalue);
                if (!moved.isOk())
                    status = moved.error();
                else
                    EXPECT_TRUE(test::isSameSurface(engine.value()->mesh().value(), fresh)) << fresh.isovalue;
            }
        }
        if (!status.isOk()) {
            EXPECT_EQ(status.error().code, expected) << status.error().line();
            EXPECT_EQ(status.error().path, path.string());
        }
        return !status.isOk();
    }

    // A file with one more page and another directory, all checksums right.
    std::string forged(IndexMeta meta, const std::vector<std::vector<HiddenCorner>>& pages) {
        std::string out = bytes_.substr(0, preamble_.metaOffset);
        for (const auto& corners : pages) {
            const auto page = encodeHiddenPage(corners, meta.info.type);
            HiddenPageEntry entry = hiddenPageEntry(corners);
            entry.offset = out.size();
            entry.bytes = static_cast<std::uint32_t>(page.size());
            entry.checksum = pageChecksum(page, preamble_.seed, entry.offset);
            out.append(reinterpret_cast<const char*>(page.data()), page.size());
            meta.hiddenPages.push_back(entry);
        }
        const auto encoded = encodeMeta(meta);
        Preamble preamble = preamble_;
        preamble.metaOffset = out.size();
        preamble.metaBytes = encoded.size();
        preamble.metaChecksum = metaChecksum(encoded);
        preamble.fileBytes = out.size() + encoded.size();
        const auto head = encodePreamble(preamble);
        std::copy_n(reinterpret_cast<const char*>(head.data()), head.size(), out.begin());
        return out.append(reinterpret_cast<const char*>(encoded.data()), encoded.size());
    }

    // As the index has them.
    std::vector<HiddenCorner> corners() {
        const auto reader = IndexReader::open(folder_ / "good.isx");
        std::vector<HiddenCorner> corners;
        for (const HiddenPageEntry& entry : reader.value()->meta().hiddenPages) {
            std::vector<std::byte> bytes;
            HiddenPage page;
            EXPECT_THAT(reader.value()->readPage(entry, bytes), IsOk());
            EXPECT_THAT(decodeHiddenPage(bytes, entry, reader.value()->info(), page, "p"), IsOk());
            for (std::size_t i = 0; i < page.places.size(); ++i)
                corners.push_back({entry.firstBrick + page.places[i] / kHiddenPlacesPerBrick,
                                   static_cast<std::uint16_t>(page.places[i] % kHiddenPlacesPerBrick),
                                   keyOf(static_cast<std::uint8_t>(page.scalars[i]))});
        }
        return corners;
    }

    test::TemporaryFolder folder_;
    std::shared_ptr<const ScalarGrid> grid_;
    std::string bytes_;
    IndexMeta meta_;
    Preamble preamble_;
    std::vector<extract::SurfaceMesh> fresh_;
};

TEST_F(DamagedNoise, IsGoodAsItWasBuilt) {
    ASSERT_EQ(meta_.hiddenPages.size(), 1u);
    EXPECT_GE(meta_.hiddenPages[0].corners, 8u);
    EXPECT_GT(meta_.hiddenPages[0].lastBrick, meta_.hiddenPages[0].firstBrick);
    EXPECT_FALSE(isFound(folder_ / "good.isx"));
    IndexMeta meta = meta_;
    meta.hiddenPages.clear();
    EXPECT_FALSE(isFound(write(forged(meta, {corners()})))) << "the forger's tools are good";
}

TEST_F(DamagedNoise, TruncationIsRefused) {
    const HiddenPageEntry& hidden = meta_.hiddenPages[0];
    for (std::size_t length = 0; length < bytes_.size(); length += length < hidden.offset + hidden.bytes + 2 ? 1 : 41)
        ASSERT_THAT(IndexReader::open(write(bytes_.substr(0, length))),
                    HasError(length < 12 ? ErrorCode::InvalidArgument : ErrorCode::Corruption))
            << length;
}

TEST_F(DamagedNoise, AFlippedBitInAnyByteIsFoundOrHarmless) {
    const HiddenPageEntry& hidden = meta_.hiddenPages[0];
    std::mt19937 random(6);
    std::size_t found = 0, others = 0;
    for (std::size_t at = 0; at < bytes_.size(); at += test::kSparser) {
        const bool isPage = at >= kPreambleBytes && at < preamble_.metaOffset;
        const bool isHidden = at >= hidden.offset && at < hidden.offset + hidden.bytes;
        if (isPage && !isHidden && at % 6 != 0)
            continue;
        std::string damaged = bytes_;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << (random() % 8)));
        const auto path = write(damaged);
        const ErrorCode code = at < 12   ? ErrorCode::InvalidArgument
                               : at < 14 ? ErrorCode::UnsupportedVersion
                                         : ErrorCode::Corruption;
        if (!isPage) {
            ASSERT_THAT(IndexReader::open(path), HasError(code)) << "byte " << at;
        } else if (isHidden) {
            ASSERT_TRUE(isFound(path)) << "byte " << at;
        } else {
            found += isFound(path);
            ++others;
        }
        if (HasFailure())
            break;
    }
    EXPECT_GT(found, others / 2) << "only pages that no move needs may be damaged";
}

TEST_F(DamagedNoise, DamagedHiddenCornersAreFoundByTheCellThatNeedsThem) {
    const HiddenPageEntry hidden = meta_.hiddenPages[0];
    std::string damaged = bytes_;
    damaged[hidden.offset + hidden.bytes / 2] ^= 2;
    const auto path = write(damaged);
    const auto engine = extract::SlideEngine::open(path);
    ASSERT_THAT(engine, IsOk());
    ASSERT_THAT(engine.value()->slideTo(-1.0), IsOk()) << "no cell is active";
    Result<extract::SlideStats> moved = engine.value()->slideTo(0.5);
    for (int step = 0; step < 60 && moved.isOk(); ++step)
        moved = engine.value()->slideTo(0.5 + step);
    ASSERT_THAT(moved, HasError(ErrorCode::Corruption));
    EXPECT_EQ(moved.error().path, path.string());
    EXPECT_EQ(moved.error().offset, hidden.offset);
    EXPECT_TRUE(engine.value()->mesh().value().triangles.empty()) << "a failed move leaves no surface";
}

// The surface notices it, and knows no file.
TEST_F(DamagedNoise, AnIndexThatContradictsItselfIsNamed) {
    using Key = KeyOf<std::uint8_t>;
    PageEntry& entry = meta_.levels[0].pages[0];
    const auto reader = IndexReader::open(folder_ / "good.isx");
    ASSERT_THAT(reader, IsOk());
    DecodedPage<Key> page;
    ASSERT_THAT(decodePage<Key>(std::as_bytes(std::span(bytes_)).subspan(entry.offset, entry.bytes),
                                reader.value()->grid(), page, "p"),
                IsOk());
    std::vector<PointRecord<Key>> records;
    for (std::size_t i = 0, far = 0; i < page.pointCount(); ++i) {
        PointRecord<Key> record;
        record.key = page.keys[i];
        record.setId(PointId(page.ids[i]));
        record.edgeMask = page.masks[i];
        for (int e = 0; e < kPointEdges; ++e)
            if ((record.edgeMask >> e & 1) != 0)
                record.farKeys[e] = page.farKeys[far++];
        records.push_back(record);
    }
    // An edge that its one end makes active, and its other end as well.
    for (PointRecord<Key>& record : records) {
        const int edge = std::countr_zero(record.edgeMask);
        if (edge < kPointEdges && record.farKeys[edge] < record.key) {
            record.farKeys[edge] = static_cast<Key>(record.key + 1);
            break;
        }
    }
    const auto bytes =
        encodePage<Key>(std::span<const PointRecord<Key>>(records), PageOrder::Value, reader.value()->grid());
    entry.offset = preamble_.metaOffset;
    entry.bytes = static_cast<std::uint32_t>(bytes.size());
    entry.checksum = pageChecksum(bytes, preamble_.seed, entry.offset);
    bytes_.resize(preamble_.metaOffset);
    bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    preamble_.metaOffset = bytes_.size();
    const auto path = write(forged(meta_, {}));
    const auto engine = extract::SlideEngine::open(path);
    ASSERT_THAT(engine, IsOk());
    Result<extract::SlideStats> moved = engine.value()->slideTo(-1.0);
    for (int step = 0; step < 60 && moved.isOk(); ++step)
        moved = engine.value()->slideTo(0.5 + step);
    ASSERT_THAT(moved, HasError(ErrorCode::Corruption));
    EXPECT_NE(moved.error().message.find("contradicts itself"), std::string::npos) << moved.error().message;
    EXPECT_EQ(moved.error().path, path.string());
}

// Samples on the other side of the surface than the edges state, corners too few and too many: wrong surfaces,
// as from any well-made lie, but nothing worse.
TEST_F(DamagedNoise, ForgedHiddenCornersNeverCrash) {
    std::mt19937 random(7);
    IndexMeta meta = meta_;
    meta.hiddenPages.clear();
    const auto min = static_cast<std::uint64_t>(meta_.info.min),
               span = static_cast<std::uint64_t>(meta_.info.max) - min + 1;
    for (int round = 0; round < 60; ++round) {
        std::vector<HiddenCorner> forgedCorners;
        if (round % 2) {
            forgedCorners = corners();
            for (HiddenCorner& corner : forgedCorners)
                if (round % 4 == 1 || random() % 3 == 0)
                    corner.key = min + random() % span;
        } else { // of all cells
            for (int z = 0; z < 4; ++z)
                for (int y = 0; y < 4; ++y)
                    for (int x = 0; x < 8; ++x)
                        for (int c = 0; c < 8; ++c)
                            if (random() % 8 != 0)
                                forgedCorners.push_back({BrickIndex(),
                                                         static_cast<std::uint16_t>(8 * (x + 8 * y + 64 * z) + c),
                                                         min + random() % span});
        }
        const auto engine = extract::SlideEngine::open(write(forged(meta, {forgedCorners})), {1});
        ASSERT_THAT(engine, IsOk());
        for (const auto& fresh : fresh_)
            EXPECT_NO_THROW(static_cast<void>(engine.value()->slideTo(fresh.isovalue).isOk()));
    }
    EXPECT_NO_THROW(
        static_cast<void>(extract::SlideEngine::open(write(forged(meta, {}))).value()->slideTo(20.0).isOk()));
}

TEST_F(DamagedNoise, ForgedDirectoriesOfHiddenCornersNeverCrash) {
    std::mt19937_64 random(3);
    for (int round = 0; round < 150; ++round) {
        IndexMeta meta = meta_;
        meta.hiddenPages.resize(1 + random() % 2, meta_.hiddenPages[0]);
        for (int changes = 0; changes < 2; ++changes) {
            HiddenPageEntry& entry = meta.hiddenPages[random() % meta.hiddenPages.size()];
            const auto change = [&](auto& field) {
                if (random() % 4 == 0)
                    field = field + (static_cast<int>(random() % 5) - 2);
            };
            change(entry.firstBrick);
            change(entry.lastBrick);
            change(entry.corners);
            change(entry.bytes);
            if (random() % 8 == 0)
                entry.offset = random() % 3 ? meta_.levels[0].pages[0].offset : ~std::uint64_t{0} - 5;
            // The checksum of whatever lies there.
            if (entry.offset < bytes_.size() && entry.bytes <= bytes_.size() - entry.offset)
                entry.checksum = pageChecksum(std::as_bytes(std::span(bytes_)).subspan(entry.offset, entry.bytes),
                                              preamble_.seed, entry.offset);
        }
        const auto engine = extract::SlideEngine::open(write(forged(meta, {})), {1});
        if (!engine.isOk())
            continue;
        for (std::size_t i = 0; i < fresh_.size(); i += 3)
            EXPECT_NO_THROW(static_cast<void>(engine.value()->slideTo(fresh_[i].isovalue).isOk()));
    }
}

} // namespace
} // namespace isoslider::index
