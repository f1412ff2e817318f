#include "core/volume_io/sources/sample_source.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

namespace isoslider::io {
namespace {

void swapSamples(std::span<std::byte> bytes, std::size_t sampleBytes) {
    for (std::size_t i = 0; i + sampleBytes <= bytes.size(); i += sampleBytes)
        std::reverse(bytes.data() + i, bytes.data() + i + sampleBytes);
}

class SampleSource final : public VolumeSource {
public:
    SampleSource(VolumeInfo info, SampleLayout layout, std::unique_ptr<ByteStream> bytes, std::filesystem::path path)
        : info_(std::move(info)), layout_(layout), bytes_(std::move(bytes)), path_(std::move(path)) {
        info_.type = memoryType(layout_.type);
        if (layout_.component == kMagnitude)
            info_.type = realType(info_.type);
        else if (layout_.rescale && !isFloatType(info_.type))
            info_.type = realType(info_.type);
        const GridDims& dims = info_.geometry.dims;
        planeSamples_ = static_cast<std::size_t>(dims[0] * dims[1]);
        ISO_CHECK(layout_.components >= 1 && layout_.component >= kMagnitude && layout_.component < layout_.components);
        const std::uint64_t values = layout_.firstValue + static_cast<std::uint64_t>(pointCount(dims)) *
                                                              static_cast<std::uint64_t>(layout_.components);
        ISO_CHECK(bytes_->sizeBytes() >= values * fileTypeSizeBytes(layout_.type));
    }

    const VolumeInfo& info() const override { return info_; }

    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) override {
        ISO_CHECK(zBegin >= 0 && zBegin <= zEnd && zEnd <= info_.geometry.dims[2]);
        const std::size_t count = planeSamples_ * static_cast<std::size_t>(zEnd - zBegin);
        ISO_CHECK(out.size() == count * scalarTypeSizeBytes(info_.type));
        const std::size_t first = planeSamples_ * static_cast<std::size_t>(zBegin);
        const bool isAsInFile = !layout_.rescale && layout_.components == 1 && layout_.component == 0 &&
                                fileTypeOf(info_.type) == layout_.type;
        return isAsInFile ? readAsIs(first, out) : readConverted(first, count, out);
    }

private:
    Status readAsIs(std::size_t first, std::span<std::byte> out) {
        const std::size_t size = fileTypeSizeBytes(layout_.type);
        ISO_TRY(bytes_->readAt((layout_.firstValue + first) * size, out));
        if (needsSwap())
            swapSamples(out, size);
        return {};
    }

    Status readConverted(std::size_t first, std::size_t count, std::span<std::byte> out) {
        constexpr std::size_t kBufferBytes = std::size_t{4} << 20; // samples may have thousands of components
        const std::size_t valueSize = fileTypeSizeBytes(layout_.type);
        const std::size_t fileSize = valueSize * static_cast<std::size_t>(layout_.components);
        const std::size_t memorySize = scalarTypeSizeBytes(info_.type);
        const std::uint64_t begin = layout_.firstValue * valueSize;
        const std::size_t most = std::min(std::max<std::size_t>(kBufferBytes / fileSize, 1), count);
        std::vector<std::byte> raw(most * fileSize);
        for (std::size_t done = 0; done < count;) {
            const std::size_t chunk = std::min(most, count - done);
            const auto bytes = std::span(raw).first(chunk * fileSize);
            ISO_TRY(bytes_->readAt(begin + (first + done) * fileSize, bytes));
            if (needsSwap())
                swapSamples(bytes, valueSize);
            ISO_TRY(convert(bytes, out.subspan(done * memorySize, chunk * memorySize)));
            done += chunk;
        }
        return {};
    }

    Status convert(std::span<const std::byte> in, std::span<std::byte> out) const {
        return visitFileType(layout_.type, [&](auto inSample) {
            return visitScalarType(info_.type, [&](auto outSample) {
                return convertAs<decltype(inSample), decltype(outSample)>(in, out);
            });
        });
    }

    template <class In, class Out>
    Status convertAs(std::span<const std::byte> in, std::span<std::byte> out) const {
        const auto components = static_cast<std::size_t>(layout_.components);
        for (std::size_t i = 0; i < out.size() / sizeof(Out); ++i) {
            const std::byte* sample = in.data() + i * components * sizeof(In);
            Out value{};
            if (layout_.component == kMagnitude) {
                double squares = 0.0;
                for (std::size_t c = 0; c < components; ++c) {
                    const double part = rescaled(static_cast<double>(load<In>(sample + c * sizeof(In))));
                    squares += part * part;
                }
                value = static_cast<Out>(std::sqrt(squares));
            } else {
                const In raw = load<In>(sample + static_cast<std::size_t>(layout_.component) * sizeof(In));
                // As ITK does: first to the result's type, then slope and intercept in double.
                value = static_cast<Out>(raw);
                if (layout_.rescale)
                    value = static_cast<Out>(rescaled(static_cast<double>(value)));
                else if (!isExactInDouble(raw))
                    return makeError(ErrorCode::InvalidArgument,
                                     "the 64-bit sample " + std::to_string(raw) + " has no exact value in f64", path_);
            }
            std::memcpy(out.data() + i * sizeof(Out), &value, sizeof(Out));
        }
        return {};
    }

    template <class T>
    static T load(const std::byte* bytes) {
        T value;
        std::memcpy(&value, bytes, sizeof value);
        return value;
    }
    double rescaled(double value) const {
        return layout_.rescale ? value * layout_.rescale->slope + layout_.rescale->intercept : value;
    }

    bool needsSwap() const { return layout_.isBigEndian != (std::endian::native == std::endian::big); }

    VolumeInfo info_;
    SampleLayout layout_;
    std::unique_ptr<ByteStream> bytes_;
    std::filesystem::path path_;
    std::size_t planeSamples_ = 0;
};

} // namespace

std::uint64_t planeBytes(const VolumeField& field, FileType type) {
    return static_cast<std::uint64_t>(field.dims[0] * field.dims[1]) * static_cast<std::uint64_t>(field.components) *
           fileTypeSizeBytes(type);
}

std::unique_ptr<VolumeSource> makeSampleSource(VolumeInfo info, SampleLayout layout, std::unique_ptr<ByteStream> bytes,
                                               std::filesystem::path path) {
    return std::make_unique<SampleSource>(std::move(info), layout, std::move(bytes), std::move(path));
}

} // namespace isoslider::io
