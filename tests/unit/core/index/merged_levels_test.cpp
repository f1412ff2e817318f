// What an index of edges with merged cells holds against its definition: A(isovalue) is the set of leaves that the
// surface passes through, and of edges that carry a vertex, each on a leaf edge of some level, computed here from the
// samples and the levels of all cells at that isovalue. Each block of each skip level is the net change of A over its
// interval.

#include <bit>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "core/extract/merged/leaf_levels.h"
#include "core/grid/classification.h"
#include "core/grid/scalar_key.h"
#include "core/index/format/block_codec.h"
#include "core/index/index_reader.h"
#include "tests/property/random_volumes.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using extract::MergeBound;
using extract::MergeError;
using test::IsOk;

enum class What { Edge, Leaf };
/// Kind, level, axis, point.
using Element = std::tuple<What, int, int, std::array<std::int64_t, 3>>;
using Elements = std::set<Element>;
using Switches = std::map<Element, int>; ///< +1 on, -1 off, when the threshold rises

template <class Sample>
class Definition {
public:
    Definition(const ScalarGrid& grid, const MergeBound& bound)
        : view_{grid.values<Sample>().data(), grid.dims()}, bound_(bound) {
        for (const Sample sample : grid.values<Sample>())
            if (!isMissing(sample))
                keys_.insert(keyOf(sample));
    }

    const std::set<std::uint64_t>& keys() const { return keys_; }

    Switches change(std::uint64_t from, std::uint64_t to) {
        const Elements &before = elementsAt(from), &after = elementsAt(to);
        Switches switches;
        for (const Element& element : before)
            if (!after.contains(element))
                switches[element] = -1;
        for (const Element& element : after)
            if (!before.contains(element))
                switches[element] = 1;
        return switches;
    }

private:
    // The same from one key, exclusive, to the next, inclusive.
    const Elements& elementsAt(std::uint64_t threshold) {
        const auto next = keys_.lower_bound(threshold);
        const std::uint64_t key = next == keys_.end() ? ~std::uint64_t{0} : *next;
        const auto [found, isNew] = sets_.try_emplace(key);
        if (isNew && next != keys_.end())
            fill(sampleOfKey<Sample>(static_cast<KeyOf<Sample>>(key)), found->second);
        return found->second;
    }

    Sample at(const std::array<std::int64_t, 3>& p) const { return view_.samples[view_.offset(p[0], p[1], p[2])]; }
    bool isWhole(const std::array<std::int64_t, 3>& cell) const {
        for (int c = 0; c < 8; ++c)
            if (isMissing(at({cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)})))
                return false;
        return true;
    }
    bool isAboveAt(const std::array<std::int64_t, 3>& p, Sample isovalue) const { return at(p) >= isovalue; }

    void fill(Sample isovalue, Elements& elements) const {
        const auto levels =
            extract::LeafLevels::find(view_, static_cast<double>(isovalue), bound_, extract::kMaxBrickMergeLevel);
        std::array<std::int64_t, 3> p{};
        for (p[2] = 0; p[2] < view_.dims[2]; ++p[2])
            for (p[1] = 0; p[1] < view_.dims[1]; ++p[1])
                for (p[0] = 0; p[0] < view_.dims[0]; ++p[0])
                    for (std::size_t axis = 0; axis < 3; ++axis)
                        addAt(p, axis, isovalue, levels, elements);
    }

    void addAt(const std::array<std::int64_t, 3>& p, std::size_t axis, Sample isovalue,
               const extract::LeafLevels& levels, Elements& elements) const {
        auto end = p;
        if (++end[axis] >= view_.dims[axis] || isMissing(at(p)) || isMissing(at(end)) ||
            isAboveAt(p, isovalue) == isAboveAt(end, isovalue))
            return;
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        int smallest = 99;
        bool isUsable = false;
        for (int k = 0; k < 4; ++k) {
            auto cell = p;
            cell[u] -= k & 1;
            cell[v] -= k >> 1;
            if (cell[u] < 0 || cell[v] < 0 || cell[u] + 1 >= view_.dims[u] || cell[v] + 1 >= view_.dims[v])
                continue;
            isUsable = isUsable || isWhole(cell);
            const int level = levels.level(cell[0], cell[1], cell[2]);
            smallest = std::min(smallest, level);
            if (level > 0) {
                for (std::int64_t& c : cell)
                    c &= -(std::int64_t{1} << level);
                elements.insert({What::Leaf, level, 0, cell});
            }
        }
        const std::int64_t side = std::int64_t{1} << smallest;
        if (isUsable && p[u] % side == 0 && p[v] % side == 0)
            elements.insert({What::Edge, smallest, static_cast<int>(axis), p});
    }

    SampleView<Sample> view_;
    MergeBound bound_;
    std::set<std::uint64_t> keys_;
    std::map<std::uint64_t, Elements> sets_;
};

template <class Key>
void addSwitches(const DecodedPage<Key>& page, const BrickGrid& grid, std::uint64_t firstKey, std::uint64_t lastKey,
                 Switches& switches) {
    for (std::size_t i = 0; i < page.pointCount(); ++i) {
        const auto p = grid.pointCoords(PointId(page.ids[i]));
        const std::uint8_t form = page.form(i);
        const bool isListed = page.keys[i] >= firstKey && page.keys[i] <= lastKey;
        const auto add = [&](const Element& element, bool rises) {
            if (!isListed)
                return;
            // What leaves in a block and comes back in it is there twice.
            int& net = switches[element];
            net += rises ? 1 : -1;
            EXPECT_LE(std::abs(net), 1);
            if (net == 0)
                switches.erase(element);
        };
        if (form != record_form::kPoint) {
            const int level = record_form::levelOf(form);
            add(record_form::isEdge(form) ? Element{What::Edge, level, record_form::axisOf(form), p}
                                          : Element{What::Leaf, level, 0, p},
                page.rising[i] != 0);
            continue;
        }
        for (int e = 0; e < kPointEdges; ++e) {
            if (!(page.masks[i] >> e & 1))
                continue;
            auto start = p;
            start[static_cast<std::size_t>(e >> 1)] -= (e & 1) ? 0 : 1;
            add({What::Edge, 0, e >> 1, start}, (page.rising[i] >> e & 1) != 0);
        }
    }
}

template <class Sample>
int expectDefinition(const ScalarGrid& grid, const MergeError& error, const IndexReader& reader) {
    using SampleKey = KeyOf<Sample>;
    const IndexMeta& meta = reader.meta();
    Definition<Sample> definition(grid, extract::boundOf(error, meta.info.min, meta.info.max));
    EXPECT_EQ(meta.info.distinctValues, definition.keys().size());
    std::set<std::uint8_t> forms;
    for (std::size_t l = 0; l < meta.levels.size() && !testing::Test::HasFailure(); ++l) {
        std::vector<DecodedPage<SampleKey>> pages(meta.levels[l].pages.size());
        for (std::size_t p = 0; p < pages.size(); ++p) {
            std::vector<std::byte> bytes;
            EXPECT_THAT(reader.readPage(meta.levels[l].pages[p], bytes), IsOk());
            EXPECT_THAT(decodePage<SampleKey>(bytes, reader.grid(), pages[p], "a.isx"), IsOk());
            forms.insert(pages[p].forms.begin(), pages[p].forms.end());
        }
        if (l == 0)
            for (const std::uint64_t key : definition.keys()) {
                Switches switches;
                for (const auto& page : pages)
                    addSwitches(page, reader.grid(), key, key, switches);
                EXPECT_TRUE(switches == definition.change(key, key + 1)) << "block of key " << key;
            }
        for (const BlockEntry& block : meta.levels[l].blocks) {
            Switches switches;
            for (std::uint64_t p = 0; p < block.pageCount; ++p)
                addSwitches(pages[block.firstPage + p], reader.grid(), block.firstKey, block.lastKey, switches);
            EXPECT_TRUE(switches == definition.change(block.firstKey, block.lastKey + 1))
                << "level " << l << ", block of keys " << block.firstKey << " to " << block.lastKey;
        }
    }
    forms.erase(record_form::kPoint);
    return static_cast<int>(forms.size());
}

template <class Sample>
std::shared_ptr<const ScalarGrid> smoothBesideRough(ScalarType type, bool hasMissing) {
    GridGeometry geometry;
    geometry.dims = {19, 18, 17};
    return test::makeVolume<Sample>(type, geometry, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
        if (std::is_floating_point_v<Sample> && hasMissing && x == 13 && y == 9 && z % 5 == 2)
            return std::nan("");
        const double dx = static_cast<double>(x) - 7.3, dy = static_cast<double>(y) - 8.1,
                     dz = static_cast<double>(z) - 8.4;
        const double rough = x >= 12 ? 1.5 * std::sin(static_cast<double>(3 * x + 5 * y * z)) : 0.0;
        return std::floor(3.0 * (std::sqrt(dx * dx + dy * dy + dz * dz) + rough)) + 3.0;
    });
}

TEST(MergedLevels, EveryBlockIsTheNetChangeOverItsInterval) {
    using Measure = MergeBound::Measure;
    std::size_t levelsSeen = 0;
    int formsSeen = 0;
    for (const MergeError& error : {MergeError{Measure::Distance, 0.4}, MergeError{Measure::Scalar, 2.0}})
        for (const ScalarType type : {ScalarType::U8, ScalarType::I16, ScalarType::F32, ScalarType::F64}) {
            SCOPED_TRACE(scalarTypeName(type));
            const auto grid = visitScalarType(type, [&](auto sample) {
                return smoothBesideRough<decltype(sample)>(type, error.measure == Measure::Scalar);
            });
            preprocess::BuildOptions options;
            options.skipLevels = 6;
            options.redundancyThreshold = 0.3;
            options.mergeError = error;
            const test::TemporaryFolder folder;
            ASSERT_THAT(test::buildIndexOf(grid, folder / "a.isx", options), IsOk());
            const auto reader = IndexReader::open(folder / "a.isx");
            ASSERT_THAT(reader, IsOk());
            EXPECT_EQ(reader.value()->info().mergeError, error.amount);
            EXPECT_EQ(reader.value()->info().isMergeErrorInCells, error.measure == Measure::Distance);
            levelsSeen = std::max(levelsSeen, reader.value()->meta().levels.size());
            formsSeen = std::max(formsSeen, visitScalarType(type, [&](auto sample) {
                                     return expectDefinition<decltype(sample)>(*grid, error, *reader.value());
                                 }));
        }
    EXPECT_GE(levelsSeen, 4u);
    EXPECT_GE(formsSeen, 3 * 3 + 2) << "edges of three levels, leaves of two";
}

TEST(MergedLevels, GiveTheSameBytesForAnyMemoryBudgetAndThreads) {
    test::Random random(test::testSeed(70));
    const auto grid = test::patchyVolume(random);
    const test::TemporaryFolder folder;
    std::vector<std::string> contents;
    for (const auto& [memory, threads] : {std::pair{std::uint64_t{64} << 20, 1}, {std::uint64_t{1} << 30, 2}}) {
        preprocess::BuildOptions options;
        options.mergeError = {MergeBound::Measure::Distance, 0.3};
        options.memoryBytes = memory;
        options.threads = threads;
        ASSERT_THAT(test::buildIndexOf(grid, folder / "a.isx", options), IsOk());
        contents.push_back(test::readText(folder / "a.isx"));
    }
    EXPECT_EQ(contents[0], contents[1]);
}

} // namespace
} // namespace isoslider::index
