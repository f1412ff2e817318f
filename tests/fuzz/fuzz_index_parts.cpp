#include <algorithm>
#include <bit>
#include <vector>

#include "core/base/byte_codec.h"
#include "core/grid/scalar_key.h"
#include "core/index/format/block_codec.h"
#include "core/index/format/chunk_codec.h"
#include "core/index/format/totals_page.h"
#include "tests/fuzz/fuzz_support.h"
#include "tests/fuzz/fuzz_targets.h"

namespace isoslider::fuzz {
namespace {

template <class Sample>
void decodePages(std::span<const std::byte> bytes, const GridDims& dims) {
    const BrickGrid grid(dims);
    index::DecodedPage<KeyOf<Sample>> page;
    const Status status = index::decodePage<KeyOf<Sample>>(bytes, grid, page, "input.isx");
    if (!status.isOk())
        return requireGoodError(status.error());
    ISO_REQUIRE(
        page.ids.size() == page.keys.size() && page.masks.size() == page.keys.size() &&
            page.rising.size() == page.keys.size() &&
            (!page.hasNormals() || (page.normals.size() == page.keys.size() && page.farNormals.size() == page.entries)),
        "");
    std::size_t farKeys = 0;
    for (std::size_t i = 0; i < page.pointCount(); ++i)
        farKeys += page.hasFarKeys(i) ? static_cast<std::size_t>(std::popcount(unsigned{page.masks[i]})) : 0;
    ISO_REQUIRE(farKeys == page.farKeys.size(), "");
    const std::uint64_t points = grid.brickCount() * kBrickPoints;
    ISO_REQUIRE(std::ranges::all_of(page.ids, [&](std::uint64_t id) { return id < points; }), "");
}

void decodeTotals(std::span<const std::byte> bytes, const GridDims& dims) {
    const BrickGrid grid(dims);
    std::vector<index::BrickTotal> totals;
    const Status status = index::decodeTotals(bytes, grid, totals, "input.isx.levels");
    if (!status.isOk())
        return requireGoodError(status.error());
    ISO_REQUIRE(
        std::ranges::all_of(totals, [&](const auto& total) { return total.brick.number() < grid.brickCount(); }), "");
    auto combined = totals;
    index::combineTotals(combined);
    ISO_REQUIRE(combined == totals, "");
}

template <class Sample>
void decodeSamples(std::span<const std::byte> bytes, const index::ChunkExtent& extent) {
    std::vector<Sample> samples(static_cast<std::size_t>(extent[0] * extent[1] * extent[2]));
    if (!index::decodeChunk<Sample>(bytes, extent, samples))
        return;
    const auto again = index::encodeChunk<Sample>(samples, extent);
    std::vector<Sample> copy(samples.size());
    ISO_REQUIRE(index::decodeChunk<Sample>(again, extent, copy), "what has been decoded can be encoded");
    ISO_REQUIRE(std::ranges::equal(std::as_bytes(std::span(samples)), std::as_bytes(std::span(copy))), "");
}

} // namespace

/// One part of an index, without the checksums that stand around it. Six bytes state what it is, the type of samples
/// and the dims, all of them small; then comes the part.
void fuzzIndexParts(std::span<const std::byte> bytes) {
    ByteReader in(bytes);
    const auto part = in.get<std::uint8_t>() % 3;
    const ScalarType type = kAllScalarTypes[in.get<std::uint8_t>() % kAllScalarTypes.size()];
    std::array<int, 3> sizes{};
    for (int& size : sizes)
        size = 1 + (in.get<std::uint8_t>() + index::kChunkSide) % (index::kChunkSide + 1);
    in.get<std::uint8_t>();
    const GridDims dims{sizes[0], sizes[1], sizes[2]};
    const auto content = in.getBytes(in.remaining());
    const auto chunk = [](int size) { return std::min(size, index::kChunkSide); };
    if (part == 2)
        return decodeTotals(content, dims);
    visitScalarType(type, [&](auto sample) {
        using Sample = decltype(sample);
        if (part == 0)
            decodePages<Sample>(content, dims);
        else
            decodeSamples<Sample>(content, {chunk(sizes[0]), chunk(sizes[1]), chunk(sizes[2])});
    });
}

} // namespace isoslider::fuzz
