#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/extract/slide_engine.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"

namespace isoslider::test {

/// The ways to slide: each has a separate source, all feed the same surface.
struct Way {
    std::string name;
    std::unique_ptr<extract::SlideEngine> engine;
};

/// Builds the index first if it is not there.
inline std::unique_ptr<extract::SlideEngine> openIndex(const std::shared_ptr<const ScalarGrid>& grid,
                                                       const std::filesystem::path& path, index::IndexKind kind,
                                                       std::optional<std::uint64_t> cacheBytes = {}) {
    preprocess::BuildOptions build;
    build.kind = kind;
    if (!std::filesystem::exists(path)) {
        EXPECT_THAT(test::buildIndexOf(grid, path, build), IsOk());
    }
    extract::SlideOptions options;
    options.cacheBytes = cacheBytes;
    auto opened = extract::SlideEngine::open(path, options);
    EXPECT_THAT(opened, IsOk());
    return opened.isOk() ? std::move(opened).value() : nullptr;
}

/// All of them, with indexes in `folder`.
inline std::vector<Way> allWays(const std::shared_ptr<const ScalarGrid>& grid, const std::filesystem::path& folder) {
    std::vector<Way> ways;
    auto inMemory = preprocess::makeMemoryEngine(grid);
    EXPECT_THAT(inMemory, IsOk());
    if (!inMemory.isOk())
        return ways;
    ways.push_back({"in memory", std::move(inMemory).value()});
    ways.push_back({"edges", openIndex(grid, folder / "e.isx", index::IndexKind::Edges)});
    constexpr std::uint64_t kLargestChunkBytes = 16 * 16 * 16 * sizeof(double);
    const auto metacells = folder / "m.isx";
    ways.push_back({"metacells, cache of one brick", openIndex(grid, metacells, index::IndexKind::Metacells, 0)});
    ways.push_back({"metacells, cache of eight bricks",
                    openIndex(grid, metacells, index::IndexKind::Metacells, 9 * kLargestChunkBytes)});
    ways.push_back({"metacells, cache of all", openIndex(grid, metacells, index::IndexKind::Metacells)});
    return ways;
}

} // namespace isoslider::test
