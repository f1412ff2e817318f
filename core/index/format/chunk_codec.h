#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace isoslider::index {

/// Samples along each side of a chunk; fewer where the volume ends.
inline constexpr int kChunkSide = 16;

using ChunkExtent = std::array<int, 3>;

/// One chunk of samples, x fastest, without loss: every bit pattern comes back, NaN payloads and -0 too.
/// At most kChunkHeaderBytes longer than the samples. The bytes depend on the samples, the extent and the
/// version of zstd only. Any thread. O(samples).
/// REQUIRES: each extent is 1 to kChunkSide; samples.size() is their product.
template <class Sample>
std::vector<std::byte> encodeChunk(std::span<const Sample> samples, const ChunkExtent& extent);

/// The samples of a chunk of this extent. False when `bytes` are not such a chunk; `out` is unspecified then.
/// Treats input as untrusted, but does not see every damage: a checksum must stand around it. Any thread; allocates
/// nothing but its working memory, once per thread.
/// REQUIRES: each extent is 1 to kChunkSide; out.size() is their product.
template <class Sample>
[[nodiscard]] bool decodeChunk(std::span<const std::byte> bytes, const ChunkExtent& extent, std::span<Sample> out);

inline constexpr std::size_t kChunkHeaderBytes = 2;

extern template std::vector<std::byte> encodeChunk(std::span<const std::uint8_t>, const ChunkExtent&);
extern template std::vector<std::byte> encodeChunk(std::span<const std::int8_t>, const ChunkExtent&);
extern template std::vector<std::byte> encodeChunk(std::span<const std::uint16_t>, const ChunkExtent&);
extern template std::vector<std::byte> encodeChunk(std::span<const std::int16_t>, const ChunkExtent&);
extern template std::vector<std::byte> encodeChunk(std::span<const std::int32_t>, const ChunkExtent&);
extern template std::vector<std::byte> encodeChunk(std::span<const float>, const ChunkExtent&);
extern template std::vector<std::byte> encodeChunk(std::span<const double>, const ChunkExtent&);
extern template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<std::uint8_t>);
extern template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<std::int8_t>);
extern template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<std::uint16_t>);
extern template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<std::int16_t>);
extern template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<std::int32_t>);
extern template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<float>);
extern template bool decodeChunk(std::span<const std::byte>, const ChunkExtent&, std::span<double>);

} // namespace isoslider::index
