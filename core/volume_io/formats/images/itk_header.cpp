#include "core/volume_io/formats/images/itk_header.h"

#include <sys/mman.h>
#include <unistd.h>

#include <iostream>
#include <mutex>

#include <glm/geometric.hpp>
#if defined(__clang__) // Debian's ITK asks for the compiler that it was built with: to this header alone, Clang is GCC 5
#pragma push_macro("__clang__")
#pragma push_macro("__GNUC__")
#undef __clang__
#undef __GNUC__
#define __GNUC__ 5
#include <itk_compiler_detection.h>
#pragma pop_macro("__GNUC__")
#pragma pop_macro("__clang__")
#endif
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include "core/base/quiet_stream.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

itk::ImageIOBase::Pointer makeImageIo(ItkFormat format) {
    switch (format) {
        case ItkFormat::MetaImage: return itk::MetaImageIO::New().GetPointer();
        case ItkFormat::Nrrd: return itk::NrrdImageIO::New().GetPointer();
    }
    checkFailed("known ItkFormat", __FILE__, __LINE__);
}

// The last line of an ITK exception says what was wrong; the others name classes and addresses.
std::string lastLine(std::string_view text) {
    text = trimmed(text);
    const auto end = text.find_last_of('\n');
    text = trimmed(end == std::string_view::npos ? text : text.substr(end + 1));
    const auto address = text.find("): "); // "ITK ERROR: Class(0x...): what was wrong"
    return std::string(address == std::string_view::npos ? text : text.substr(address + 3));
}

Status checkAgreement(const itk::ImageIOBase& io, const GridDims& dims, const std::filesystem::path& path) {
    for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis)
        if (static_cast<std::int64_t>(io.GetDimensions(axis)) != (axis < 3 ? dims[axis] : 1) || io.GetNumberOfComponents() != 1)
            return refuseField("dimensions", "are read as something else by ITK", path);
    return {};
}

GridGeometry geometryOf(const itk::ImageIOBase& io, const GridDims& dims) {
    GridGeometry geometry;
    geometry.dims = dims;
    const unsigned known = std::min(io.GetNumberOfDimensions(), 3u);
    for (unsigned axis = 0; axis < known; ++axis) {
        const int column = static_cast<int>(axis);
        geometry.spacing[column] = io.GetSpacing(axis);
        geometry.origin[column] = io.GetOrigin(axis);
        const std::vector<double> direction = io.GetDirection(axis);
        for (unsigned row = 0; row < 3; ++row)
            geometry.direction[column][static_cast<int>(row)] = row < direction.size() ? direction[row] : 0.0;
    }
    if (known == 2) // one slice: the third axis stands on it
        geometry.direction[2] = glm::cross(geometry.direction[0], geometry.direction[1]);
    return geometry;
}

// `fileName` is what ITK opens, `path` what messages name.
Result<GridGeometry> readGeometry(const std::string& fileName, ItkFormat format, const GridDims& dims,
                                  const std::filesystem::path& path) {
    // ITK's parsers keep state in globals.
    static std::mutex oneAtATime;
    const std::scoped_lock lock(oneAtATime);
    itk::Object::SetGlobalWarningDisplay(false);
    const QuietStream quietErrors(std::cerr), quietOutput(std::cout); // MetaIO prints what it throws
    try {
        const auto io = makeImageIo(format);
        io->SetFileName(fileName);
        io->ReadImageInformation();
        ISO_TRY(checkAgreement(*io, dims, path));
        return geometryOf(*io, dims);
    } catch (const itk::ExceptionObject& problem) {
        return makeError(ErrorCode::InvalidArgument, "header refused by ITK: " + lastLine(problem.GetDescription()),
                         path);
    } catch (const std::exception& problem) {
        return makeError(ErrorCode::InvalidArgument, "header refused by ITK: " + lastLine(problem.what()), path);
    }
}

} // namespace

Result<GridGeometry> readItkGeometryOfText(std::string_view header, ItkFormat format, const GridDims& dims,
                                           const std::filesystem::path& path) {
    const int descriptor = ::memfd_create("header", MFD_CLOEXEC);
    if (descriptor < 0 || ::write(descriptor, header.data(), header.size()) != static_cast<ssize_t>(header.size())) {
        if (descriptor >= 0)
            ::close(descriptor);
        return makeError(ErrorCode::OutOfSpace, "no memory for a copy of its header", path);
    }
    auto geometry = readGeometry("/proc/self/fd/" + std::to_string(descriptor), format, dims, path);
    ::close(descriptor);
    return geometry;
}

} // namespace isoslider::io
