// The kernels of live bricks, under every instruction set that the machine has, against plain code.

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/extract/live/brick_shapes.h"
#include "core/extract/live/brick_slot.h"
#include "core/extract/live/cell_triangles.h"
#include "core/extract/live/vertex_kernels.h"
#include "core/extract/sources/memory_samples.h"
#include "core/extract/sources/point_kernels.h"
#include "core/extract/sources/sample_kernels.h"
#include "tests/support/scalar_type_of.h"

namespace isoslider::extract {
namespace {

template <class A, class B>
constexpr bool kMix = std::is_convertible_v<A, B> || std::is_constructible_v<A, B>;
static_assert(!kMix<ClosedPoint, ClosedEdge> && !kMix<ClosedEdge, ClosedPoint>);
static_assert(!kMix<ClosedPoint, LocalPoint> && !kMix<LocalPoint, ClosedPoint> && !kMix<PointId, LocalPoint>);
static_assert(!kMix<BrickIndex, BrickSlot> && !kMix<BrickSlot, BrickIndex> && !kMix<BrickIndex, PointId>);
static_assert(sizeof(ClosedEdge) == 2 && sizeof(BrickIndex) == 4);

class LiveKernels : public testing::TestWithParam<std::size_t> {
protected:
    void SetUp() override { useKernelTarget(GetParam()); }
    void TearDown() override { useKernelTarget(0); }
    std::mt19937 random_{1};
};

std::string targetName(const testing::TestParamInfo<std::size_t>& info) { return kernelTargets().at(info.param); }

INSTANTIATE_TEST_SUITE_P(Targets, LiveKernels, testing::Range(std::size_t{0}, kernelTargets().size()), targetName);

const BrickMasks& innerMasks() {
    static const std::vector<index::MissingCells> none;
    static const BrickShapes shapes({40, 40, 40}, none);
    return shapes.masks(shapes.grid().brickAt(1, 2, 1));
}

template <class Stored>
struct alignas(64) Samples {
    Stored values[kKeptPoints];
};

// Noise, with ties at the threshold, all on one side, and extreme values.
template <class Stored>
Samples<Stored> samplesOf(int kind, std::mt19937& random) {
    Samples<Stored> samples;
    for (Stored& value : samples.values) {
        const auto r = random();
        switch (kind) {
            case 0: value = static_cast<Stored>(r % 200); break;
            case 1: value = static_cast<Stored>(100); break;
            case 2: value = r % 2 ? std::numeric_limits<Stored>::max() : std::numeric_limits<Stored>::lowest(); break;
            default: value = static_cast<Stored>(r % 3 + 99); break;
        }
    }
    return samples;
}

template <class Stored>
void expectSameClassification(std::mt19937& random) {
    const BrickMasks& masks = innerMasks();
    for (int kind = 0; kind < 4; ++kind)
        for (const Stored threshold :
             {Stored(0), Stored(99), Stored(100), Stored(101), std::numeric_limits<Stored>::max()}) {
            const auto samples = samplesOf<Stored>(kind, random);
            BitString signs;
            for (unsigned p = 0; p < kClosedPoints; ++p)
                if (random() % 3 == 0)
                    signs.set(ClosedPoint(p));
            auto before = signs.words; // behind the words of signs others lie
            for (std::size_t w = kBitWords; w < before.size(); ++w)
                before[w] = random() | std::uint64_t{random()} << 32;
            for (const bool wasThere : {false, true}) {
                const auto old = wasThere ? std::optional<BitsInMemory>(before.data()) : std::nullopt;
                ClassifiedBrick<Stored> plain, fast;
                classifyReference(samples.values, threshold, masks, old, plain);
                classify(samples.values, threshold, masks, old, fast);
                ClassifiedBrick<Stored> again;
                again.above = plain.above;
                again.up = plain.up;
                again.down = plain.down;
                classifyAgain(masks, old, again);
                for (const ClassifiedBrick<Stored>* found : {&fast, &again}) {
                    ASSERT_EQ(found->above, plain.above) << "kind " << kind;
                    ASSERT_EQ(found->active.edges, plain.active.edges);
                    ASSERT_EQ(found->active.cells, plain.active.cells);
                    ASSERT_EQ(found->changed, plain.changed);
                    ASSERT_EQ(found->up, plain.up);
                    ASSERT_EQ(found->down, plain.down);
                    ASSERT_EQ(found->ownedEdges, plain.ownedEdges);
                    ASSERT_EQ(found->edgesAdded, plain.edgesAdded);
                    ASSERT_EQ(found->edgesRemoved, plain.edgesRemoved);
                }
            }
        }
}

TEST_P(LiveKernels, ClassifyAsPlainCodeDoes) {
    expectSameClassification<std::uint8_t>(random_);
    expectSameClassification<std::uint16_t>(random_);
    expectSameClassification<std::int32_t>(random_);
    expectSameClassification<float>(random_);
    expectSameClassification<double>(random_);
}

// Of samples that ascend or descend along each axis.
template <class Stored>
void expectOneLeafOfItsSamples(std::mt19937& random) {
    for (int round = 0; round < 50; ++round) {
        struct alignas(64) {
            Stored values[kKeptPoints];
        } brick;
        std::array<std::array<int, kPointSide>, 3> steps{};
        for (auto& along : steps) {
            const bool ascends = random() % 2 != 0;
            for (int& step : along)
                step = static_cast<int>(random() % 4);
            for (std::size_t i = 1; i < along.size(); ++i)
                along[i] += along[i - 1];
            if (!ascends)
                std::reverse(along.begin(), along.end());
        }
        for (int p = 0; p < kClosedPoints; ++p) {
            const auto at = coordsOf(ClosedPoint(p));
            int value = 0;
            for (std::size_t a = 0; a < 3; ++a)
                value += steps[a][static_cast<std::size_t>(at[a])];
            brick.values[p] = static_cast<Stored>(value);
        }
        LeafEdgeSamples<Stored> edges;
        edges.fill(brick.values);
        const auto threshold = static_cast<Stored>(random() % 80);
        ClassifiedLeafEdges<Stored> found;
        classifyLeafEdges(edges, threshold, found);
        const OneLeaf leaf = oneLeafOf(found.above);
        Stored up = std::numeric_limits<Stored>::max(), down = std::numeric_limits<Stored>::lowest();
        for (int p = 0; p < kClosedPoints; ++p) {
            const auto at = coordsOf(ClosedPoint(p));
            if ((at[0] % 8 == 0) + (at[1] % 8 == 0) + (at[2] % 8 == 0) < 2)
                continue; // on no leaf edge
            if (brick.values[p] >= threshold)
                up = std::min(up, brick.values[p]);
            else
                down = std::max(down, brick.values[p]);
        }
        ASSERT_EQ(found.up, up);
        ASSERT_EQ(found.down, down);
        const auto isAbove = [&](ClosedPoint p) { return brick.values[p.index()] >= threshold; };
        for (unsigned c = 0; c < 8; ++c)
            ASSERT_EQ(leaf.signs >> c & 1, unsigned{isAbove(cornerOfBrick(c))});
        for (std::size_t e = 0; e < 12; ++e) {
            if ((cell::activeEdges(leaf.signs) >> e & 1) == 0)
                continue;
            const ClosedEdge edge = leaf.activeEdge(e);
            ASSERT_EQ(axisOf(edge), cell::kCellEdges[e].axis);
            ASSERT_NE(isAbove(startOf(edge)), isAbove(startOf(edge) + kPointStride[cell::kCellEdges[e].axis]));
        }
    }
}

TEST_P(LiveKernels, FindOneLeafOfItsEdgesAlone) {
    expectOneLeafOfItsSamples<std::uint8_t>(random_);
    expectOneLeafOfItsSamples<std::uint16_t>(random_);
    expectOneLeafOfItsSamples<std::int32_t>(random_);
    expectOneLeafOfItsSamples<float>(random_);
    expectOneLeafOfItsSamples<double>(random_);
}

// The bits themselves, from first principles.
TEST_P(LiveKernels, FindTheEdgesAndCellsThatTheSignsSay) {
    const BrickMasks& masks = innerMasks();
    const auto samples = samplesOf<float>(0, random_);
    ClassifiedBrick<float> found;
    classify(samples.values, 100.0f, masks, {}, found);
    const auto isAbove = [&](int x, int y, int z) { return samples.values[closedPoint(x, y, z).index()] >= 100.0f; };
    for (int z = 0; z < kPointSide; ++z)
        for (int y = 0; y < kPointSide; ++y)
            for (int x = 0; x < kPointSide; ++x) {
                const ClosedPoint p = closedPoint(x, y, z);
                ASSERT_EQ(found.active.edges[0].test(p), x < 8 && isAbove(x, y, z) != isAbove(x + 1, y, z));
                ASSERT_EQ(found.active.edges[1].test(p), y < 8 && isAbove(x, y, z) != isAbove(x, y + 1, z));
                ASSERT_EQ(found.active.edges[2].test(p), z < 8 && isAbove(x, y, z) != isAbove(x, y, z + 1));
                if (x == 8 || y == 8 || z == 8) {
                    ASSERT_FALSE(found.active.cells.test(p));
                    continue;
                }
                unsigned signs = 0;
                for (int c = 0; c < 8; ++c)
                    signs |= static_cast<unsigned>(isAbove(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))) << c;
                ASSERT_EQ(found.active.cells.test(p), signs != 0 && signs != 255);
                ASSERT_EQ(signsOfCell(found.above, p), signs);
            }
}

template <class Sample>
constexpr ScalarType kScalarTypeOf = ScalarType::U8;
#define ISO_TYPE(Sample, Name) \
    template <> \
    constexpr ScalarType kScalarTypeOf<Sample> = ScalarType::Name;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_TYPE)
#undef ISO_TYPE

std::string toString(const glm::vec3& v) {
    return std::to_string(v.x) + ' ' + std::to_string(v.y) + ' ' + std::to_string(v.z);
}

template <class Sample>
void expectRecords(std::mt19937& random) {
    using Stored = StoredSample<Sample>;
    using Live = LiveOf<Sample>;
    const auto samples = samplesOf<Stored>(0, random);
    BrickPoints<Sample> points;
    std::copy(std::begin(samples.values), std::end(samples.values), points.samples);
    for (NormalCode& code : points.normals)
        code = static_cast<NormalCode>(random());
    const auto* const lines = linesOf(points);
    // Of all edges of the brick, then with some that lie on edges of merged cells.
    for (const bool merges : {false, true})
        for (const std::uint32_t count : {1u, 15u, 16u, 17u, 333u}) {
            std::vector<VertexCode> codes;
            for (std::uint32_t k = 0; k < count; ++k) {
                const auto axis = static_cast<std::size_t>(random() % 3);
                std::array<int, 3> at;
                for (std::size_t a = 0; a < 3; ++a)
                    at[a] = static_cast<int>(random() % (a == axis ? kCellSide : kPointSide));
                const int level = merges && random() % 3 == 0 ? static_cast<int>(random() % 4) : 0;
                codes.push_back(
                    vertexCode(closedEdge(static_cast<int>(axis), closedPoint(at[0], at[1], at[2])), level));
            }
            std::vector<EdgeRecord<Live>> records(count + 1);
            records[count].edge = ClosedEdge(4321);
            readRecords<Live>(kScalarTypeOf<Sample>, lines, codes.data(), count, records.data());
            EXPECT_EQ(records[count].edge, ClosedEdge(4321)) << "nothing is written behind the last";
            const std::array<std::int32_t, 3> origin{8, 1600, 64};
            const auto isovalue = static_cast<Live>(records[0].scalar1 / 2 + records[0].scalar2 / 2);
            std::vector<VertexGroup<Live>> groups(groupCount(count) + 1);
            groups.back().codes[0] = 4321;
            gatherVertices<Live>(kScalarTypeOf<Sample>, lines, codes.data(), count, groups.data());
            EXPECT_EQ(groups.back().codes[0], 4321u);
            for (const bool fromGroups : {false, true})
                for (const std::uint32_t room : {count, count + kGroupSize}) {
                    std::vector<glm::vec3> positions(room + 1, glm::vec3(4321.0f)), normals = positions;
                    const VertexRoom here{positions.data(), normals.data(), room};
                    if (fromGroups)
                        placeVertices<Live>(groups.data(), count, origin, isovalue, here);
                    else
                        placeVertices<Live>(kScalarTypeOf<Sample>, lines, codes.data(), count, origin, isovalue, here);
                    EXPECT_EQ(positions[room], glm::vec3(4321.0f));
                    EXPECT_EQ(normals[room], glm::vec3(4321.0f));
                    for (std::uint32_t k = 0; k < count; ++k) {
                        const MeshVertex plain = vertexOf<Live>(records[k], origin, isovalue);
                        ASSERT_EQ(toString(positions[k]), toString(plain.position)) << k; // ends may be equal: NaN
                        ASSERT_EQ(normals[k], plain.normal) << k;
                    }
                }
            for (std::uint32_t k = 0; k < count; ++k) {
                const ClosedEdge edge = edgeOf(codes[k]);
                const auto axis = static_cast<std::size_t>(axisOf(edge));
                auto low = coordsOf(startOf(edge));
                low[axis] = low[axis] >> levelOf(codes[k]) << levelOf(codes[k]);
                auto high = low;
                high[axis] += 1 << levelOf(codes[k]);
                const std::size_t p = closedPoint(low[0], low[1], low[2]).index(),
                                  q = closedPoint(high[0], high[1], high[2]).index();
                for (const EdgeRecord<Live>& record :
                     {records[k], readRecord<Live>(kScalarTypeOf<Sample>, lines, codes[k])}) {
                    ASSERT_EQ(record.edge, edge);
                    ASSERT_EQ(record.levelOrUpperZ, levelOf(codes[k]));
                    ASSERT_EQ(record.normal1, points.normals[p]);
                    ASSERT_EQ(record.normal2, points.normals[q]);
                    ASSERT_EQ(record.scalar1, static_cast<Live>(sampleOf<Sample>(points.samples[p])));
                    ASSERT_EQ(record.scalar2, static_cast<Live>(sampleOf<Sample>(points.samples[q])));
                }
            }
        }
}

TEST_P(LiveKernels, NumberActiveEdgesInOrder) {
    for (const float threshold : {0.0f, 1.0f, 50.0f, 100.0f}) {
        ClassifiedBrick<float> found;
        classify(samplesOf<float>(0, random_).values, threshold, innerMasks(), {}, found);
        VertexTable table;
        std::vector<VertexCode> codes(kMaxEdgeCodes);
        const std::uint32_t count = numberEdges(found.active, codes.data(), table);
        std::uint32_t next = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
            forEachSetBit(found.active.edges[axis], [&](ClosedPoint p) {
                const ClosedEdge edge = closedEdge(static_cast<int>(axis), p);
                ASSERT_EQ(codes[next], vertexCode(edge));
                ASSERT_EQ(table.of(edge), next++);
            });
        EXPECT_EQ(count, next);
    }
}

TEST_P(LiveKernels, ReadTheRecordsThatCodesReferTo) {
    expectRecords<std::uint8_t>(random_);
    expectRecords<std::int8_t>(random_);
    expectRecords<std::uint16_t>(random_);
    expectRecords<std::int16_t>(random_);
    expectRecords<std::int32_t>(random_);
    expectRecords<float>(random_);
    expectRecords<double>(random_);
}

// Samples whose differences are of all kinds: plain, none, beyond what is plain, denormal where the type has such.
template <class Sample>
Sample sampleOfKind(int kind, std::mt19937& random) {
    const auto r = random();
    switch (kind) {
        case 0: return static_cast<Sample>(r % 100);
        case 1: return Sample(7);
        case 2: return r % 2 ? std::numeric_limits<Sample>::max() : std::numeric_limits<Sample>::lowest();
        default: return r % 3 ? std::numeric_limits<Sample>::min() : Sample(0);
    }
}

template <class Sample>
void expectPoints(std::mt19937& random) {
    for (const GridDims dims : {GridDims{40, 40, 40}, GridDims{9, 12, 16}, GridDims{8, 8, 2}, GridDims{2, 3, 17}})
        for (int kind = 0; kind < 4; ++kind) {
            GridGeometry geometry;
            geometry.dims = dims;
            std::vector<Sample> samples(static_cast<std::size_t>(dims[0] * dims[1] * dims[2]));
            std::generate(samples.begin(), samples.end(), [&] { return sampleOfKind<Sample>(kind, random); });
            const ScalarGrid grid = ScalarGrid::fromValues<Sample>(geometry, test::scalarTypeOf<Sample>(), samples);
            const MemorySamples<Sample> reader(grid);
            const BrickGrid bricks(dims);
            const glm::vec3 inverse(1.0f, 0.4f, 2.5f);
            for (std::uint64_t number = 0; number < bricks.brickCount(); ++number) {
                const BrickIndex brick{number};
                const SampleRows<Sample> rows = reader.rows(brick);
                const auto plain = std::make_unique<BrickPoints<Sample>>(),
                           fast = std::make_unique<BrickPoints<Sample>>();
                readPointsReference(rows, inverse, *plain);
                readPoints(rows, inverse, *fast);
                for (unsigned p = 0; p < kClosedPoints; ++p) {
                    const auto at = coordsOf(ClosedPoint(p));
                    if (at[0] >= rows.end[0] || at[1] >= rows.end[1] || at[2] >= rows.end[2])
                        continue;
                    ASSERT_EQ(fast->samples[p], plain->samples[p]) << "point " << p << ", brick " << number;
                    ASSERT_EQ(fast->normals[p], plain->normals[p])
                        << "point " << p << ", kind " << kind << ", brick " << number << " of " << dims[0] << " "
                        << dims[1] << " " << dims[2];
                }
                // What stands elsewhere disturbs no comparison.
                const auto [least, greatest] = std::minmax_element(plain->samples, plain->samples + kKeptPoints);
                for (const auto sample : fast->samples) {
                    ASSERT_GE(sample, *least);
                    ASSERT_LE(sample, *greatest);
                }
            }
        }
}

TEST_P(LiveKernels, ReadThePointsAndTheNormalsThatGradientsGive) {
    expectPoints<std::uint8_t>(random_);
    expectPoints<std::int8_t>(random_);
    expectPoints<std::uint16_t>(random_);
    expectPoints<std::int16_t>(random_);
    expectPoints<std::int32_t>(random_);
    expectPoints<float>(random_);
    expectPoints<double>(random_);
}

template <class Live>
void expectVertices(std::mt19937& random) {
    std::vector<EdgeRecord<Live>> records;
    for (int k = 0; k < 333; ++k) {
        const ClosedPoint start(random() % kClosedPoints);
        const Live low = k % 7 == 0 ? std::numeric_limits<Live>::lowest() : static_cast<Live>(random() % 100);
        const Live high = k % 11 == 0 ? std::numeric_limits<Live>::max() : static_cast<Live>(100 + random() % 100);
        const auto code = [&] {
            return k % 5 == 0
                       ? kNoNormal
                       : encodeNormal({static_cast<float>(random() % 9) - 4.0f, static_cast<float>(random() % 9) - 4.0f,
                                       static_cast<float>(random() % 9) - 4.0f});
        };
        const NormalCode first = code(), second = code();
        const ClosedEdge edge = closedEdge(static_cast<int>(random() % 3), start);
        const auto level = static_cast<std::uint16_t>(random() % 4);
        records.push_back(random() % 2 ? EdgeRecord<Live>{edge, level, first, second, low, high}
                                       : EdgeRecord<Live>{edge, level, first, second, high, low});
    }
    const std::array<std::int32_t, 3> origin{8, 1600, 64};
    for (const std::uint32_t count : {0u, 1u, 7u, 16u, 17u, 333u}) {
        std::vector<VertexGroup<Live>> groups(groupCount(count));
        for (std::uint32_t k = 0; k < count; ++k) {
            VertexGroup<Live>& group = groups[k / kGroupSize];
            const std::size_t lane = k % kGroupSize;
            group.lower[lane] = records[k].scalar1;
            group.upper[lane] = records[k].scalar2;
            group.normals[lane] = records[k].normal1 | static_cast<std::uint32_t>(records[k].normal2) << 16;
            group.codes[lane] = vertexCode(records[k].edge, records[k].levelOrUpperZ);
        }
        std::vector<glm::vec3> positions(count), normals(count);
        placeVertices<Live>(groups.data(), count, origin, static_cast<Live>(100),
                            {positions.data(), normals.data(), count});
        for (std::uint32_t k = 0; k < count; ++k) {
            const MeshVertex plain = vertexOf<Live>(records[k], origin, static_cast<Live>(100));
            ASSERT_EQ(positions[k], plain.position) << k;
            ASSERT_EQ(normals[k], plain.normal) << k;
        }
    }
}

TEST_P(LiveKernels, InterpolateVerticesAsOneByOne) {
    expectVertices<float>(random_);
    expectVertices<double>(random_);
}

// Noise has cells of all 256 signs; each ambiguous one gets some state of its signs.
TEST_P(LiveKernels, WriteTheTrianglesThatTheStatesHave) {
    std::vector<std::vector<cell::StateId>> statesOf(256);
    for (std::size_t s = 0; s < cell::cellStates().size(); ++s)
        if (s >= 256 || !cell::isAmbiguous(static_cast<std::uint8_t>(s)))
            statesOf[cell::cellStates()[s].signs].push_back(static_cast<cell::StateId>(s));
    std::array<bool, 256> seen{};
    for (int round = 0; round < 30; ++round) {
        ClassifiedBrick<float> found;
        classify(samplesOf<float>(0, random_).values, 100.0f, innerMasks(), {}, found);
        CellList list;
        listCells(found.active.cells, found.above, list);
        VertexTable table;
        for (std::uint16_t& number : table.numbers)
            number = static_cast<std::uint16_t>(random_());
        std::uint32_t ambiguous = 0;
        for (std::uint32_t k = 0; k < list.count; ++k) {
            seen[list.signs[k]] = true;
            ASSERT_EQ(list.states[k], list.signs[k]);
            if (!cell::isAmbiguous(list.signs[k]))
                continue;
            list.states[k] = statesOf[list.signs[k]][random_() % statesOf[list.signs[k]].size()];
            ASSERT_EQ(list.ambiguous[ambiguous++], k);
        }
        ASSERT_EQ(ambiguous, list.ambiguousCount);
        const auto expectAsPlain = [&] {
            std::vector<std::uint16_t> fast(list.count * kMaxCellIndices + kIndexOverrun), plain(fast.size());
            fast.resize(writeTriangles(list, 5000, table, fast.data()));
            plain.resize(writeTrianglesReference(list, 5000, table, plain.data()));
            ASSERT_EQ(fast, plain);
        };
        ASSERT_NO_FATAL_FAILURE(expectAsPlain());
        // And where few are ambiguous, as in smooth data: two of them.
        std::uint32_t kept = 0;
        list.ambiguousCount = 0;
        for (std::uint32_t k = 0; k < list.count; ++k) {
            const bool isAmbiguous = cell::isAmbiguous(list.signs[k]);
            if (isAmbiguous && (list.ambiguousCount == 2 || kept < 20 * (list.ambiguousCount + 1)))
                continue;
            list.cells[kept] = list.cells[k];
            list.signs[kept] = list.signs[k];
            list.states[kept] = list.states[k];
            if (isAmbiguous)
                list.ambiguous[list.ambiguousCount++] = static_cast<std::uint16_t>(kept);
            ++kept;
        }
        list.count = kept;
        ASSERT_EQ(list.ambiguousCount, 2u);
        ASSERT_GT(list.count, 64u);
        ASSERT_NO_FATAL_FAILURE(expectAsPlain());
    }
    EXPECT_GE(std::count(seen.begin(), seen.end(), true), 254);
}

// Each edge is owned by one of the bricks that hold it, in boxes of all remainders and beside missing cells.
TEST(BrickShapes, GiveEveryEdgeOneOwner) {
    std::mt19937 random(3);
    for (const GridDims dims :
         {GridDims{17, 16, 9}, GridDims{8, 24, 10}, GridDims{25, 18, 33}, GridDims{2, 2, 2}, GridDims{12, 9, 17}})
        for (const bool hasMissing : {false, true}) {
            const BrickGrid grid(dims);
            std::vector<index::MissingCells> missing;
            for (const BrickIndex b : firstIds<BrickIndex>(hasMissing ? grid.brickCount() : 0))
                if (random() % 2) {
                    index::MissingCells cells{b, {}};
                    for (std::uint64_t& word : cells.cells)
                        word = random() & random() & (std::uint64_t{random()} << 32 | random());
                    missing.push_back(cells);
                }
            const BrickShapes shapes(dims, missing);
            std::map<std::array<std::int64_t, 4>, int> owners, holders;
            std::uint64_t cells = 0;
            for (const BrickIndex b : firstIds<BrickIndex>(grid.brickCount())) {
                const BrickMasks masks = shapes.isNearMissing(b) ? shapes.masksNearMissing(b) : shapes.masks(b);
                const auto origin = shapes.origin(b);
                cells += static_cast<std::uint64_t>(masks.cells.count());
                EXPECT_TRUE(shapes.hasCells(b) || masks.cells.isEmpty());
                for (int axis = 0; axis < 3; ++axis)
                    forEachSetBit(masks.edges[static_cast<std::size_t>(axis)], [&](ClosedPoint p) {
                        const auto c = coordsOf(p);
                        const std::array<std::int64_t, 4> edge{origin[0] + c[0], origin[1] + c[1], origin[2] + c[2],
                                                               axis};
                        ++holders[edge];
                        owners[edge] += masks.owned[static_cast<std::size_t>(axis)].test(p);
                    });
            }
            for (const auto& [edge, count] : owners)
                ASSERT_EQ(count, 1) << edge[0] << " " << edge[1] << " " << edge[2] << " axis " << edge[3];
            if (!hasMissing) {
                EXPECT_EQ(cells, static_cast<std::uint64_t>((dims[0] - 1) * (dims[1] - 1) * (dims[2] - 1)));
                EXPECT_EQ(holders.size(), static_cast<std::size_t>((dims[0] - 1) * dims[1] * dims[2] +
                                                                   dims[0] * (dims[1] - 1) * dims[2] +
                                                                   dims[0] * dims[1] * (dims[2] - 1)));
            }
        }
}

} // namespace
} // namespace isoslider::extract
