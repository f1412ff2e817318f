#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace isoslider::model {

/// A slice by the axis of the world that it lies across. In a grid that is turned in its space it lies across the axis
/// of the grid that comes nearest to that one.
enum class SliceKind { X, Y, Z, Oblique };
inline constexpr std::array<SliceKind, 4> kSliceKinds{SliceKind::X, SliceKind::Y, SliceKind::Z, SliceKind::Oblique};

constexpr std::size_t placeOf(SliceKind kind) { return static_cast<std::size_t>(kind); }
/// REQUIRES: it is not oblique.
constexpr int worldAxisOf(SliceKind kind) { return static_cast<int>(kind); }

/// What stands beside the 3-D view.
enum class SliceLayout { None, One, Three, Four };

/// The values that are drawn black and white.
struct ValueWindow {
    double low = 0.0, high = 1.0;

    double width() const { return high - low; }
    double level() const { return 0.5 * (low + high); }
    bool operator==(const ValueWindow&) const = default;
};

/// What part of a slice its pane shows.
struct PaneView {
    double zoom = 1.0; ///< 1: all of it
    glm::dvec2 middle{0.5}; ///< of the pane, as part of the slice's width and height

    bool operator==(const PaneView&) const = default;
};
inline constexpr double kLeastPaneZoom = 0.25, kMostPaneZoom = 64.0;

/// How slices are shown: all that is worth keeping.
struct SliceOptions {
    SliceLayout layout = SliceLayout::None;
    SliceKind onePane = SliceKind::Z; ///< what SliceLayout::One shows
    std::array<bool, 4> inScene{}; ///< by kind: whether it is in the 3-D view
    glm::dvec3 position{0.0}; ///< where all slices meet; grid index units of the volume
    glm::dquat orientation{1.0, 0.0, 0.0,
                           0.0}; ///< of the oblique slice: right, up and towards the viewer to world axes
    std::optional<ValueWindow> window; ///< none: chosen by the values
    std::array<PaneView, 4> views{}; ///< by kind
    bool showsContour = true;
    bool showsCrosshair = true;

    bool operator==(const SliceOptions&) const = default;
};

} // namespace isoslider::model
