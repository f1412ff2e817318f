// zstd finds no memory, call for call. A separate program, because it puts its own functions before the library's.

#include <dlfcn.h>

#include <new>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <zstd.h>
#include <zstd_errors.h>

#include "core/index/format/block_codec.h"
#include "core/index/format/chunk_codec.h"
#include "core/index/format/index_format.h"

namespace {

bool failsToCreate = false, failsToWork = false;

template <class Function>
Function* inLibrary(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}
constexpr std::size_t kNoMemory = static_cast<std::size_t>(-ZSTD_error_memory_allocation);

} // namespace

extern "C" {

ZSTD_CCtx* ZSTD_createCCtx() {
    static const auto real = inLibrary<ZSTD_CCtx*()>("ZSTD_createCCtx");
    return failsToCreate ? nullptr : real();
}
ZSTD_DCtx* ZSTD_createDCtx() {
    static const auto real = inLibrary<ZSTD_DCtx*()>("ZSTD_createDCtx");
    return failsToCreate ? nullptr : real();
}
std::size_t ZSTD_compress(void* to, std::size_t room, const void* from, std::size_t size, int level) {
    static const auto real = inLibrary<std::size_t(void*, std::size_t, const void*, std::size_t, int)>("ZSTD_compress");
    return failsToWork ? kNoMemory : real(to, room, from, size, level);
}
std::size_t ZSTD_decompress(void* to, std::size_t room, const void* from, std::size_t size) {
    static const auto real = inLibrary<std::size_t(void*, std::size_t, const void*, std::size_t)>("ZSTD_decompress");
    return failsToWork ? kNoMemory : real(to, room, from, size);
}
std::size_t ZSTD_compressCCtx(ZSTD_CCtx* context, void* to, std::size_t room, const void* from, std::size_t size,
                              int level) {
    static const auto real =
        inLibrary<std::size_t(ZSTD_CCtx*, void*, std::size_t, const void*, std::size_t, int)>("ZSTD_compressCCtx");
    return failsToWork ? kNoMemory : real(context, to, room, from, size, level);
}
std::size_t ZSTD_compress2(ZSTD_CCtx* context, void* to, std::size_t room, const void* from, std::size_t size) {
    static const auto real =
        inLibrary<std::size_t(ZSTD_CCtx*, void*, std::size_t, const void*, std::size_t)>("ZSTD_compress2");
    return failsToWork ? kNoMemory : real(context, to, room, from, size);
}

} // extern "C"

namespace isoslider::index {
namespace {

// Runs `work` on a separate thread, because contexts are kept by thread. Returns whether memory ran out.
template <class Work>
bool runsOutOfMemory(const Work& work) {
    bool isOutOfMemory = false;
    std::jthread([&] {
        try {
            work();
        } catch (const std::bad_alloc&) {
            isOutOfMemory = true;
        }
    }).join();
    return isOutOfMemory;
}

template <class Work>
void expectOutOfMemoryOnly(const Work& work) {
    EXPECT_FALSE(runsOutOfMemory(work));
    for (bool* fails : {&failsToCreate, &failsToWork}) {
        *fails = true;
        EXPECT_TRUE(runsOutOfMemory(work)) << (fails == &failsToCreate ? "no context" : "no room to work");
        *fails = false;
    }
}

TEST(ZstdMemory, OfPagesIsReportedWhenItIsMissing) {
    std::vector<PointRecord<std::uint16_t>> records(4096);
    for (std::size_t i = 0; i < records.size(); ++i) {
        records[i].setId(PointId(3 * i));
        records[i].key = static_cast<std::uint16_t>(i / 7);
        records[i].edgeMask = 1;
        records[i].farKeys[0] = static_cast<std::uint16_t>(i / 7 + 1 + i % 3);
    }
    const BrickGrid grid({64, 64, 64});
    expectOutOfMemoryOnly([&] { (void)encodePage<std::uint16_t>(records, PageOrder::Value, FarEnds::Keys, grid); });
}

TEST(ZstdMemory, OfChunksIsReportedWhenItIsMissing) {
    std::vector<std::int16_t> samples(16 * 16 * 16);
    std::mt19937 random(1);
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = static_cast<std::int16_t>(i / 16 + (random() % 4 == 0 ? random() % 3 : 0));
    expectOutOfMemoryOnly([&] { (void)encodeChunk<std::int16_t>(samples, {16, 16, 16}); });
}

TEST(ZstdMemory, OfTheDirectoryIsReportedWhenItIsMissing) {
    IndexMeta meta;
    meta.info.geometry.dims = {9, 9, 9};
    meta.missingCells = {{BrickIndex(1), {1, 2, 3, 4, 5, 6, 7, 8}}};
    failsToWork = true;
    EXPECT_TRUE(runsOutOfMemory([&] { (void)encodeMeta(meta); }));
    failsToWork = false;
    EXPECT_FALSE(runsOutOfMemory([&] { (void)encodeMeta(meta); }));
}

} // namespace
} // namespace isoslider::index
