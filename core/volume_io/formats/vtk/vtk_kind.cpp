#include "core/volume_io/formats/vtk/vtk_kind.h"

#include <cstddef>

namespace isoslider::io {

std::string_view formatName(VtkKind kind) {
    constexpr std::string_view kNames[] = {"VTK image", "VTK rectilinear grid", "VTK structured grid",
                                           "VTK unstructured grid"};
    return kNames[static_cast<std::size_t>(kind)];
}

} // namespace isoslider::io
