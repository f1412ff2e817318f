// B092: the nth allocation of memory fails, for n from 1 on. A program of its own, because it replaces the
// operators that allocate.

#include <atomic>
#include <cstdlib>
#include <new>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/live/brick_picture.h"
#include "core/extract/slide_engine.h"
#include "preprocess/build_index.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace {

std::atomic<long> allocationsLeft{-1}; // below 0: none fails

void* allocate(std::size_t size, std::size_t alignment) {
    if (allocationsLeft.load(std::memory_order_relaxed) >= 0 && allocationsLeft.fetch_sub(1) == 0)
        throw std::bad_alloc();
    void* place = alignment <= alignof(std::max_align_t)
                      ? std::malloc(size == 0 ? 1 : size)
                      : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (place == nullptr)
        throw std::bad_alloc();
    return place;
}

} // namespace

void* operator new(std::size_t size) { return allocate(size, 1); }
void* operator new[](std::size_t size) { return allocate(size, 1); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete[](void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }
void operator delete[](void* place, std::size_t) noexcept { std::free(place); }
void operator delete(void* place, std::align_val_t) noexcept { std::free(place); }
void operator delete[](void* place, std::align_val_t) noexcept { std::free(place); }
void operator delete(void* place, std::size_t, std::align_val_t) noexcept { std::free(place); }
void operator delete[](void* place, std::size_t, std::align_val_t) noexcept { std::free(place); }

namespace isoslider::test {
namespace {

/// While it lives no allocation fails; those of the test itself are none of the work's.
class WithoutFailures {
public:
    WithoutFailures() : left_(allocationsLeft.exchange(-1)) {}
    ~WithoutFailures() { allocationsLeft = left_; }
    WithoutFailures(const WithoutFailures&) = delete;
    WithoutFailures& operator=(const WithoutFailures&) = delete;

private:
    long left_;
};

class FailingMemory : public testing::TestWithParam<index::IndexKind> {
protected:
    /// Calls work() with the nth allocation failing, for n from 0 until none fails any more. Work has to end
    /// with an error, an exception that reports it, or as if nothing had happened.
    template <class Work>
    static void forEachFailure(const Work& work) {
        // The first ones one by one, later ones at growing distances; each of the first 20,000 with
        // ISOSLIDER_LONG_TESTS.
        const long each = std::getenv("ISOSLIDER_LONG_TESTS") != nullptr ? 20'000 : 60;
        long failed = 0;
        for (long n = 0;; n += 1 + n / each) {
            allocationsLeft = n;
            const bool isDone = work();
            const bool hasFailed = allocationsLeft.exchange(-1) < 0; // counted below zero
            failed += hasFailed ? 1 : 0;
            if (!hasFailed) {
                EXPECT_TRUE(isDone);
                break;
            }
        }
        EXPECT_GT(failed, 20);
    }
    static preprocess::BuildOptions options() {
        preprocess::BuildOptions options;
        options.kind = GetParam();
        options.threads = 1;
        return options;
    }
    TemporaryFolder folder_;
    std::shared_ptr<const ScalarGrid> grid_ = noiseVolume({19, 18, 17}, 8);
};

TEST_P(FailingMemory, B092_ABuildEndsAndLeavesNothing) {
    const auto path = folder_ / "a.isx";
    const auto source = io::makeMemorySource(grid_);
    const preprocess::BuildOptions asked = options();
    ASSERT_THAT(preprocess::buildIndex(*source, path, asked), IsOk()); // TBB does not survive failures when it begins
    std::filesystem::remove(path);
    forEachFailure([&] {
        bool isDone = false;
        try {
            isDone = preprocess::buildIndex(*source, path, asked).isOk();
        } catch (const std::bad_alloc&) { // becomes a message where the programs start their work
        }
        const WithoutFailures pause;
        if (std::filesystem::exists(path)) { // whole, though a report of it may have failed
            EXPECT_THAT(extract::SlideEngine::open(path), IsOk());
            std::filesystem::remove(path);
        } else {
            EXPECT_FALSE(isDone);
        }
        EXPECT_THAT(folder_.names(), testing::IsEmpty());
        return isDone;
    });
}

TEST_P(FailingMemory, B092_SlidingEndsAndCanGoOn) {
    const auto path = folder_ / "a.isx";
    ASSERT_THAT(buildIndexOf(grid_, path, options()), IsOk());
    const auto fresh = extract::extractFull(*grid_, 9.0).value();
    forEachFailure([&] {
        std::unique_ptr<extract::SlideEngine> engine;
        extract::SurfaceFrame shown; // as the window holds it, and must stay what it is
        bool isDone = false;
        try {
            auto opened = extract::SlideEngine::open(path);
            if (opened.isOk()) {
                engine = std::move(opened).value();
                isDone = true;
                for (const double isovalue : {3.0, 14.5, 8.5, 9.0}) {
                    isDone = isDone && engine->slideTo(isovalue).isOk();
                    extract::SurfaceFrame next;
                    engine->copyFrame(next);
                    shown = std::move(next);
                }
            }
        } catch (const std::bad_alloc&) {}
        const WithoutFailures pause;
        if (engine == nullptr)
            return isDone;
        extract::SurfaceFrame before, after;
        before.isovalue = after.isovalue = shown.isovalue;
        if (shown.bricks)
            expandPicture(*shown.bricks, before);
        for (const double isovalue : {9.0, 3.5, 9.0}) {
            EXPECT_THAT(engine->slideTo(isovalue), IsOk());
            extract::SurfaceFrame next; // gone before the next move, unlike the one that is shown
            engine->copyFrame(next);
        }
        EXPECT_TRUE(isSameSurface(engine->mesh().value(), fresh));
        if (shown.bricks)
            expandPicture(*shown.bricks, after);
        EXPECT_EQ(before.positions, after.positions);
        EXPECT_EQ(before.indices, after.indices);
        return isDone;
    });
}

INSTANTIATE_TEST_SUITE_P(Kinds, FailingMemory, testing::Values(index::IndexKind::Edges, index::IndexKind::Metacells),
                         [](const auto& kind) { return std::string(index::indexKindName(kind.param)); });

} // namespace
} // namespace isoslider::test
