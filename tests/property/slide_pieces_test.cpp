// The pieces of a live surface are those of its mesh, however it was slid to, and keep their numbers on the way.

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "core/extract/live/brick_picture.h"
#include "core/extract/pieces/kept_pieces.h"
#include "core/extract/pieces/piece_measures.h"
#include "core/extract/pieces/surface_pieces.h"
#include "core/mesh/mesh_checks.h"
#include "core/mesh/triangle_soup.h"
#include "tests/property/random_volumes.h"
#include "tests/property/slide_ways.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::extract {
namespace {

using test::IsOk;

// Triangles of each connected part of a mesh, most first: by the definition, over shared vertices.
std::vector<std::uint64_t> partSizes(const std::vector<std::uint32_t>& triangles, std::size_t vertices) {
    std::vector<std::uint32_t> parents(vertices);
    std::iota(parents.begin(), parents.end(), 0u);
    const auto rootOf = [&](std::uint32_t v) {
        while (parents[v] != v)
            v = parents[v] = parents[parents[v]];
        return v;
    };
    for (std::size_t i = 0; i < triangles.size(); i += 3)
        for (const std::size_t k : {i + 1, i + 2})
            parents[rootOf(triangles[k])] = rootOf(triangles[i]);
    std::map<std::uint32_t, std::uint64_t> counts;
    for (std::size_t i = 0; i < triangles.size(); i += 3)
        ++counts[rootOf(triangles[i])];
    std::vector<std::uint64_t> sizes;
    for (const auto& [root, count] : counts)
        sizes.push_back(count);
    std::sort(sizes.rbegin(), sizes.rend());
    return sizes;
}

SurfaceFrame frameOf(SlideEngine& engine) {
    SurfaceFrame frame;
    engine.copyFrame(frame, {.pieces = true});
    return frame;
}

// The piece of each vertex of the frame's arrays; none for a vertex without triangles.
std::vector<std::uint32_t> piecesOfVertices(const SurfacePieces& pieces) {
    std::vector<std::uint32_t> found;
    for (std::size_t slot = 0; slot < pieces.slotCount(); ++slot)
        if (pieces.parts(slot) != nullptr)
            for (const std::uint16_t part : pieces.parts(slot)->partOf)
                found.push_back(part == BrickParts::kNone ? ~0u : pieces.piecesOf(slot)[part]);
    return found;
}

void expectPiecesOfMesh(SlideEngine& engine) {
    const auto mesh = engine.mesh();
    ASSERT_THAT(mesh, IsOk());
    SurfaceFrame frame = frameOf(engine);
    ASSERT_NE(frame.pieces, nullptr);
    const auto pieces = frame.pieces->pieces();
    std::vector<std::uint64_t> sizes;
    std::set<PieceId> ids;
    for (const Piece& piece : pieces) {
        sizes.push_back(piece.triangles);
        ids.insert(piece.id);
    }
    ASSERT_EQ(ids.size(), pieces.size());
    ASSERT_EQ(sizes, partSizes(mesh.value().triangles, mesh.value().positions.size()));
    expandPicture(frame);
    const auto pieceOf = piecesOfVertices(*frame.pieces);
    ASSERT_EQ(pieceOf.size(), frame.positions.size());
    std::vector<std::uint64_t> triangles(pieces.size(), 0);
    for (std::size_t i = 0; i < frame.indices.size(); i += 3) {
        const std::uint32_t piece = pieceOf[frame.indices[i]];
        ASSERT_LT(piece, pieces.size());
        ++triangles[piece];
        for (std::size_t k = i; k < i + 3; ++k) {
            ASSERT_EQ(pieceOf[frame.indices[k]], piece);
            const glm::vec3 at = frame.positions[frame.indices[k]];
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_GE(at[axis], static_cast<float>(pieces[piece].low[static_cast<std::size_t>(axis)]));
                ASSERT_LE(at[axis], static_cast<float>(pieces[piece].high[static_cast<std::size_t>(axis)]));
            }
        }
    }
    EXPECT_EQ(triangles, sizes);
}

TEST(SlidePieces, AreThoseOfTheMeshOnEveryWay) {
    const std::uint64_t base = test::testSeed(5150);
    int compared = 0;
    for (std::uint64_t seed = base; seed < base + 60; ++seed) {
        test::Random random(seed);
        const test::RandomVolume volume = test::randomVolume(random, 30);
        if (!volume.hasFinite)
            continue;
        SCOPED_TRACE("seed " + std::to_string(seed) + ": " + volume.description);
        const test::TemporaryFolder folder;
        auto ways = test::allWays(volume.grid, folder.path());
        double isovalue = volume.min;
        for (int stop = 0; stop < 6; ++stop) {
            isovalue = test::nextIsovalue(volume, isovalue, random);
            for (const test::Way& way : ways) {
                SCOPED_TRACE(way.name + " at " + std::to_string(isovalue));
                ASSERT_THAT(way.engine->slideTo(isovalue), IsOk());
                ASSERT_NO_FATAL_FAILURE(expectPiecesOfMesh(*way.engine));
                ++compared;
            }
        }
    }
    EXPECT_GT(compared, 500);
}

TEST(SlidePieces, AreThoseOfTheMeshWithMergedCells) {
    const auto grid = test::noiseVolume({33, 30, 27}, 7, 200);
    auto engine = preprocess::makeMemoryEngine(grid);
    ASSERT_THAT(engine, IsOk());
    std::uint64_t merged = 0;
    for (const double bound : {0.1, 0.5, 4.0}) {
        engine.value()->setMergeBound({MergeBound::Measure::Distance, bound});
        for (const double isovalue : {3.5, 20.5, 100.5, 101.5, 190.5}) {
            const auto stats = engine.value()->slideTo(isovalue);
            ASSERT_THAT(stats, IsOk());
            merged += stats.value().activeLeaves[1] + stats.value().activeLeaves[2];
            ASSERT_NO_FATAL_FAILURE(expectPiecesOfMesh(*engine.value()));
        }
    }
    EXPECT_GT(merged, 100u);
}

// Two hills of different height, and a speck.
std::shared_ptr<const ScalarGrid> hills() {
    GridGeometry geometry;
    geometry.dims = {64, 41, 41};
    return test::makeVolume<float>(ScalarType::F32, geometry, [](std::int64_t x, std::int64_t y, std::int64_t z) {
        const glm::dvec3 p(x, y, z);
        const auto hill = [&](double middleX, double middleY, double height, double width) {
            const glm::dvec3 d = p - glm::dvec3(middleX, middleY, 20.0);
            return height - (d.x * d.x + d.y * d.y + d.z * d.z) / width;
        };
        return std::max({hill(18.0, 20.0, 100.0, 1.0), hill(44.0, 20.0, 90.0, 1.0), hill(57.0, 35.0, 30.0, 0.4)});
    });
}

std::map<std::int32_t, PieceId> idsByPlace(SlideEngine& engine, double isovalue) {
    EXPECT_THAT(engine.slideTo(isovalue), IsOk());
    const SurfaceFrame frame = frameOf(engine);
    std::map<std::int32_t, PieceId> ids;
    for (const Piece& piece : frame.pieces->pieces())
        ids[(piece.low[0] + piece.high[0]) / 2] = piece.id;
    return ids;
}

TEST(SlidePieces, KeepTheirNumbers) {
    const test::TemporaryFolder folder;
    for (const test::Way& way : test::allWays(hills(), folder.path())) {
        SCOPED_TRACE(way.name);
        SlideEngine& engine = *way.engine;
        const auto first = idsByPlace(engine, 60.25);
        ASSERT_EQ(first.size(), 2u);
        const PieceId left = first.begin()->second, right = first.rbegin()->second;
        for (double isovalue = 60.0; isovalue > -60.0; isovalue -= 0.75) {
            const auto now = idsByPlace(engine, isovalue);
            ASSERT_EQ(now.begin()->second, left) << isovalue; // the larger one's, once they are joined
            if (isovalue > 0.0 && now.size() == 2u) {
                ASSERT_EQ(now.rbegin()->second, right) << isovalue;
            }
        }
        // In one jump, with no vertex in common, too.
        const auto far = idsByPlace(engine, 80.25);
        EXPECT_EQ(far.begin()->second, left);
        EXPECT_NE(far.rbegin()->second, left);
    }
}

// Each piece kept alone is a connected mesh of its size, and all of them together are the whole.
TEST(SlidePieces, AreKeptOneByOne) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        const auto grid = test::noiseVolume({23, 21, 19}, seed, 40);
        auto engine = preprocess::makeMemoryEngine(grid);
        ASSERT_THAT(engine, IsOk());
        for (const double isovalue : {3.5, 20.0, 36.5}) {
            ASSERT_THAT(engine.value()->slideTo(isovalue), IsOk());
            const auto mesh = engine.value()->mesh();
            ASSERT_THAT(mesh, IsOk());
            const SurfaceFrame frame = frameOf(*engine.value());
            const auto pieces = frame.pieces->pieces();
            ASSERT_GT(pieces.size(), 2u);
            std::size_t vertices = 0;
            for (const Piece& piece : pieces) {
                const auto kept = keepPieces(mesh.value(), {&piece, 1});
                ASSERT_THAT(kept, IsOk());
                ASSERT_EQ(partSizes(kept.value().triangles, kept.value().positions.size()),
                          std::vector{piece.triangles});
                ASSERT_EQ(kept.value().normals.size(), kept.value().positions.size());
                ASSERT_TRUE(std::is_sorted(kept.value().edgeIds.begin(), kept.value().edgeIds.end()));
                vertices += kept.value().positions.size();
            }
            EXPECT_EQ(vertices, mesh.value().positions.size());
            const auto all = keepPieces(mesh.value(), pieces);
            ASSERT_THAT(all, IsOk());
            EXPECT_EQ(all.value().triangles, mesh.value().triangles);
            EXPECT_EQ(all.value().edgeIds, mesh.value().edgeIds);
            ASSERT_THAT(engine.value()->slideTo(isovalue > 20.0 ? 2.0 : 38.0), IsOk());
            EXPECT_THAT(keepPieces(engine.value()->mesh().value(), pieces), test::HasError(ErrorCode::InvalidArgument))
                << "of another surface";
        }
    }
}

// Against the mesh that is cut out and checked, on every way, and in a world that is turned over.
TEST(SlidePieces, AreMeasuredAsTheirMeshes) {
    const std::uint64_t base = test::testSeed(6110);
    int open = 0, closed = 0, bubbles = 0;
    for (std::uint64_t seed = base; seed < base + 24; ++seed) {
        test::Random random(seed);
        const test::RandomVolume volume = test::randomVolume(random, 22);
        if (!volume.hasFinite)
            continue;
        SCOPED_TRACE("seed " + std::to_string(seed) + ": " + volume.description);
        const test::TemporaryFolder folder;
        auto ways = test::allWays(volume.grid, folder.path());
        const double isovalue = test::nextIsovalue(volume, volume.min, random);
        for (const test::Way& way : ways) {
            SCOPED_TRACE(way.name);
            ASSERT_THAT(way.engine->slideTo(isovalue), IsOk());
            const auto mesh = way.engine->mesh();
            ASSERT_THAT(mesh, IsOk());
            SurfaceFrame frame = frameOf(*way.engine);
            SurfaceFrame arrays = frame;
            expandPicture(arrays);
            const auto pieces = frame.pieces->pieces();
            for (std::size_t piece = 0; piece < std::min<std::size_t>(pieces.size(), 6); ++piece) {
                const auto kept = keepPieces(mesh.value(), {&pieces[piece], 1});
                ASSERT_THAT(kept, IsOk());
                if (kept.value().triangleCount() != pieces[piece].triangles ||
                    partSizes(kept.value().triangles, kept.value().positions.size()).size() != 1)
                    continue; // it touches another one beside missing values
                const auto report = mesh::checkMesh(kept.value());
                glm::dvec3 box(0.0);
                for (int axis = 0; axis < 3; ++axis) {
                    const auto a = static_cast<std::size_t>(axis);
                    box[axis] = (pieces[piece].high[a] - pieces[piece].low[a]) * frame.geometry.spacing[axis];
                }
                const double size = glm::length(box);
                // Those of a mesh are held off grid points.
                const double slack = mesh::nudgeOf(kept.value()).vertices > 0 ? 5e-3 : 1e-5;
                const auto measures = measurePiece(frame, piece);
                ASSERT_THAT(measures, IsOk());
                EXPECT_EQ(measures.value().isClosed, report.isClosed);
                EXPECT_NEAR(measures.value().area, report.area, slack * (report.area + size * size));
                if (report.isClosed) {
                    EXPECT_NEAR(measures.value().volume, report.enclosedVolume,
                                slack * (std::abs(report.enclosedVolume) + size * size * size));
                }
                const auto ofArrays = measurePiece(arrays, piece);
                ASSERT_THAT(ofArrays, IsOk());
                EXPECT_EQ(ofArrays.value().isClosed, measures.value().isClosed);
                EXPECT_NEAR(ofArrays.value().area, measures.value().area, slack * (report.area + size * size));
                EXPECT_EQ(frame.pieces->pieceAt(pieces[piece].edgeStart, pieces[piece].edgeAxis), piece);
                ++(report.isClosed ? closed : open);
                bubbles += report.isClosed && measures.value().volume < 0.0;
            }
        }
    }
    EXPECT_GT(open, 20);
    EXPECT_GT(closed, 20);
    EXPECT_GT(bubbles, 4);
}

// Two columns of cells in an empty volume that touch along one line only. There the mesh has two vertices at one place;
// pieces go by places, wherever the borders of bricks lie.
TEST(SlidePieces, ThatTouchBesideMissingValuesAreOne) {
    for (const auto& [x, y] : {std::pair{5, 5}, std::pair{8, 8}, std::pair{8, 5}, std::pair{5, 8}})
        for (const bool isTurned : {false, true}) {
            GridGeometry geometry;
            geometry.dims = {17, 17, 12};
            const auto grid = test::makeVolume<float>(
                ScalarType::F32, geometry, [&, x = x, y = y](std::int64_t px, std::int64_t py, std::int64_t z) {
                    const std::int64_t dx = px - x, dy = isTurned ? y - py : py - y;
                    const bool isInFirst = dx >= -1 && dx <= 0 && dy >= -1 && dy <= 0;
                    const bool isInSecond = dx >= 0 && dx <= 1 && dy >= 0 && dy <= 1;
                    return isInFirst || isInSecond ? static_cast<float>(z) : std::nanf("");
                });
            auto engine = preprocess::makeMemoryEngine(grid);
            ASSERT_THAT(engine, IsOk());
            ASSERT_THAT(engine.value()->slideTo(5.5), IsOk());
            EXPECT_EQ(frameOf(*engine.value()).pieces->pieces().size(), 1u) << x << ", " << y << isTurned;
            ASSERT_THAT(engine.value()->slideTo(7.5), IsOk()); // along z, in bricks as well
            EXPECT_EQ(frameOf(*engine.value()).pieces->pieces().size(), 1u) << x << ", " << y << isTurned;
        }
}

TEST(SlidePieces, KeepTheirNumbersInAnotherEngine) {
    auto first = preprocess::makeMemoryEngine(hills()), second = preprocess::makeMemoryEngine(hills());
    ASSERT_THAT(first, IsOk());
    ASSERT_THAT(second, IsOk());
    const auto before = idsByPlace(*first.value(), 60.25);
    const SurfaceFrame frame = frameOf(*first.value());
    ASSERT_THAT(second.value()->slideTo(59.0), IsOk());
    SurfaceFrame taken;
    second.value()->copyFrame(taken, {.pieces = true, .piecesBefore = frame.pieces});
    ASSERT_EQ(taken.pieces->pieces().size(), 2u);
    EXPECT_EQ(taken.pieces->pieces()[0].id, frame.pieces->pieces()[0].id);
    EXPECT_EQ(taken.pieces->pieces()[1].id, frame.pieces->pieces()[1].id);
    // Without them no number is given twice.
    auto third = preprocess::makeMemoryEngine(hills());
    for (const auto& [place, id] : idsByPlace(*third.value(), 60.25))
        for (const auto& [otherPlace, other] : before)
            EXPECT_NE(id, other);
}

TEST(SlidePieces, AreForgottenWhenNobodyAsks) {
    auto engine = preprocess::makeMemoryEngine(hills());
    ASSERT_THAT(engine, IsOk());
    ASSERT_THAT(engine.value()->slideTo(50.0), IsOk());
    SurfaceFrame frame = frameOf(*engine.value());
    ASSERT_NE(frame.pieces, nullptr);
    const PieceId first = frame.pieces->pieces()[0].id;
    engine.value()->copyFrame(frame);
    EXPECT_EQ(frame.pieces, nullptr);
    EXPECT_NE(frameOf(*engine.value()).pieces->pieces()[0].id, first);
}

} // namespace
} // namespace isoslider::extract
