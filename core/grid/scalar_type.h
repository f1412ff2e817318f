#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/check.h"

namespace isoslider {

/// Sample types that a volume may have in memory and in an index. Values are on disk: never reorder.
enum class ScalarType : std::uint8_t { U8 = 0, I8 = 1, U16 = 2, I16 = 3, I32 = 4, F32 = 5, F64 = 6 };

inline constexpr std::array<ScalarType, 7> kAllScalarTypes{
    ScalarType::U8,  ScalarType::I8,  ScalarType::U16, ScalarType::I16,
    ScalarType::I32, ScalarType::F32, ScalarType::F64};

/// "u8", "i8", "u16", "i16", "i32", "f32", "f64".
std::string_view scalarTypeName(ScalarType type);
std::optional<ScalarType> scalarTypeFromName(std::string_view name);
std::size_t scalarTypeSizeBytes(ScalarType type);
inline bool isFloatType(ScalarType type) { return type == ScalarType::F32 || type == ScalarType::F64; }

/// Calls `function` with a value-initialised sample of the C++ type behind `type`.
template <class Function>
decltype(auto) visitScalarType(ScalarType type, Function&& function) {
    switch (type) {
        case ScalarType::U8: return function(std::uint8_t{});
        case ScalarType::I8: return function(std::int8_t{});
        case ScalarType::U16: return function(std::uint16_t{});
        case ScalarType::I16: return function(std::int16_t{});
        case ScalarType::I32: return function(std::int32_t{});
        case ScalarType::F32: return function(float{});
        case ScalarType::F64: return function(double{});
    }
    checkFailed("known ScalarType", __FILE__, __LINE__);
}

} // namespace isoslider
