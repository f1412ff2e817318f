#include "ui/model/surface/clipped_mesh.h"

#include <utility>

#include "core/extract/crop/cropped_mesh.h"

namespace isoslider::model {
namespace {

// Merged cells reach across the sides of the box.
bool isCroppedByCells(const extract::SurfaceMesh& mesh, const Clipping& clipping, CropSides sides) {
    return clipping.isCropped && (sides == CropSides::Closed || !(mesh.mergeBound.limit > 0.0));
}

} // namespace

bool cutsTriangles(const extract::SurfaceMesh& mesh, const Clipping& clipping, CropSides sides) {
    return sides == CropSides::Open &&
           (clipping.hasPlane() || (clipping.isCropped && !isCroppedByCells(mesh, clipping, sides)));
}

Result<extract::SurfaceMesh> clippedMesh(extract::SurfaceMesh mesh, const Clipping& clipping, CropSides sides,
                                         const JobControl& job) {
    const GridGeometry volume = mesh.geometry;
    Clipping left = clipping;
    if (isCroppedByCells(mesh, clipping, sides)) {
        const CropBox box = cropWithin(clipping.crop, volume.dims);
        auto cropped =
            extract::cropMesh(mesh, {box.low, box.high},
                              sides == CropSides::Closed ? extract::BoxSides::Closed : extract::BoxSides::Open, job);
        if (!cropped.isOk() || sides == CropSides::Closed)
            return cropped;
        mesh = std::move(cropped).value();
        left.isCropped = false;
    }
    const auto cuts = cutsOf(left, mesh.geometry, volume);
    return cuts.empty() ? Result<extract::SurfaceMesh>(std::move(mesh)) : extract::cutMesh(mesh, cuts, job);
}

} // namespace isoslider::model
