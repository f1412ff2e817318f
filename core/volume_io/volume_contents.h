#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/volume_io/volume_reader.h"

namespace isoslider::io {

/// A scalar field, data set or series of slices, as its file or folder declares it.
struct VolumeField {
    std::string name; ///< for ReadOptions::field, unique in the file; empty where the format has no names
    std::string title; ///< for people, one line; empty: the name will do
    GridDims dims{0, 0, 0}; ///< grid points, after resampling if isResampled
    std::string typeName; ///< of samples as the file stores them: "int16", "float64"
    int components = 1; ///< per sample
    std::vector<std::string> componentNames; ///< as many as components, or none
    bool hasMagnitude = true; ///< of several components; false where they are stored apart
    std::int64_t frames = 1; ///< volumes one after the other: times, echoes, directions
    bool isResampled = false; ///< the file's own grid is not uniform
    std::string problem; ///< why it cannot be opened; empty: it can

    bool needsChoice() const { return components > 1 || frames > 1; }
};

/// What can be opened in a file or folder, known without reading samples where the format allows.
struct VolumeContents {
    std::string format;
    std::vector<VolumeField> fields;
    std::size_t preferred = 0; ///< in `fields`: what the file itself puts forward, or the first that opens
    bool isPreferredChosen = false; ///< openVolume takes the preferred one when no field is named

    /// openVolume would refuse without field, component or frame.
    bool needsChoice() const {
        return !fields.empty() && ((fields.size() > 1 && !isPreferredChosen) || fields[preferred].needsChoice());
    }
};

/// Errors: as openVolume, but for choices that are not made; Cancelled.
Result<VolumeContents> listVolumes(const std::filesystem::path& path, const ReadOptions& options = {},
                                   const JobControl& job = {});

} // namespace isoslider::io
