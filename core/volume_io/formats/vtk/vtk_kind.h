#pragma once

#include <string_view>

namespace isoslider::io {

/// The kinds of VTK's files that can become a volume, whether XML or not.
enum class VtkKind { Image, Rectilinear, Structured, Unstructured };

/// "VTK image", "VTK rectilinear grid" ...
std::string_view formatName(VtkKind kind);

} // namespace isoslider::io
