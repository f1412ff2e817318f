#include "core/volume_io/sources/magnitude_source.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/base/check.h"

namespace isoslider::io {
namespace {

class MagnitudeSource final : public VolumeSource {
public:
    explicit MagnitudeSource(std::vector<std::unique_ptr<VolumeSource>> components)
        : components_(std::move(components)) {
        ISO_CHECK(!components_.empty() && components_.size() <= kMaxMagnitudeParts);
        info_ = components_.front()->info();
        partType_ = info_.type;
        info_.type = realType(partType_);
        planeSamples_ = static_cast<std::size_t>(info_.geometry.dims[0] * info_.geometry.dims[1]);
        for (const auto& component : components_)
            ISO_CHECK(component->info().type == partType_ && component->info().geometry.dims == info_.geometry.dims);
    }

    const VolumeInfo& info() const override { return info_; }

    // Plane by plane: the squares need no more room than that.
    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) override {
        const std::size_t planeBytes = planeSamples_ * scalarTypeSizeBytes(info_.type);
        ISO_CHECK(out.size() == planeBytes * static_cast<std::size_t>(zEnd - zBegin));
        std::vector<std::byte> plane(planeSamples_ * scalarTypeSizeBytes(partType_));
        std::vector<double> squares(planeSamples_);
        for (std::int64_t z = zBegin; z < zEnd; ++z) {
            std::fill(squares.begin(), squares.end(), 0.0);
            for (const auto& component : components_) {
                ISO_TRY(component->readSlab(z, z + 1, plane));
                visitScalarType(partType_, [&](auto sample) { addSquares<decltype(sample)>(plane, squares); });
            }
            std::byte* target = out.data() + static_cast<std::size_t>(z - zBegin) * planeBytes;
            visitScalarType(info_.type, [&](auto sample) { storeRoots<decltype(sample)>(squares, target); });
        }
        return {};
    }

private:
    template <class T>
    static void addSquares(const std::vector<std::byte>& plane, std::vector<double>& squares) {
        for (std::size_t i = 0; i < squares.size(); ++i) {
            T sample;
            std::memcpy(&sample, plane.data() + i * sizeof(T), sizeof(T));
            squares[i] += static_cast<double>(sample) * static_cast<double>(sample);
        }
    }
    template <class T>
    static void storeRoots(const std::vector<double>& squares, std::byte* out) {
        for (std::size_t i = 0; i < squares.size(); ++i) {
            const T root = static_cast<T>(std::sqrt(squares[i]));
            std::memcpy(out + i * sizeof(T), &root, sizeof(T));
        }
    }

    std::vector<std::unique_ptr<VolumeSource>> components_;
    VolumeInfo info_;
    ScalarType partType_ = ScalarType::U8;
    std::size_t planeSamples_ = 0;
};

} // namespace

std::unique_ptr<VolumeSource> makeMagnitudeSource(std::vector<std::unique_ptr<VolumeSource>> components) {
    return std::make_unique<MagnitudeSource>(std::move(components));
}

} // namespace isoslider::io
