#include "ui/render/inactive_buffers.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace isoslider::render {
namespace {

auto orderOf(const InactiveBuffers::Entry& entry) {
    const InactiveSurface& surface = entry.surface;
    const glm::vec3 colour = surface.look.colour.value_or(glm::vec3(-1.0f));
    return std::tuple(surface.frame->isovalue, surface.look.opacity, colour.x, colour.y, colour.z);
}

} // namespace

SurfaceLook lookOf(const model::ListedSurface& surface) {
    SurfaceLook look;
    if (surface.colour != model::kSurfaceColours[0].colour) {
        const auto linear = [](std::uint8_t seen) { return std::pow(static_cast<float>(seen) / 255.0f, 2.2f); };
        look.colour = glm::vec3(linear(surface.colour[0]), linear(surface.colour[1]), linear(surface.colour[2]));
    }
    look.opacity = static_cast<float>(surface.opacity);
    look.isVisible = surface.isVisible;
    return look;
}

void InactiveBuffers::show(std::span<const InactiveSurface> surfaces) {
    std::vector<std::unique_ptr<Entry>> entries;
    for (const InactiveSurface& surface : surfaces) {
        const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) {
            return entry != nullptr && entry->surface.id == surface.id;
        });
        auto entry = found != entries_.end() ? std::move(*found) : std::make_unique<Entry>(gl_, driver_);
        entry->surface = surface;
        entry->buffers.show(surface.frame, model::PieceOptions(surface.hiddenPieces));
        entries.push_back(std::move(entry));
    }
    for (const auto& entry : entries_)
        if (entry != nullptr)
            uploadedBefore_ += entry->buffers.uploadedBytes();
    entries_ = std::move(entries);
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const auto& a, const auto& b) { return orderOf(*a) < orderOf(*b); });
}

void InactiveBuffers::abandon() {
    for (const auto& entry : entries_)
        entry->buffers.abandon();
    entries_.clear();
}

std::uint64_t InactiveBuffers::uploadedBytes() const {
    std::uint64_t bytes = uploadedBefore_;
    for (const auto& entry : entries_)
        bytes += entry->buffers.uploadedBytes();
    return bytes;
}

std::uint64_t InactiveBuffers::refusedBytes() const {
    std::uint64_t most = 0;
    for (const auto& entry : entries_)
        most = std::max(most, entry->buffers.refusedBytes());
    return most;
}

} // namespace isoslider::render
