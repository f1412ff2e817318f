#include "core/volume_io/sources/array_source.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

#include "core/volume_io/parsing/reading_memory.h"

namespace isoslider::io {
namespace {

constexpr std::uint64_t kMostBlockBytes = std::uint64_t{64} << 20;

class ArraySource final : public VolumeSource {
public:
    ArraySource(VolumeInfo info, ArrayView view, ArrayMeaning meaning, std::unique_ptr<ArrayReader> reader,
                std::filesystem::path path, std::uint64_t memoryBytes)
        : info_(std::move(info)),
          view_(std::move(view)),
          meaning_(std::move(meaning)),
          reader_(std::move(reader)),
          path_(std::move(path)) {
        info_.type = arrayType(view_.type, meaning_);
        const GridDims& dims = info_.geometry.dims;
        planeSamples_ = static_cast<std::uint64_t>(dims[0] * dims[1]);
        const std::uint64_t planeBytes = planeSamples_ * fileTypeSizeBytes(view_.type);
        const std::uint64_t blockBytes =
            std::min(kMostBlockBytes, readingMemoryOf(memoryBytes) / 2); // the other half is slabs
        blockPlanes_ = static_cast<std::int64_t>(std::max<std::uint64_t>(1, blockBytes / planeBytes));
        // Planes across the file's order touch the whole of it, so each pass over it fetches as many as it may.
        for (std::size_t axis = 0; axis < 2; ++axis)
            isAcross_ = isAcross_ || (view_.axisOf[2] >= 0 && view_.axisOf[axis] >= 0 && dims[axis] > 1 &&
                                      view_.axisOf[axis] < view_.axisOf[2]);
    }

    const VolumeInfo& info() const override { return info_; }

    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) override {
        const std::int64_t nz = info_.geometry.dims[2];
        ISO_CHECK(zBegin >= 0 && zBegin <= zEnd && zEnd <= nz);
        const std::size_t planeBytes = planeSamples_ * scalarTypeSizeBytes(info_.type);
        ISO_CHECK(out.size() == planeBytes * static_cast<std::size_t>(zEnd - zBegin));
        for (std::int64_t z = zBegin; z < zEnd;) {
            if (z < blockBegin_ || z >= blockEnd_) {
                const std::int64_t wanted = isAcross_ ? nz : zEnd;
                ISO_TRY(loadBlock(z, std::min(z + blockPlanes_, wanted)));
            }
            const std::int64_t end = std::min(zEnd, blockEnd_);
            ISO_TRY(convert(z, end,
                            out.subspan(static_cast<std::size_t>(z - zBegin) * planeBytes,
                                        static_cast<std::size_t>(end - z) * planeBytes)));
            z = end;
        }
        return {};
    }

private:
    Status loadBlock(std::int64_t zBegin, std::int64_t zEnd) {
        const GridDims& dims = info_.geometry.dims;
        std::vector<std::uint64_t> start = view_.start, count(view_.start.size(), 1);
        const GridDims first{0, 0, view_.isFlipped[2] ? dims[2] - zEnd : zBegin};
        const GridDims extent{dims[0], dims[1], zEnd - zBegin};
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (view_.axisOf[axis] >= 0) {
                start[static_cast<std::size_t>(view_.axisOf[axis])] = static_cast<std::uint64_t>(first[axis]);
                count[static_cast<std::size_t>(view_.axisOf[axis])] = static_cast<std::uint64_t>(extent[axis]);
            }
        blockBegin_ = blockEnd_ = 0;
        block_.resize(planeSamples_ * static_cast<std::size_t>(zEnd - zBegin) * fileTypeSizeBytes(view_.type));
        ISO_TRY(reader_->read(start, count, block_));
        findStrides(count, extent);
        blockBegin_ = zBegin;
        blockEnd_ = zEnd;
        return {};
    }

    // How far apart neighbours along x, y, z are in the block, and where the first sample is.
    void findStrides(const std::vector<std::uint64_t>& count, const GridDims& extent) {
        std::vector<std::int64_t> fileStride(count.size(), 1);
        for (std::size_t axis = count.size(); axis-- > 1;)
            fileStride[axis - 1] = fileStride[axis] * static_cast<std::int64_t>(count[axis]);
        firstSample_ = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            stride_[axis] = view_.axisOf[axis] < 0 ? 0 : fileStride[static_cast<std::size_t>(view_.axisOf[axis])];
            if (view_.isFlipped[axis]) {
                firstSample_ += stride_[axis] * (extent[axis] - 1);
                stride_[axis] = -stride_[axis];
            }
        }
    }

    Status convert(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) const {
        return visitFileType(view_.type, [&](auto in) {
            return visitScalarType(
                info_.type, [&](auto sample) { return convertAs<decltype(in), decltype(sample)>(zBegin, zEnd, out); });
        });
    }

    template <class In, class Out>
    Status convertAs(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) const {
        const GridDims& dims = info_.geometry.dims;
        const auto* samples = reinterpret_cast<const In*>(block_.data());
        std::byte* to = out.data();
        for (std::int64_t z = zBegin; z < zEnd; ++z)
            for (std::int64_t y = 0; y < dims[1]; ++y) {
                const In* at = samples + firstSample_ + (z - blockBegin_) * stride_[2] + y * stride_[1];
                for (std::int64_t x = 0; x < dims[0]; ++x, at += stride_[0], to += sizeof(Out)) {
                    Out value;
                    if (!meantBy(*at, value))
                        return makeError(ErrorCode::InvalidArgument,
                                         "the 64-bit sample " + std::to_string(*at) + " has no exact value in f64",
                                         path_);
                    std::memcpy(to, &value, sizeof value);
                }
            }
        return {};
    }

    /// False if the value cannot be kept.
    template <class In, class Out>
    bool meantBy(In stored, Out& value) const {
        if constexpr (std::is_floating_point_v<Out>) {
            if (meaning_.hasMissing() && isMissing(static_cast<double>(stored))) {
                value = std::numeric_limits<Out>::quiet_NaN();
                return true;
            }
            if (meaning_.rescale) {
                value = static_cast<Out>(static_cast<double>(stored) * meaning_.rescale->slope +
                                         meaning_.rescale->intercept);
                return true;
            }
        }
        value = static_cast<Out>(stored);
        return isExactInDouble(stored);
    }

    bool isMissing(double stored) const {
        return (meaning_.low && stored < *meaning_.low) || (meaning_.high && stored > *meaning_.high) ||
               std::find(meaning_.missing.begin(), meaning_.missing.end(), stored) != meaning_.missing.end();
    }

    VolumeInfo info_;
    ArrayView view_;
    ArrayMeaning meaning_;
    std::unique_ptr<ArrayReader> reader_;
    std::filesystem::path path_;
    std::uint64_t planeSamples_ = 0;
    std::int64_t blockPlanes_ = 1;
    bool isAcross_ = false;
    std::vector<std::byte> block_; ///< planes [blockBegin_, blockEnd_) in the file's order
    std::int64_t blockBegin_ = 0, blockEnd_ = 0;
    std::array<std::int64_t, 3> stride_{};
    std::int64_t firstSample_ = 0;
};

} // namespace

ScalarType arrayType(FileType type, const ArrayMeaning& meaning) {
    const ScalarType own = memoryType(type);
    const ScalarType real = realType(own);
    if (meaning.rescale)
        return meaning.isRescaleWide ? ScalarType::F64 : real;
    return meaning.hasMissing() ? real : own;
}

std::unique_ptr<VolumeSource> makeArraySource(VolumeInfo info, ArrayView view, ArrayMeaning meaning,
                                              std::unique_ptr<ArrayReader> reader, std::filesystem::path path,
                                              std::uint64_t memoryBytes) {
    return std::make_unique<ArraySource>(std::move(info), std::move(view), std::move(meaning), std::move(reader),
                                         std::move(path), memoryBytes);
}

} // namespace isoslider::io
