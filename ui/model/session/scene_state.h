#pragma once

#include <optional>

#include "core/extract/merged/merge_bound.h"
#include "ui/model/isovalue/histogram_options.h"
#include "ui/model/session/named_volume.h"
#include "ui/model/slices/slice_options.h"
#include "ui/model/surface/surface_list.h"
#include "ui/model/surface/view_state.h"

namespace isoslider::model {

/// What of one volume's scene a user sets and can take back: all but the camera and what is selected.
struct SceneState {
    double isovalue = 0.0; ///< of the active surface
    SurfaceList surfaces;
    SecondVolumeState second;
    std::optional<double> reference;
    extract::MergeError error;
    ViewOptions view;
    HistogramOptions histogram;
    SliceOptions slices;

    bool operator==(const SceneState&) const = default;
};

} // namespace isoslider::model
