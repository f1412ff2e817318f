#include "core/volume_io/parsing/file_type.h"

namespace isoslider::io {

std::size_t fileTypeSizeBytes(FileType type) {
    return visitFileType(type, [](auto sample) { return sizeof sample; });
}

std::string_view fileTypeName(FileType type) {
    switch (type) {
        case FileType::U8: return "uint8";
        case FileType::I8: return "int8";
        case FileType::U16: return "uint16";
        case FileType::I16: return "int16";
        case FileType::U32: return "uint32";
        case FileType::I32: return "int32";
        case FileType::U64: return "uint64";
        case FileType::I64: return "int64";
        case FileType::F16: return "float16";
        case FileType::F32: return "float32";
        case FileType::F64: return "float64";
    }
    checkFailed("known FileType", __FILE__, __LINE__);
}

ScalarType memoryType(FileType type) {
    switch (type) {
        case FileType::U8: return ScalarType::U8;
        case FileType::I8: return ScalarType::I8;
        case FileType::U16: return ScalarType::U16;
        case FileType::I16: return ScalarType::I16;
        case FileType::I32: return ScalarType::I32;
        case FileType::F16:
        case FileType::F32: return ScalarType::F32;
        default: return ScalarType::F64;
    }
}

FileType fileTypeOf(ScalarType type) {
    switch (type) {
        case ScalarType::U8: return FileType::U8;
        case ScalarType::I8: return FileType::I8;
        case ScalarType::U16: return FileType::U16;
        case ScalarType::I16: return FileType::I16;
        case ScalarType::I32: return FileType::I32;
        case ScalarType::F32: return FileType::F32;
        case ScalarType::F64: return FileType::F64;
    }
    checkFailed("known ScalarType", __FILE__, __LINE__);
}

} // namespace isoslider::io
