#pragma once

#include <string>
#include <utility>
#include <vector>

namespace isoslider::cli {

/// Lines over two axes, as an SVG picture with a white ground.
struct LinePlot {
    struct Line {
        std::string name; ///< in the legend; empty: none there
        std::vector<std::pair<double, double>> points; ///< left to right
        std::size_t colour = 0; ///< lines of one number have one colour
        bool isDashed = false;
        bool hasDots = true;
    };

    std::string title, xLabel, yLabel; ///< labels with units
    bool isLogX = false, isLogY = false;
    std::vector<Line> lines;

    /// Points that a logarithmic axis cannot show are left out. Bytes that XML does not allow in texts are escaped
    /// or left out.
    std::string svg() const;
};

} // namespace isoslider::cli
