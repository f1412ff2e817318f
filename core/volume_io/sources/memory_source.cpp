#include <cstring>

#include "core/volume_io/sources/volume_source.h"

namespace isoslider::io {
namespace {

class MemorySource final : public VolumeSource {
public:
    MemorySource(std::shared_ptr<const ScalarGrid> grid, VolumeInfo info)
        : grid_(std::move(grid)), info_(std::move(info)) {
        info_.geometry = grid_->geometry();
        info_.type = grid_->type();
    }

    const VolumeInfo& info() const override { return info_; }

    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) override {
        const auto plane =
            static_cast<std::size_t>(grid_->dims()[0] * grid_->dims()[1]) * scalarTypeSizeBytes(grid_->type());
        const auto bytes = grid_->bytes().subspan(static_cast<std::size_t>(zBegin) * plane,
                                                  static_cast<std::size_t>(zEnd - zBegin) * plane);
        ISO_CHECK(bytes.size() == out.size());
        if (!bytes.empty())
            std::memcpy(out.data(), bytes.data(), bytes.size());
        return {};
    }

private:
    std::shared_ptr<const ScalarGrid> grid_;
    VolumeInfo info_;
};

} // namespace

std::unique_ptr<VolumeSource> makeMemorySource(std::shared_ptr<const ScalarGrid> grid, VolumeInfo info) {
    return std::make_unique<MemorySource>(std::move(grid), std::move(info));
}

std::unique_ptr<VolumeSource> makeMemorySource(std::shared_ptr<const ScalarGrid> grid, std::string format) {
    VolumeInfo info;
    info.format = std::move(format);
    return makeMemorySource(std::move(grid), std::move(info));
}

} // namespace isoslider::io
