// What is known of surfaces in advance against the surfaces themselves, as OpenMesh counts and measures them.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/cell/cell_states.h"
#include "core/extract/full_extraction.h"
#include "core/mesh/mesh_checks.h"
#include "core/topology/piece_persistence.h"
#include "core/topology/topology_analysis.h"
#include "core/topology/topology_queries.h"
#include "tests/support/result_matchers.h"

namespace isoslider::topology {
namespace {

using test::IsOk;
using Field = std::function<double(double x, double y, double z)>;

ScalarGrid gridOf(const GridDims& dims, const Field& field, glm::dvec3 spacing = glm::dvec3(1.0)) {
    GridGeometry geometry;
    geometry.dims = dims;
    geometry.spacing = spacing;
    std::vector<float> samples;
    for (std::int64_t z = 0; z < dims[2]; ++z)
        for (std::int64_t y = 0; y < dims[1]; ++y)
            for (std::int64_t x = 0; x < dims[0]; ++x)
                samples.push_back(
                    static_cast<float>(field(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z))));
    return ScalarGrid::fromValues<float>(geometry, ScalarType::F32, samples);
}

Field noise(unsigned seed) {
    return [random = std::make_shared<std::mt19937>(seed)](double, double, double) {
        return std::uniform_real_distribution<double>(-1.0, 1.0)(*random);
    };
}

TopologyCurve analysed(const ScalarGrid& grid, const AnalysisOptions& options = {}) {
    auto curve = analyseTopology(planesOf(grid), options);
    EXPECT_THAT(curve, IsOk());
    return curve.isOk() ? std::move(curve).value() : TopologyCurve();
}

mesh::MeshReport meshAt(const ScalarGrid& grid, double isovalue) {
    const auto surface = extract::extractFull(grid, isovalue);
    EXPECT_THAT(surface, IsOk());
    return surface.isOk() ? mesh::checkMesh(surface.value()) : mesh::MeshReport();
}

void expectCountsOfMesh(const ScalarGrid& grid, const TopologyCurve& curve, double isovalue) {
    const mesh::MeshReport mesh = meshAt(grid, isovalue);
    const SurfaceCounts counts = curve.countsAt(isovalue);
    ASSERT_EQ(counts.euler, mesh.euler) << isovalue;
    ASSERT_EQ(counts.components, static_cast<std::int64_t>(mesh.components)) << isovalue;
    ASSERT_EQ(counts.loops, static_cast<std::int64_t>(mesh.boundaryLoops)) << isovalue;
    ASSERT_EQ(counts.handles(), mesh.genus) << isovalue;
}

TEST(CountsOfMeshes, AreThoseOfNoise) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        const ScalarGrid grid = gridOf({16, 16, 16}, noise(seed));
        const TopologyCurve curve = analysed(grid);
        std::mt19937 random(seed);
        for (int i = 0; i < 50; ++i) {
            expectCountsOfMesh(grid, curve, std::uniform_real_distribution<double>(-1.0, 1.0)(random));
            if (HasFatalFailure())
                return;
        }
    }
}

// What is left is a ball with a hollow: the counts are exact, on its boundary too.
TEST(CountsOfMeshes, AreThoseWhereSamplesAreMissing) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        const auto base = noise(seed);
        const ScalarGrid grid = gridOf({14, 13, 37}, [&](double x, double y, double z) {
            const double value = base(x, y, z);
            const bool isCut = x + y < 6.0, isHollow = std::hypot(x - 8, y - 8, z - 16) < 3.0;
            return isCut || isHollow ? std::numeric_limits<double>::quiet_NaN() : value;
        });
        const TopologyCurve curve = analysed(grid);
        AnalysisOptions thin;
        thin.planesAtOnce = 3;
        thin.rowsAtOnce = 1 + static_cast<std::int64_t>(seed);
        thin.boundaryPointsAtOnce = 3;
        EXPECT_EQ(analysed(grid, thin).events().size(), curve.events().size());
        EXPECT_TRUE(curve.areCountsExact());
        std::mt19937 random(seed);
        for (int i = 0; i < 30; ++i) {
            expectCountsOfMesh(grid, curve, std::uniform_real_distribution<double>(-1.0, 1.0)(random));
            if (HasFatalFailure())
                return;
        }
    }
}

// A tunnel where nothing is: a surface round it parts nothing.
TEST(CountsOfMeshes, AreAtLeastThoseStatedWhereWhatIsThereHasATunnel) {
    const auto base = noise(5);
    const ScalarGrid grid = gridOf({13, 13, 13}, [&](double x, double y, double z) {
        const double value = base(x, y, z);
        return std::abs(x - 6) < 2 && std::abs(y - 6) < 2 ? std::numeric_limits<double>::quiet_NaN() : value;
    });
    const TopologyCurve curve = analysed(grid);
    EXPECT_FALSE(curve.areCountsExact());
    std::mt19937 random(5);
    for (int i = 0; i < 30; ++i) {
        const double isovalue = std::uniform_real_distribution<double>(-1.0, 1.0)(random);
        const mesh::MeshReport mesh = meshAt(grid, isovalue);
        EXPECT_EQ(curve.countsAt(isovalue).euler, mesh.euler);
        EXPECT_LE(curve.countsAt(isovalue).components, static_cast<std::int64_t>(mesh.components));
    }
}

// Cells that have an edge of the grid in common and no more: the mesh has a vertex for each, and so have the counts.
TEST(CountsOfMeshes, HaveTheEulerNumberWhereWhatIsThereTouchesItself) {
    int split = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
        const auto base = noise(seed);
        std::mt19937 random(seed);
        const double missing = std::uniform_real_distribution<double>(0.02, 0.2)(random);
        const ScalarGrid grid = gridOf({8, 7, 6}, [&](double x, double y, double z) {
            const bool isMissing = std::uniform_real_distribution<double>(0.0, 1.0)(random) < missing;
            return isMissing ? std::numeric_limits<double>::quiet_NaN() : base(x, y, z);
        });
        const TopologyCurve curve = analysed(grid);
        for (int i = 0; i < 10; ++i) {
            const double isovalue = std::uniform_real_distribution<double>(-1.0, 1.0)(random);
            const mesh::MeshReport mesh = meshAt(grid, isovalue);
            const SurfaceCounts counts = curve.countsAt(isovalue);
            ASSERT_EQ(counts.euler, mesh.euler) << "seed " << seed << " at " << isovalue;
            ASSERT_LE(counts.components, static_cast<std::int64_t>(mesh.components));
            ASSERT_LE(counts.loops, static_cast<std::int64_t>(mesh.boundaryLoops));
            split += counts.components < static_cast<std::int64_t>(mesh.components) ? 1 : 0;
        }
    }
    EXPECT_GT(split, 20);
}

TEST(KnownShapes, HaveTheirCounts) {
    const auto ring = [](double x, double y, double z, double cx) {
        return std::hypot(std::hypot(x - cx, y - 20.1) - 10.0, z - 10.2);
    };
    const auto doubleTorus = analysed(gridOf({61, 41, 21}, [&](double x, double y, double z) {
        return 4.0 - std::min(ring(x, y, z, 18.3), ring(x, y, z, 38.4));
    }));
    EXPECT_EQ(doubleTorus.countsAt(1.5), (SurfaceCounts{1, -2, 0, 0}));
    EXPECT_EQ(doubleTorus.countsAt(1.5).handles(), 2);

    // A gyroid of period 20 through a box of 40: one piece, to the sides of the box.
    const double k = 2.0 * std::numbers::pi / 20.0;
    const ScalarGrid gyroid = gridOf({41, 41, 41}, [k](double x, double y, double z) {
        return std::sin(k * x) * std::cos(k * y) + std::sin(k * y) * std::cos(k * z) +
               std::sin(k * z) * std::cos(k * x);
    });
    const TopologyCurve curve = analysed(gyroid);
    for (const double isovalue : {-1.2, -0.7, 0.013, 0.4, 1.3})
        expectCountsOfMesh(gyroid, curve, isovalue);
    EXPECT_GT(curve.countsAt(0.013).handles(), 10);
}

TEST(PieceChanges, TellWhatHappens) {
    // Two hills of 10 and 7 joined at 4, with a hollow of 1 in the plain of 2 round them; below 0 at the ends.
    const auto curve = analysed(gridOf({31, 9, 9}, [](double x, double y, double z) {
        if (x == 0 || x == 30 || y == 0 || y == 8 || z == 0 || z == 8)
            return 0.0;
        if (x == 27 && y == 4 && z == 4)
            return 1.0;
        if (y != 4 || z != 4)
            return 2.0;
        const std::array<std::pair<double, double>, 4> shape{{{3, 2}, {8, 10}, {13, 4}, {18, 7}}};
        for (std::size_t i = 1; i < shape.size(); ++i)
            if (x >= shape[i - 1].first && x <= shape[i].first)
                return shape[i - 1].second + (x - shape[i - 1].first) / (shape[i].first - shape[i - 1].first) *
                                                 (shape[i].second - shape[i - 1].second);
        return 2.0;
    }));
    std::map<double, PieceChanges> changes;
    for (const TopologyEvent& event : curve.events())
        if (!(event.pieces == PieceChanges()))
            changes[event.isovalue] = event.pieces;
    const std::map<double, PieceChanges> expected{{0, {1, 0, 0, 0}}, {1, {1, 0, 0, 0}}, {2, {0, 0, 1, 0}},
                                                  {4, {0, 0, 0, 1}}, {7, {0, 1, 0, 0}}, {10, {0, 1, 0, 0}}};
    EXPECT_EQ(changes, expected);
}

// What is above an isovalue, by flooding: for each grid point the greatest sample that it hangs together with.
std::vector<float> summits(const ScalarGrid& grid, double isovalue) {
    const auto samples = grid.values<float>();
    const GridDims& dims = grid.dims();
    const auto count = samples.size();
    std::vector<std::vector<std::size_t>> next(count);
    const auto link = [&](std::size_t a, std::size_t b) {
        next[a].push_back(b);
        next[b].push_back(a);
    };
    for (std::int64_t z = 0; z + 1 < dims[2]; ++z)
        for (std::int64_t y = 0; y + 1 < dims[1]; ++y)
            for (std::int64_t x = 0; x + 1 < dims[0]; ++x) {
                std::array<std::size_t, 8> at{};
                cell::CornerScalars scalars{};
                unsigned signs = 0;
                for (unsigned c = 0; c < 8; ++c) {
                    at[c] =
                        static_cast<std::size_t>(x + (c & 1) + dims[0] * (y + (c >> 1 & 1) + dims[1] * (z + (c >> 2))));
                    scalars[c] = samples[at[c]];
                    signs |= (scalars[c] >= isovalue ? 1u : 0u) << c;
                }
                for (const auto& edge : cell::kCellEdges)
                    link(at[edge.lowerCorner], at[edge.upperCorner]);
                if (!cell::isAmbiguous(static_cast<std::uint8_t>(signs)))
                    continue;
                const auto id = cell::resolveCell(static_cast<std::uint8_t>(signs), scalars, isovalue).state;
                const cell::CellState& state = cell::cellStates()[id];
                for (std::size_t face = 0; face < 6; ++face)
                    if ((state.joinedFaces >> face & 1) != 0) {
                        const auto& c = cell::kFaceCorners[face];
                        link(at[c[0]], at[c[2]]); // of these two pairs one is above
                        link(at[c[1]], at[c[3]]);
                    }
                if (state.tunnel == cell::Tunnel::Above)
                    for (unsigned c = 1; c < 8; c <<= 1) // the ends of the diagonal, and what is round them
                        for (const unsigned d : {0u, c}) {
                            link(at[state.diagonal], at[state.diagonal ^ c]);
                            link(at[state.diagonal ^ d], at[(7u - state.diagonal) ^ d]);
                            link(at[state.diagonal ^ d], at[7u - state.diagonal]);
                            link(at[state.diagonal], at[(7u - state.diagonal) ^ d]);
                        }
            }
    std::vector<float> summit(count, -std::numeric_limits<float>::infinity());
    std::vector<bool> isSeen(count);
    for (std::size_t start = 0; start < count; ++start) {
        if (isSeen[start] || samples[start] < isovalue)
            continue;
        std::vector<std::size_t> reached{start};
        isSeen[start] = true;
        float greatest = samples[start];
        for (std::size_t i = 0; i < reached.size(); ++i)
            for (const std::size_t other : next[reached[i]])
                if (!isSeen[other] && samples[other] >= isovalue) {
                    isSeen[other] = true;
                    reached.push_back(other);
                    greatest = std::max(greatest, samples[other]);
                }
        for (const std::size_t at : reached)
            summit[at] = greatest;
    }
    return summit;
}

// By the summit's scalar: through how many values it lasts. Isovalues fall through all events and samples: at each,
// whose summit is another one has joined it.
std::map<double, double> lastingSummits(const ScalarGrid& grid, const TopologyCurve& curve) {
    const auto samples = grid.values<float>();
    std::vector<double> isovalues(samples.begin(), samples.end());
    for (const TopologyEvent& event : curve.events())
        isovalues.push_back(event.isovalue);
    std::sort(isovalues.begin(), isovalues.end(), std::greater<>());
    std::map<double, double> lasting;
    for (const double isovalue : isovalues) {
        const std::vector<float> summit = summits(grid, isovalue);
        for (std::size_t i = 0; i < samples.size(); ++i)
            if (samples[i] >= isovalue && summit[i] != samples[i])
                lasting.try_emplace(samples[i], static_cast<double>(samples[i]) - isovalue);
    }
    std::erase_if(lasting, [](const auto& each) { return each.second == 0.0; });
    const auto [least, greatest] = std::minmax_element(samples.begin(), samples.end());
    lasting[*greatest] = static_cast<double>(*greatest) - static_cast<double>(*least);
    return lasting;
}

TEST(Persistence, IsThatOfAMergeTreeMadeByFlooding) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        const ScalarGrid grid = gridOf({6, 5, 7}, noise(seed));
        AnalysisOptions thin;
        thin.planesAtOnce = 3;
        thin.rowsAtOnce = 2;
        thin.boundaryPointsAtOnce = 3;
        const TopologyCurve curve = analysed(grid, thin);
        const std::map<double, double> lasting = lastingSummits(grid, curve);
        std::map<double, double> found;
        for (const TopologyEvent& event : curve.events())
            if (event.pieces.deaths > 0)
                found[event.isovalue] = event.persistence;
        EXPECT_GT(lasting.size(), 10u);
        EXPECT_EQ(found, lasting) << "seed " << seed;
    }
}

PersistenceOptions wholeOf(const ScalarGrid& grid) {
    const auto samples = grid.values<float>();
    const auto [least, greatest] = std::minmax_element(samples.begin(), samples.end());
    return {static_cast<double>(*least), static_cast<double>(*greatest)};
}

TEST(PiecePersistence, IsThatOfTheRegionThatLastsShorter) {
    std::size_t ofAbove = 0, ofBelow = 0;
    for (unsigned seed = 1; seed <= 2; ++seed) {
        const auto grid = std::make_shared<const ScalarGrid>(gridOf({6, 5, 7}, noise(seed)));
        const auto values = grid->values<float>();
        std::size_t next = 0;
        const ScalarGrid turned =
            gridOf(grid->dims(), [&](double, double, double) { return -static_cast<double>(values[next++]); });
        const auto peaks = lastingSummits(*grid, analysed(*grid)), pits = lastingSummits(turned, analysed(turned));
        const auto samples = index::makeSampleBlocks(grid);
        const GridDims& dims = grid->dims();
        for (const double isovalue : {-0.6, -0.25, 0.01, 0.3, 0.7}) {
            const std::vector<float> summit = summits(*grid, isovalue), pit = summits(turned, -isovalue);
            for (std::int32_t z = 0; z < dims[2]; ++z)
                for (std::int32_t y = 0; y < dims[1]; ++y)
                    for (std::int32_t x = 0; x + 1 < dims[0]; ++x) {
                        const auto at = static_cast<std::size_t>(x + dims[0] * (y + dims[1] * z));
                        const bool isFirstAbove = values[at] >= isovalue;
                        if (isFirstAbove == (values[at + 1] >= isovalue))
                            continue;
                        const auto found = persistenceOfPiece(*samples, {{x, y, z}, 0}, isovalue, wholeOf(*grid), {});
                        ASSERT_THAT(found, IsOk());
                        const double above = peaks.at(summit[isFirstAbove ? at : at + 1]),
                                     below = pits.at(pit[isFirstAbove ? at + 1 : at]);
                        EXPECT_NEAR(found.value().persistence, std::min(above, below), 1e-12)
                            << seed << ' ' << isovalue;
                        EXPECT_FALSE(found.value().isAtLeast);
                        ++(found.value().side == Side::Above ? ofAbove : ofBelow);
                    }
        }
    }
    EXPECT_GT(ofAbove, 50u);
    EXPECT_GT(ofBelow, 50u);
}

// Two peaks of equal height on a ridge, on a plain; on request no samples between them.
std::shared_ptr<const ScalarGrid> twinPeaks(bool arePartedByMissing) {
    return std::make_shared<const ScalarGrid>(gridOf({40, 20, 18}, [&](double x, double y, double z) {
        if (arePartedByMissing && x == 20)
            return std::numeric_limits<double>::quiet_NaN();
        const bool isOnRidge = y == 10 && z == 8 && x > 4 && x < 36;
        return (x == 8 || x == 32) && isOnRidge ? 8.0 : isOnRidge ? 5.0 : 0.0;
    }));
}

TEST(PiecePersistence, OfEqualPeaksTheFirstOneIsTheElder) {
    const auto grid = twinPeaks(false);
    const auto samples = index::makeSampleBlocks(grid);
    const PersistenceOptions options{0.0, 8.0};
    const auto first = persistenceOfPiece(*samples, {{7, 10, 8}, 0}, 6.5, options),
               second = persistenceOfPiece(*samples, {{32, 10, 8}, 1}, 6.5, options);
    ASSERT_THAT(first, IsOk());
    ASSERT_THAT(second, IsOk());
    EXPECT_EQ(first.value().persistence, 8.0);
    EXPECT_TRUE(first.value().lasts);
    EXPECT_EQ(second.value().persistence, 3.0);
    EXPECT_EQ(second.value().comes, 8.0);
    EXPECT_EQ(second.value().ends, 5.0);
    EXPECT_EQ(second.value().side, Side::Above);
}

TEST(PiecePersistence, EndsWhereSamplesAreMissing) {
    const auto samples = index::makeSampleBlocks(twinPeaks(true));
    const auto second = persistenceOfPiece(*samples, {{32, 10, 8}, 1}, 6.5, {0.0, 8.0});
    ASSERT_THAT(second, IsOk());
    EXPECT_TRUE(second.value().lasts);
    EXPECT_EQ(second.value().persistence, 8.0);
}

TEST(PiecePersistence, StatesALeastOfWhatIsTooLarge) {
    const auto samples = index::makeSampleBlocks(twinPeaks(false));
    PersistenceOptions options{0.0, 8.0};
    options.mostPoints = 3; // the peak, and two of the ridge
    const auto second = persistenceOfPiece(*samples, {{32, 10, 8}, 1}, 6.5, options);
    ASSERT_THAT(second, IsOk());
    EXPECT_TRUE(second.value().isAtLeast);
    EXPECT_GE(second.value().persistence, 1.5); // from the peak to the isovalue
    EXPECT_LE(second.value().persistence, 3.0);
}

TEST(PiecePersistence, OfAnEdgeOfAMergedCellIsThatOfTheEdgeThatIsCrossed) {
    const auto samples = index::makeSampleBlocks(twinPeaks(false));
    const auto along = persistenceOfPiece(*samples, {{28, 10, 8}, 0}, 6.5, {0.0, 8.0});
    ASSERT_THAT(along, IsOk());
    EXPECT_EQ(along.value().persistence, 3.0);
    EXPECT_FALSE(persistenceOfPiece(*samples, {{0, 0, 0}, 0}, 6.5, {0.0, 8.0}).isOk());
}

// All edges that the surface crosses stand for its pieces, each many times over.
std::vector<PieceVertex> crossedEdges(const ScalarGrid& grid, double isovalue) {
    std::vector<PieceVertex> crossed;
    const GridDims& dims = grid.dims();
    for (std::int64_t z = 0; z < dims[2]; ++z)
        for (std::int64_t y = 0; y < dims[1]; ++y)
            for (std::int64_t x = 0; x < dims[0]; ++x)
                for (int axis = 0; axis < 3; ++axis) {
                    const std::int64_t end[3] = {x + (axis == 0), y + (axis == 1), z + (axis == 2)};
                    if (end[0] < dims[0] && end[1] < dims[1] && end[2] < dims[2] &&
                        (grid.valueAt(x, y, z) >= isovalue) != (grid.valueAt(end[0], end[1], end[2]) >= isovalue))
                        crossed.push_back(
                            {{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), static_cast<std::int32_t>(z)},
                             axis});
                }
    return crossed;
}

TEST(ShortLivedPieces, AreThoseOfLessPersistence) {
    constexpr std::size_t kCompared = 19; // every so many: walks to the ends take long
    std::size_t shortLived = 0, lasting = 0;
    for (unsigned seed = 1; seed <= 3; ++seed) {
        // Samples of few values, so that persistences are equal to what is asked.
        const auto base = noise(seed);
        const auto grid = std::make_shared<const ScalarGrid>(gridOf({9, 8, 10}, [&](double x, double y, double z) {
            return seed == 3 ? std::round(4.0 * base(x, y, z)) / 4.0 : base(x, y, z);
        }));
        const auto samples = index::makeSampleBlocks(grid);
        const PersistenceOptions options = wholeOf(*grid);
        for (const double isovalue : {-0.4, 0.2}) {
            std::vector<PieceVertex> pieces = crossedEdges(*grid, isovalue);
            std::shuffle(pieces.begin(), pieces.end(), std::minstd_rand(seed)); // known regions are met in any order
            std::vector<double> persistences;
            for (std::size_t i = 0; i < pieces.size(); i += kCompared)
                persistences.push_back(persistenceOfPiece(*samples, pieces[i], isovalue, options).value().persistence);
            for (const double least : {0.0, 0.25, 0.5, 1.0, options.greatest - options.least, 9.0}) {
                const auto found = findShortLivedPieces(*samples, pieces, isovalue, least, options);
                ASSERT_THAT(found, IsOk());
                EXPECT_TRUE(found.value().isComplete);
                ASSERT_EQ(found.value().isShortLived.size(), pieces.size());
                for (std::size_t i = 0; i < persistences.size(); ++i) {
                    EXPECT_EQ(found.value().isShortLived[kCompared * i], persistences[i] < least)
                        << persistences[i] << ' ' << least << ' ' << isovalue << ' ' << seed;
                    ++(persistences[i] < least ? shortLived : lasting);
                }
            }
        }
    }
    EXPECT_GT(shortLived, 100u);
    EXPECT_GT(lasting, 100u);
}

TEST(ShortLivedPieces, AreNotWalkedOnForEver) {
    const auto grid = std::make_shared<const ScalarGrid>(gridOf({20, 20, 20}, noise(7)));
    const auto samples = index::makeSampleBlocks(grid);
    PersistenceOptions options = wholeOf(*grid);
    const std::vector<PieceVertex> pieces = crossedEdges(*grid, 0.0);
    const double least = options.greatest - options.least;
    const auto exact = findShortLivedPieces(*samples, pieces, 0.0, least, options);
    options.mostPoints = 40;
    const auto bounded = findShortLivedPieces(*samples, pieces, 0.0, least, options);
    options.mostPoints = std::uint64_t{1} << 19;
    options.mostPointsInAll = 1000;
    const auto boundedInAll = findShortLivedPieces(*samples, pieces, 0.0, least, options);
    for (const auto* found : {&bounded, &boundedInAll}) {
        ASSERT_THAT(*found, IsOk());
        EXPECT_FALSE(found->value().isComplete);
        for (std::size_t i = 0; i < pieces.size(); ++i)
            EXPECT_TRUE(exact.value().isShortLived[i] || !found->value().isShortLived[i]) << "hides what lasts";
    }
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_THAT(findShortLivedPieces(*samples, pieces, 0.0, least, options, job), test::HasError(ErrorCode::Cancelled));
}

// ---- curves

// Of surfaces that are closed: of others the mesh encloses nothing.
void expectMeasuresOfMesh(const ScalarGrid& grid, const MeasureCurves& curves, std::size_t at, double share) {
    const double isovalue = curves.isovalues[at];
    const mesh::MeshReport mesh = meshAt(grid, isovalue);
    const SurfaceMeasures& measures = curves.measures[at];
    ASSERT_TRUE(mesh.isClosed);
    EXPECT_NEAR(measures.area, mesh.area, share * mesh.area) << isovalue;
    EXPECT_NEAR(measures.volume, std::abs(mesh.enclosedVolume), share * std::abs(mesh.enclosedVolume)) << isovalue;
    EXPECT_NEAR(measures.triangles, static_cast<double>(mesh.triangles), share * static_cast<double>(mesh.triangles));
}

TEST(MeasureCurves, AreThoseOfMeshes) {
    const auto base = noise(3);
    const glm::dvec3 spacing{0.5, 1.25, 2.0};
    const ScalarGrid closed = gridOf(
        {20, 22, 24},
        [&](double x, double y, double z) {
            const double value = base(x, y, z);
            return x < 1 || y < 1 || z < 1 || x > 18 || y > 20 || z > 22 ? -1.5 : value;
        },
        spacing);
    AnalysisOptions options;
    options.rowsAtOnce = 5;
    options.measures = planMeasures(closed);
    const MeasureCurves noisy = analysed(closed, options).curves();
    ASSERT_GT(noisy.isovalues.size(), 200u);
    for (std::size_t i = 1; i < noisy.isovalues.size(); i += 23)
        if (noisy.measures[i].triangles > 0)
            expectMeasuresOfMesh(closed, noisy, i, 5e-4); // the mesh keeps vertices a little apart

    const ScalarGrid sphere = gridOf(
        {41, 41, 41}, [](double x, double y, double z) { return 19.0 - std::hypot(x - 20.1, y - 19.9, z - 20.2); });
    options.measures = planMeasures(sphere);
    const MeasureCurves curves = analysed(sphere, options).curves();
    const SurfaceMeasures at = curves.at(9.0);
    EXPECT_NEAR(at.area, 4 * std::numbers::pi * 100, 0.005 * at.area);
    EXPECT_NEAR(at.volume, 4.0 / 3.0 * std::numbers::pi * 1000, 0.01 * at.volume);
    EXPECT_NEAR(at.gradient, 1.0, 0.01);
}

TEST(MeasureCurves, OfAFewCellsAreNearThoseOfAll) {
    const double k = 2.0 * std::numbers::pi / 31.0;
    const auto base = noise(9);
    for (const bool isNoisy : {false, true}) {
        const ScalarGrid grid = gridOf({80, 80, 80}, [&](double x, double y, double z) {
            const double border = std::min({x, y, z, 79 - x, 79 - y, 79 - z});
            const double wave =
                std::sin(k * x) + std::sin(k * y + 1) + std::sin(k * z + 2) + (isNoisy ? base(x, y, z) : 0.0);
            return border < 1 ? -4.5 : wave;
        });
        AnalysisOptions options;
        options.measures = planMeasures(grid);
        for (double& share : options.measures.shares)
            share = isNoisy ? 0.4 : 0.2;
        const MeasureCurves curves = analysed(grid, options).curves();
        for (const std::size_t at : {80u, 120u, 160u, 190u})
            expectMeasuresOfMesh(grid, curves, at, 0.01);
    }
}

/// A ball of radius 16 with 20 in its middle, 4 in its wall and 0 around it; on request two samples far away.
ScalarGrid ballInNothing(bool hasOutliers, double noiseHeight = 0.0) {
    const auto base = noise(5);
    return gridOf({56, 56, 56}, [&](double x, double y, double z) {
        if (hasOutliers && x == 4 && z == 4 && (y == 4 || y == 40))
            return y == 4 ? 3e37 : -9999.0;
        const double r = std::hypot(x - 27.6, y - 27.4, z - 27.5);
        return 4.0 / (1.0 + std::exp(2.0 * (r - 16.0))) + 16.0 * std::exp(-r * r / 60.0) + noiseHeight * base(x, y, z);
    });
}

TEST(MeasureCurves, WithOutliersAreThoseOfMeshesToo) {
    const ScalarGrid grid = ballInNothing(true);
    AnalysisOptions options;
    options.measures = planMeasures(grid);
    const TopologyCurve found = analysed(grid, options);
    for (const double isovalue : {1.0, 3.0, 10.0, 18.0}) {
        const mesh::MeshReport mesh = meshAt(grid, isovalue);
        EXPECT_NEAR(found.curves().at(isovalue).area, mesh.area, 0.01 * mesh.area) << isovalue;
        EXPECT_LT(found.curves().at(isovalue).gradient, 5.0) << "the outlier's cells do not count";
        EXPECT_GT(found.curves().at(isovalue).gradient, 0.5);
    }
    EXPECT_GT(found.curves().at(1e36).gradient, 1e36) << "there are no others";
    const auto suggested = suggestIsovalues(found);
    ASSERT_TRUE(suggested.isOk());
    ASSERT_GE(suggested.value().size(), 2u);
    for (const Suggestion& one : suggested.value())
        if (one.reason == SuggestionReason::StrongestGradient || one.reason == SuggestionReason::WidestInterval) {
            EXPECT_GT(one.isovalue, 0.1) << reasonText(one.reason);
            EXPECT_LT(one.isovalue, 40.0) << reasonText(one.reason);
        }
}

// Labels: most samples have the least value, and many one of the others.
TEST(MeasureCurves, AreKnownOnBothSidesOfValuesThatManySamplesHave) {
    const ScalarGrid labels = gridOf({40, 40, 40}, [](double x, double y, double z) {
        const double r = std::hypot(x - 19.6, y - 19.4, z - 19.5);
        return r < 9.0 ? 2.0 : r < 15.0 ? 1.0 : 0.0;
    });
    AnalysisOptions options;
    options.measures = planMeasures(labels);
    const MeasureCurves curves = analysed(labels, options).curves();
    for (const double isovalue : {nextAbove(0.0), 0.5, 1.0, nextAbove(1.0), 1.5, 2.0}) {
        const auto at = std::lower_bound(curves.isovalues.begin(), curves.isovalues.end(), isovalue);
        if (isovalue != 0.5 && isovalue != 1.5) {
            ASSERT_NE(at, curves.isovalues.end());
            EXPECT_EQ(*at, isovalue);
        }
        const mesh::MeshReport mesh = meshAt(labels, isovalue);
        const SurfaceMeasures found = curves.at(isovalue);
        EXPECT_NEAR(found.area, mesh.area, 0.01 * mesh.area) << isovalue;
        EXPECT_NEAR(found.volume, std::abs(mesh.enclosedVolume), 0.01 * std::abs(mesh.enclosedVolume)) << isovalue;
    }
    EXPECT_EQ(curves.at(0.0).area, 0.0);
    EXPECT_EQ(curves.at(nextAbove(2.0)).area, 0.0);
    // No isovalue has an area that the surface jumps over.
    const double small = curves.at(nextAbove(1.0)).area, large = curves.at(1.0).area;
    ASSERT_LT(1.2 * small, large);
    for (const double isovalue : isovaluesWith(curves, &SurfaceMeasures::area, 0.5 * (small + large)))
        EXPECT_NEAR(curves.at(isovalue).area, 0.5 * (small + large), 1e-6 * large);
    EXPECT_TRUE(isovaluesWith(curves, &SurfaceMeasures::area, 0.5 * curves.at(2.0).area).empty());
}

// A few voxels in a large volume: those that the plan looks at may all be of the background.
TEST(MeasureCurves, AreThereWhereHardlyAnySampleDiffers) {
    const ScalarGrid sparse = gridOf({70, 70, 70}, [](double x, double y, double z) {
        return x > 33 && x < 37 && y > 33 && y < 37 && z > 34 && z < 37 ? 4.0 : 0.0;
    });
    AnalysisOptions options;
    options.measures = planMeasures(sparse);
    const MeasureCurves curves = analysed(sparse, options).curves();
    const mesh::MeshReport mesh = meshAt(sparse, 2.0);
    ASSERT_FALSE(curves.isEmpty());
    EXPECT_NEAR(curves.at(2.0).area, mesh.area, 0.01 * mesh.area);
    EXPECT_NEAR(curves.at(2.0).triangles, static_cast<double>(mesh.triangles), 0.5);
}

// Around its object a scan has noise, whose surface is larger than any other.
TEST(MeasureCurves, TheSteepestSurfaceIsNotThatOfNoise) {
    const ScalarGrid plain = ballInNothing(false), noisy = ballInNothing(false, 0.05);
    std::array<double, 2> steepest{};
    for (const ScalarGrid* grid : {&plain, &noisy}) {
        AnalysisOptions options;
        options.measures = planMeasures(*grid);
        const TopologyCurve found = analysed(*grid, options);
        const auto suggested = suggestIsovalues(found);
        ASSERT_TRUE(suggested.isOk());
        ASSERT_EQ(suggested.value().front().reason, SuggestionReason::StrongestGradient);
        steepest[grid == &noisy] = suggested.value().front().isovalue;
    }
    EXPECT_NEAR(steepest[1], steepest[0], 2.0);
    EXPECT_GT(steepest[1], 1.0);
}

TEST(MeasureCurves, AreLinearBetweenIsovaluesAndConstantBeyond) {
    const MeasureCurves curves{{1.0, 3.0}, {{10, 100, 1000, 1}, {20, 50, 2000, 3}}};
    EXPECT_EQ(curves.at(2.0).area, 15);
    EXPECT_EQ(curves.at(2.5).volume, 62.5);
    EXPECT_EQ(curves.at(0.0).triangles, 1000);
    EXPECT_EQ(curves.at(9.0).gradient, 3);
    EXPECT_EQ(MeasureCurves().at(1.0).area, 0);
}

} // namespace
} // namespace isoslider::topology
