#pragma once

#include "ui/model/observers.h"

namespace isoslider::model {

/// What the viewport draws beside the surface.
struct ViewOptions {
    bool showsChanged = true; ///< red highlight on what the last move retriangulated
    bool showsLevels = false; ///< merged cells by their size
    bool showsBox = true;
    bool showsAxes = true;
    bool showsEdges = false; ///< the triangles' edges
    bool showsReadout = true; ///< isovalue, triangles and milliseconds in a corner

    bool operator==(const ViewOptions&) const = default;
};

class ViewState {
public:
    const ViewOptions& options() const { return options_; }
    void setOptions(const ViewOptions& options) {
        if (options == options_)
            return;
        options_ = options;
        changed_.notify();
    }
    [[nodiscard]] Subscription observe(std::function<void()> function) { return changed_.observe(std::move(function)); }

private:
    ViewOptions options_;
    ObserverList<> changed_;
};

} // namespace isoslider::model
