#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/grid/scalar_type.h"
#include "core/index/format/index_format.h"

namespace isoslider::index {

/// A sample that sliding cannot learn from active edges: that of the corner opposite the one that three
/// corners surround (MC33 case 7). See cell::hiddenCornersNeeded.
struct HiddenCorner {
    BrickIndex brick;
    std::uint16_t place = 0; ///< in the brick: 8 * cell + corner
    std::uint64_t key = 0;
};

/// A decoded page, ascending by place: `kHiddenPlacesPerBrick * (brick - first brick) + HiddenCorner::place`.
struct HiddenPage {
    std::vector<std::uint32_t> places;
    std::vector<double> scalars; ///< exactly the samples; -0 as 0
};

/// Encodes as FORMAT.md, "Page of hidden corners", states. Deterministic. REQUIRES: 1 to kMaxHiddenPageCorners,
/// ascending by (brick, place), within kMaxHiddenPageBricks.
std::vector<std::byte> encodeHiddenPage(std::span<const HiddenCorner> corners, ScalarType type);

/// What the directory states of a page with these corners; its place and checksum are the writer's.
HiddenPageEntry hiddenPageEntry(std::span<const HiddenCorner> corners);

/// Decodes and checks everything against the directory's entry, the grid, the type and the range of the samples.
/// Errors: Corruption; `page` is unspecified then. `path` is only for the message.
Status decodeHiddenPage(std::span<const std::byte> bytes, const HiddenPageEntry& entry, const IndexInfo& info,
                        HiddenPage& page, const std::string& path);

} // namespace isoslider::index
