#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <type_traits>

#include "core/base/check.h"
#include "core/grid/scalar_type.h"

namespace isoslider::io {

/// Sample types that occur in files. Those without a ScalarType are widened: F16 to f32, the others to f64.
enum class FileType { U8, I8, U16, I16, U32, I32, U64, I64, F16, F32, F64 };

/// An IEEE 754 number of 16 bits, as it lies in a file.
struct Half {
    std::uint16_t bits = 0;

    operator float() const { // NOLINT: every value is exact in a float
        const int exponent = (bits >> 10) & 31, fraction = bits & 1023;
        const float size = exponent == 0    ? std::ldexp(static_cast<float>(fraction), -24)
                           : exponent != 31 ? std::ldexp(static_cast<float>(1024 + fraction), exponent - 25)
                           : fraction == 0  ? std::numeric_limits<float>::infinity()
                                            : std::numeric_limits<float>::quiet_NaN();
        return (bits & 0x8000) != 0 ? -size : size;
    }
};

/// Calls `function` with a value-initialised sample of the C++ type behind `type`.
template <class Function>
decltype(auto) visitFileType(FileType type, Function&& function) {
    switch (type) {
        case FileType::U8: return function(std::uint8_t{});
        case FileType::I8: return function(std::int8_t{});
        case FileType::U16: return function(std::uint16_t{});
        case FileType::I16: return function(std::int16_t{});
        case FileType::U32: return function(std::uint32_t{});
        case FileType::I32: return function(std::int32_t{});
        case FileType::U64: return function(std::uint64_t{});
        case FileType::I64: return function(std::int64_t{});
        case FileType::F16: return function(Half{});
        case FileType::F32: return function(float{});
        case FileType::F64: return function(double{});
    }
    checkFailed("known FileType", __FILE__, __LINE__);
}

/// False for 64-bit integers that a double has to round.
template <class T>
bool isExactInDouble(T value) {
    if constexpr (std::is_integral_v<T> && sizeof(T) == 8) {
        const double converted = static_cast<double>(value);
        // 2^63 and 2^64 do not convert back.
        return converted < std::ldexp(1.0, std::is_signed_v<T> ? 63 : 64) && static_cast<T>(converted) == value;
    }
    return true;
}

std::size_t fileTypeSizeBytes(FileType type);
/// "uint8", "int8", ..., "float16", "float32", "float64".
std::string_view fileTypeName(FileType type);
/// The type of FileType's samples in memory, when no slope is applied.
ScalarType memoryType(FileType type);
FileType fileTypeOf(ScalarType type);

} // namespace isoslider::io
