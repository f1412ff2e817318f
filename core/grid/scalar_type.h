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

inline constexpr std::array<ScalarType, 7> kAllScalarTypes{ScalarType::U8,  ScalarType::I8,  ScalarType::U16,
                                                           ScalarType::I16, ScalarType::I32, ScalarType::F32,
                                                           ScalarType::F64};

/// Do(Sample, Name) for the C++ type and the ScalarType of every kind of samples: for explicit instantiations, and
/// kernels that are dispatched by name.
#define ISO_FOR_EACH_SAMPLE_TYPE(Do) \
    Do(std::uint8_t, U8) Do(std::int8_t, I8) Do(std::uint16_t, U16) Do(std::int16_t, I16) Do(std::int32_t, I32) \
        Do(float, F32) Do(double, F64)

/// "u8", "i8", "u16", "i16", "i32", "f32", "f64".
std::string_view scalarTypeName(ScalarType type);
std::optional<ScalarType> scalarTypeFromName(std::string_view name);
std::size_t scalarTypeSizeBytes(ScalarType type);
/// The smaller floating type that holds every sample of `type`.
inline ScalarType realType(ScalarType type) {
    return type == ScalarType::I32 || type == ScalarType::F64 ? ScalarType::F64 : ScalarType::F32;
}
inline bool isFloatType(ScalarType type) { return type == ScalarType::F32 || type == ScalarType::F64; }

/// Calls `function` with a value-initialised sample of the C++ type behind `type`.
template <class Function>
decltype(auto) visitScalarType(ScalarType type, Function&& function) {
    switch (type) {
#define ISO_CASE(Sample, Name) \
    case ScalarType::Name: return function(Sample{});
        ISO_FOR_EACH_SAMPLE_TYPE(ISO_CASE)
#undef ISO_CASE
    }
    checkFailed("known ScalarType", __FILE__, __LINE__);
}

} // namespace isoslider
