#pragma once

#include <filesystem>
#include <string>

#include "core/volume_io/volume_reader.h"
#include "ui/model/surface/surface_list.h"

namespace isoslider::model {

/// What opens a volume again.
struct NamedVolume {
    std::filesystem::path path; ///< absolute; empty for a built-in sample
    std::string sampleName;
    io::ReadOptions readOptions;

    bool isNone() const { return path.empty() && sampleName.empty(); }
    bool operator==(const NamedVolume&) const = default;
};

/// A second volume, as undo and a session file keep it.
struct SecondVolumeState {
    NamedVolume volume; ///< none: there is no second one
    SurfaceList surfaces; ///< empty: one, at a suggested isovalue

    bool operator==(const SecondVolumeState&) const = default;
};

} // namespace isoslider::model
