#include "core/index/format/byte_planes.h"

#include <algorithm>
#include <memory>

#include "core/index/format/zstd_contexts.h"

namespace isoslider::index {
namespace {

// High planes of small residuals are nearly constant and low planes nearly random: apart, the entropy
// coder gets both right and the random ones cost a copy.

constexpr int kCompressionLevel = 1;
constexpr std::size_t kMinGain = 16; // smaller savings do not pay for a decompression call

enum BytePlaneMode : std::uint32_t { kConstantBytes = 0, kRawBytes = 1, kZstdBytes = 2 };
constexpr std::uint32_t kBytePlaneModeShift = 30;
constexpr std::uint32_t kBytePlaneLengthMask = (1u << kBytePlaneModeShift) - 1;

struct CompressionContext : ZstdContexts {
    std::vector<std::uint8_t> plane;
    std::vector<std::byte> packed;
};

CompressionContext& compressionContext() {
    thread_local CompressionContext context;
    return context;
}

} // namespace

PlaneWriter::PlaneWriter(std::vector<std::byte>& page, int planes)
    : page_(page), tableAt_(page.size()), planes_(planes) {
    page_.resize(page_.size() + 4 * static_cast<std::size_t>(planes));
}

std::vector<std::uint8_t>& PlaneWriter::beginPlane(std::size_t size) {
    std::vector<std::uint8_t>& plane = compressionContext().plane;
    plane.resize(size);
    return plane;
}

void PlaneWriter::addPlane(const std::vector<std::uint8_t>& plane) {
    const bool isConstant = std::all_of(plane.begin(), plane.end(), [&](std::uint8_t b) { return b == plane[0]; });
    if (plane.empty() || isConstant) {
        const std::uint8_t value = plane.empty() ? 0 : plane[0];
        put(kConstantBytes, std::as_bytes(std::span(&value, 1)));
        return;
    }
    CompressionContext& context = compressionContext();
    context.packed.resize(ZSTD_compressBound(plane.size()));
    const std::size_t packed =
        orOutOfMemory(ZSTD_compressCCtx(context.compress.get(), context.packed.data(), context.packed.size(),
                                        plane.data(), plane.size(), kCompressionLevel));
    if (!ZSTD_isError(packed) && packed + kMinGain < plane.size())
        put(kZstdBytes, std::span(context.packed).first(packed));
    else
        put(kRawBytes, std::as_bytes(std::span(plane)));
}

void PlaneWriter::put(std::uint32_t mode, std::span<const std::byte> data) {
    ISO_CHECK(slot_ < planes_);
    storeLittle<std::uint32_t>(page_.data() + tableAt_ + 4 * static_cast<std::size_t>(slot_++),
                               static_cast<std::uint32_t>(data.size()) | (mode << kBytePlaneModeShift));
    page_.insert(page_.end(), data.begin(), data.end());
}

Status PlaneReader::beginPlanes(std::size_t at, std::uint32_t count) {
    if (page_.size() < at + 4 * std::size_t{count})
        return corrupt("plane table is cut off");
    tableAt_ = at;
    dataAt_ = at + 4 * std::size_t{count};
    return {};
}

Status PlaneReader::readPlane(std::size_t count, Plane& plane) {
    const std::uint32_t entry = loadLittle<std::uint32_t>(page_.data() + tableAt_ + 4 * slot_++);
    const std::uint32_t mode = entry >> kBytePlaneModeShift;
    const std::size_t length = entry & kBytePlaneLengthMask;
    if (length > page_.size() - dataAt_)
        return corrupt("plane length");
    const std::span<const std::byte> data = page_.subspan(dataAt_, length);
    dataAt_ += length;
    if (mode == kConstantBytes) {
        if (data.size() != 1)
            return corrupt("constant plane");
        plane.constant = static_cast<std::uint8_t>(data[0]);
    } else if (mode == kZstdBytes) {
        CompressionContext& context = compressionContext();
        context.plane.resize(count);
        const std::size_t size =
            ZSTD_decompressDCtx(context.decompress.get(), context.plane.data(), count, data.data(), data.size());
        if (ZSTD_isError(size) || size != count)
            return corrupt("compressed plane");
        plane.bytes = context.plane.data();
    } else if (mode == kRawBytes && data.size() == count) {
        plane.bytes = reinterpret_cast<const std::uint8_t*>(data.data());
    } else {
        return corrupt("plane mode or size");
    }
    return {};
}

} // namespace isoslider::index
