// Properties that RapidCheck shrinks to their smallest counterexample. A failure prints the seed.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/grid/scalar_key.h"
#include "core/index/format/block_codec.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/temporary_folder.h"

namespace isoslider {
namespace {

RC_GTEST_PROP(ScalarKeyProperty, KeepsTheOrderOfFloats, (float a, float b)) {
    RC_PRE(std::isfinite(a) && std::isfinite(b));
    RC_ASSERT((a < b) == (keyOf(a) < keyOf(b)));
    RC_ASSERT(sampleOfKey<float>(keyOf(a)) == a);
}

RC_GTEST_PROP(ScalarKeyProperty, ThresholdsDecideAsTheSignConventionDoes, (std::int16_t sample, double isovalue)) {
    RC_PRE(!std::isnan(isovalue));
    RC_ASSERT((keyOf(sample) >= thresholdOf<std::int16_t>(isovalue)) == (static_cast<double>(sample) >= isovalue));
    const auto tie = static_cast<double>(sample);
    RC_ASSERT(keyOf(sample) >= thresholdOf<std::int16_t>(tie));
}

// Records with distinct ids inside a grid, edges only where the grid goes on.
std::vector<index::PointRecord<std::uint32_t>> recordsIn(const BrickGrid& grid, index::PageOrder order) {
    std::vector<index::PointRecord<std::uint32_t>> records;
    const auto ids = *rc::gen::container<std::set<std::uint64_t>>(rc::gen::inRange<std::uint64_t>(0, grid.idCount()));
    for (const std::uint64_t number : ids) {
        const PointId id(number);
        if (!grid.contains(id))
            continue;
        const auto p = grid.pointCoords(id);
        index::PointRecord<std::uint32_t> record;
        record.setId(id);
        record.key = *rc::gen::arbitrary<std::uint32_t>();
        for (int e = 0; e < index::kPointEdges; ++e) {
            const bool exists = e & 1 ? p[e >> 1] + 1 < grid.dims()[e >> 1] : p[e >> 1] > 0;
            if (!exists || !*rc::gen::arbitrary<bool>())
                continue;
            record.edgeMask |= static_cast<std::uint8_t>(1 << e);
            record.farKeys[e] = *rc::gen::arbitrary<std::uint32_t>();
        }
        if (record.edgeMask != 0)
            records.push_back(record);
    }
    if (order == index::PageOrder::Value)
        std::stable_sort(records.begin(), records.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
    return records;
}

RC_GTEST_PROP(BlockCodecProperty, GivesBackEveryRecord, (bool byValue, bool withKeys)) {
    const BrickGrid grid({11, 9, 17});
    const auto order = byValue ? index::PageOrder::Value : index::PageOrder::Id;
    const auto farEnds = withKeys ? index::FarEnds::Keys : index::FarEnds::Directions;
    const auto records = recordsIn(grid, order);
    RC_PRE(!records.empty());
    const auto bytes = index::encodePage<std::uint32_t>(records, order, farEnds, grid);
    index::DecodedPage<std::uint32_t> page;
    RC_ASSERT(index::decodePage<std::uint32_t>(bytes, grid, page, "memory").isOk());
    RC_ASSERT(page.pointCount() == records.size());
    const auto least = std::min_element(records.begin(), records.end(), [](const auto& a, const auto& b) {
                           return a.key < b.key;
                       })->key;
    std::size_t edge = 0;
    for (std::size_t i = 0; i < records.size(); ++i) {
        RC_ASSERT(page.keys[i] == (byValue || withKeys ? records[i].key : least));
        RC_ASSERT(page.ids[i] == records[i].id().number());
        RC_ASSERT(page.masks[i] == records[i].edgeMask);
        for (int e = 0; e < index::kPointEdges; ++e) {
            if (!(records[i].edgeMask >> e & 1))
                continue;
            RC_ASSERT((page.rising[i] >> e & 1) == (records[i].farKeys[e] > records[i].key ? 1 : 0));
            if (withKeys)
                RC_ASSERT(page.farKeys[edge++] == records[i].farKeys[e]);
        }
    }
}

// The law of the product on volumes small enough to be read in a failure.
RC_GTEST_PROP(SlideProperty, EqualsTheFreshExtraction, ()) {
    GridGeometry geometry;
    for (int a = 0; a < 3; ++a)
        geometry.dims[a] = *rc::gen::inRange<std::int64_t>(1, 12);
    const auto samples = *rc::gen::container<std::vector<std::uint8_t>>(
        static_cast<std::size_t>(pointCount(geometry.dims)), rc::gen::inRange<std::uint8_t>(0, 9));
    const auto isovalues = *rc::gen::container<std::vector<int>>(6, rc::gen::inRange(-2, 22));
    const auto grid =
        std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<std::uint8_t>(geometry, ScalarType::U8, samples));
    const test::TemporaryFolder folder;
    preprocess::BuildOptions options;
    options.skipLevels = *rc::gen::inRange(1, 6);
    options.redundancyThreshold = 0.1;
    RC_ASSERT(test::buildIndexOf(grid, folder / "a.isx", options).isOk());
    auto engine = extract::SlideEngine::open(folder / "a.isx");
    RC_ASSERT(engine.isOk());
    for (const int half : isovalues) { // halves: ties and in between
        const double isovalue = 0.5 * half;
        RC_ASSERT(engine.value()->slideTo(isovalue).isOk());
        const auto fresh = extract::extractFull(*grid, isovalue);
        RC_ASSERT(fresh.isOk());
        RC_ASSERT(static_cast<bool>(test::isSameSurface(engine.value()->mesh().value(), fresh.value())));
    }
}

} // namespace
} // namespace isoslider
