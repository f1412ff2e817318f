#pragma once

#include <QSize>

namespace isoslider::widgets {

/// What a saved picture of the view is like. It has the proportions of the view, so that nothing is cut off, and labels
/// grow with it.
struct PictureChoice {
    static constexpr int kLeastWidth = 64;
    static constexpr int kMostSide = 16384; ///< of either side

    int scale = 1; ///< times the view; 0: `width` is taken
    int width = 1920; ///< pixels
    bool isTransparent = false; ///< no background: an alpha channel in its place

    /// In pixels; no side is above kMostSide. `view`: pixels of the view.
    QSize sizeOf(QSize view) const;
    bool operator==(const PictureChoice&) const = default;
};

} // namespace isoslider::widgets
