#include "core/grid/scalar_type.h"

namespace isoslider {

std::string_view scalarTypeName(ScalarType type) {
    constexpr std::string_view kNames[] = {"u8", "i8", "u16", "i16", "i32", "f32", "f64"};
    return kNames[static_cast<std::size_t>(type)];
}

std::optional<ScalarType> scalarTypeFromName(std::string_view name) {
    for (const ScalarType type : kAllScalarTypes)
        if (scalarTypeName(type) == name)
            return type;
    return std::nullopt;
}

std::size_t scalarTypeSizeBytes(ScalarType type) {
    return visitScalarType(type, [](auto sample) { return sizeof sample; });
}

} // namespace isoslider
