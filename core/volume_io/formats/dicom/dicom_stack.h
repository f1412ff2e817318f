#pragma once

#include <string>
#include <vector>

#include "core/volume_io/formats/dicom/dicom_image.h"
#include "core/volume_io/volume_contents.h"

namespace isoslider::io {

/// One frame of one file.
struct DicomSlice {
    std::size_t image = 0; ///< in the list of images
    std::size_t frame = 0;
};

/// Slices of one size and orientation that make a volume, or a series of them.
struct DicomStack {
    VolumeField field; ///< with the problem, if the slices make no volume
    std::vector<std::vector<DicomSlice>> frames; ///< slices by rising position, all of the same places
    GridGeometry geometry; ///< millimetres, left-posterior-superior; of the volume after a gantry tilt is undone
    ScalarType type = ScalarType::U8; ///< of one component, slope and intercept applied
    /// In samples, to the next slice: not zero if the gantry was tilted. `firstSample`: where the grid begins
    /// in the first slice.
    glm::dvec2 shift{0.0};
    glm::dvec2 firstSample{0.0};
    /// Of unevenly spaced slices, along the normal in planes of the grid; else empty: there is a slice in
    /// each.
    std::vector<double> places;
    std::vector<std::string> notes;
    bool hasMillimetres = false; ///< false: the slices state nothing of their spacing, and 1 is assumed

    bool isTilted() const { return shift != glm::dvec2(0.0); }
};

/// Sorts the images of a file or folder into stacks: by series, then by what cannot be one volume (size,
/// type, orientation, spacing), then, where several slices share a place, by what distinguishes them. Spacing
/// comes from the positions. Slices without a position follow by their instance number. O(n log n) in slices
/// for each attribute that is tried.
std::vector<DicomStack> buildDicomStacks(const std::vector<DicomImage>& images);

} // namespace isoslider::io
