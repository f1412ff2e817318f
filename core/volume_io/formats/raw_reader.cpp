#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>
#include <type_traits>

#include "core/base/file_system.h"
#include "core/grid/scalar_key.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/sources/sample_source.h"

namespace isoslider::io {
namespace {

template <class Sample>
Sample sampleAt(std::span<const std::byte> bytes, std::size_t i, bool isSwapped) {
    std::array<std::byte, sizeof(Sample)> sample;
    std::copy_n(bytes.data() + i * sizeof(Sample), sizeof(Sample), sample.begin());
    if (isSwapped)
        std::reverse(sample.begin(), sample.end());
    return std::bit_cast<Sample>(sample);
}

/// Mean difference of neighbouring samples as places in the order of their type, whose size plays no part. Enough to
/// distinguish one byte order from the other of the same samples. The window, which ranks types, dims and offsets
/// against each other, needs a measure that is the same for all of these: ui/model/opening/raw_smoothness.h.
template <class Sample>
double roughness(std::span<const std::byte> bytes, bool isSwapped) {
    double sum = 0.0, before = 0.0;
    const std::size_t count = bytes.size() / sizeof(Sample);
    for (std::size_t i = 0; i < count; ++i) {
        const auto place = static_cast<double>(keyOf(sampleAt<Sample>(bytes, i, isSwapped)));
        sum += i > 0 ? std::abs(place - before) : 0.0;
        before = place;
    }
    return count > 1 ? sum / static_cast<double>(count - 1) : 0.0;
}

/// Whether nearly all samples are zero or ordinary numbers. Floats of few bits, such as whole numbers, are next to zero
/// in the wrong byte order, all of them, and so smooth.
template <class Sample>
bool areOrdinary(std::span<const std::byte> bytes, bool isSwapped) {
    if constexpr (std::is_floating_point_v<Sample>) {
        constexpr std::size_t kOneInSoMany = 10;
        std::size_t other = 0, strange = 0;
        for (std::size_t i = 0; i < bytes.size() / sizeof(Sample); ++i) {
            const auto value = sampleAt<Sample>(bytes, i, isSwapped);
            other += value != Sample(0);
            strange += value != Sample(0) && !std::isnormal(value);
        }
        return kOneInSoMany * strange <= other;
    } else {
        return true;
    }
}

/// A note where the other byte order makes the samples far smoother, or usual numbers. Looks at the middle of the file.
std::optional<std::string> byteOrderDoubt(const RandomAccessFile& file, const RawLayout& layout,
                                          std::uint64_t samples) {
    constexpr std::uint64_t kBytes = std::uint64_t{1} << 16;
    constexpr double kFarSmoother = 10.0;
    const std::size_t size = scalarTypeSizeBytes(layout.type);
    if (size == 1)
        return std::nullopt;
    std::vector<std::byte> bytes(std::min(kBytes, samples));
    const std::uint64_t middle = layout.skipBytes + (samples - bytes.size()) / 2 / size * size;
    if (!file.readExactlyAt(middle, bytes).isOk())
        return std::nullopt;
    const bool needsSwap = layout.isBigEndian != (std::endian::native == std::endian::big);
    const auto [asTold, otherwise, isOrdinary, isPossible] = visitScalarType(layout.type, [&](auto sample) {
        using Sample = decltype(sample);
        return std::tuple(roughness<Sample>(bytes, needsSwap), roughness<Sample>(bytes, !needsSwap),
                          areOrdinary<Sample>(bytes, needsSwap), areOrdinary<Sample>(bytes, !needsSwap));
    });
    const bool isRough = asTold > kFarSmoother * otherwise && otherwise > 0.0;
    if (!isPossible || (isOrdinary && !isRough))
        return std::nullopt;
    return std::string("its samples would be ") + (isRough ? "far smoother" : "more usual numbers") +
           " in the other byte order: are they " + (layout.isBigEndian ? "little" : "big") + "-endian?";
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openRaw(const std::filesystem::path& path, const ReadOptions& options) {
    const RawLayout& layout = *options.raw;
    const auto dims = checkDims(layout.dims, "dims", path);
    if (!dims.isOk())
        return dims.error();
    VolumeInfo info;
    info.format = "raw";
    info.geometry.dims = dims.value();
    info.geometry.spacing = layout.spacing;
    ISO_TRY(checkGeometry(info.geometry, "spacing", path));
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    const std::uint64_t samples =
        static_cast<std::uint64_t>(pointCount(dims.value())) * scalarTypeSizeBytes(layout.type);
    const std::uint64_t size = file.value()->sizeBytes();
    const bool isShort = layout.skipBytes > size || size - layout.skipBytes < samples;
    if (isShort || (!options.allowsTrailing && size - layout.skipBytes > samples))
        return makeError(isShort ? ErrorCode::Corruption : ErrorCode::InvalidArgument,
                         "has " + std::to_string(size) + " bytes; dims, type and skipped bytes ask for " +
                             std::to_string(samples) +
                             (layout.skipBytes > 0 ? " after " + std::to_string(layout.skipBytes) : "") +
                             (isShort ? "" : " (trailing bytes have to be allowed)"),
                         path);
    if (const std::uint64_t trailing = size - layout.skipBytes - samples; trailing > 0)
        info.notes.push_back("has " + std::to_string(size) + " bytes; " + std::to_string(trailing) +
                             (trailing == 1 ? " byte" : " bytes") + " behind the last sample left out");
    if (auto doubt = byteOrderDoubt(*file.value(), layout, samples))
        info.notes.push_back(*std::move(doubt));
    auto bytes = openParts({{path, layout.skipBytes}}, samples);
    if (!bytes.isOk())
        return std::move(bytes).error();
    return makeSampleSource(std::move(info), {fileTypeOf(layout.type), layout.isBigEndian, std::nullopt},
                            std::move(bytes).value(), path);
}

} // namespace isoslider::io
