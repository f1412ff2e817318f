#include "core/volume_io/formats/vtk/vtk_bridge.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkLogger.h>
#include <vtkMatrix3x3.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>

#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::io {

/// Keeps the first thing VTK states instead of printing it.
class QuietWindow final : public vtkOutputWindow {
public:
    static QuietWindow* New();
    vtkTypeMacro(QuietWindow, vtkOutputWindow);
    void DisplayText(const char* text) override { keep(text, firstError_); }
    void DisplayErrorText(const char* text) override { keep(text, firstError_); }
    void DisplayWarningText(const char* text) override { keep(text, firstWarning_); }
    void DisplayGenericWarningText(const char* text) override { keep(text, firstWarning_); }
    void DisplayDebugText(const char*) override {}

    const std::string& firstError() const { return firstError_; }
    const std::string& firstWarning() const { return firstWarning_; }

private:
    static void keep(const char* text, std::string& kept) {
        if (kept.empty() && text != nullptr)
            kept = text;
    }
    std::string firstError_, firstWarning_;
};
vtkStandardNewMacro(QuietWindow);

namespace {

/// One line of what VTK said, without the class name and address before it.
std::string withoutPlace(std::string_view text) {
    text = trimmed(text);
    const auto colon = text.rfind("): ");
    if (colon != std::string_view::npos)
        text.remove_prefix(colon + 3);
    return std::string(trimmed(text.substr(0, text.find('\n'))));
}

std::mutex& oneAtATime() {
    static std::mutex mutex;
    return mutex;
}

template <class From>
Result<ScalarGrid> widened(const GridGeometry& geometry, const From* values, const std::filesystem::path& path) {
    std::vector<double> out(static_cast<std::size_t>(pointCount(geometry.dims)));
    constexpr std::int64_t kExact = std::int64_t{1} << 53; // compared as integers: 2^53 + 1 rounds to it
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i] = static_cast<double>(values[i]);
        if (std::cmp_greater(values[i], kExact) || std::cmp_less(values[i], -kExact))
            return makeError(ErrorCode::InvalidArgument,
                             "the 64-bit sample " + std::to_string(values[i]) + " has no exact value in f64", path);
    }
    return ScalarGrid::fromValues<double>(geometry, ScalarType::F64, out);
}

} // namespace

VtkSession::VtkSession()
    : lock_(oneAtATime()), before_(vtkOutputWindow::GetInstance()), window_(vtkSmartPointer<QuietWindow>::New()) {
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF); // prints beside the window
    vtkOutputWindow::SetInstance(window_);
}

VtkSession::~VtkSession() { vtkOutputWindow::SetInstance(before_); }

std::string VtkSession::complaint() const { return withoutPlace(window_->firstError()); }
std::string VtkSession::warning() const { return withoutPlace(window_->firstWarning()); }

Error VtkSession::error(std::string_view otherwise, const std::filesystem::path& path) const {
    const std::string said = complaint();
    return makeError(ErrorCode::Corruption, "cannot be read by VTK: " + (said.empty() ? std::string(otherwise) : said),
                     path);
}

Result<ScalarGrid> toGrid(const GridGeometry& geometry, vtkDataArray& array, const std::filesystem::path& path) {
    const void* data = array.GetVoidPointer(0);
    const auto as = [&](ScalarType type) -> Result<ScalarGrid> {
        const auto* bytes = static_cast<const std::byte*>(data);
        const std::size_t size = static_cast<std::size_t>(pointCount(geometry.dims)) * scalarTypeSizeBytes(type);
        return ScalarGrid(geometry, type, std::vector<std::byte>(bytes, bytes + size));
    };
    switch (array.GetDataType()) {
        case VTK_UNSIGNED_CHAR: return as(ScalarType::U8);
        case VTK_CHAR:
        case VTK_SIGNED_CHAR: return as(ScalarType::I8);
        case VTK_UNSIGNED_SHORT: return as(ScalarType::U16);
        case VTK_SHORT: return as(ScalarType::I16);
        case VTK_INT: return as(ScalarType::I32);
        case VTK_FLOAT: return as(ScalarType::F32);
        case VTK_DOUBLE: return as(ScalarType::F64);
        case VTK_UNSIGNED_INT: return widened(geometry, static_cast<const unsigned*>(data), path);
        case VTK_LONG: return widened(geometry, static_cast<const long*>(data), path);
        case VTK_UNSIGNED_LONG: return widened(geometry, static_cast<const unsigned long*>(data), path);
        case VTK_LONG_LONG:
        case VTK_ID_TYPE: return widened(geometry, static_cast<const long long*>(data), path);
        case VTK_UNSIGNED_LONG_LONG: return widened(geometry, static_cast<const unsigned long long*>(data), path);
        default: return refuseField("type", "is not a type of scalars that is read", path);
    }
}

Result<ScalarGrid> componentGrid(const GridGeometry& geometry, vtkDataArray& array, int component,
                                 const std::filesystem::path& path) {
    ISO_CHECK(array.GetNumberOfTuples() == pointCount(geometry.dims) && component < array.GetNumberOfComponents());
    if (component == kMagnitude) {
        const bool isWide =
            array.GetDataTypeSize() > 4 || array.GetDataType() == VTK_INT || array.GetDataType() == VTK_UNSIGNED_INT;
        std::vector<double> lengths(static_cast<std::size_t>(array.GetNumberOfTuples()));
        for (std::size_t i = 0; i < lengths.size(); ++i)
            for (int c = 0; c < array.GetNumberOfComponents(); ++c)
                lengths[i] = std::hypot(lengths[i], array.GetComponent(static_cast<vtkIdType>(i), c));
        if (isWide)
            return ScalarGrid::fromValues<double>(geometry, ScalarType::F64, lengths);
        const std::vector<float> narrow(lengths.begin(), lengths.end());
        return ScalarGrid::fromValues<float>(geometry, ScalarType::F32, narrow);
    }
    if (array.GetNumberOfComponents() == 1)
        return toGrid(geometry, array, path);
    const auto single = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(array.GetDataType()));
    single->SetNumberOfTuples(array.GetNumberOfTuples());
    single->CopyComponent(0, &array, component);
    return toGrid(geometry, *single, path);
}

GridGeometry geometryOf(vtkImageData& image, const GridDims& dims) {
    GridGeometry geometry;
    geometry.dims = dims;
    const vtkMatrix3x3* direction = image.GetDirectionMatrix();
    const int* extent = image.GetExtent();
    for (int axis = 0; axis < 3; ++axis) {
        geometry.spacing[axis] = image.GetSpacing()[axis];
        geometry.origin[axis] = image.GetOrigin()[axis];
        for (int row = 0; row < 3; ++row)
            geometry.direction[axis][row] = direction->GetElement(row, axis);
    }
    // VTK's origin is that of index (0, 0, 0), which the extent may leave out.
    const glm::dvec3 first(extent[0], extent[2], extent[4]);
    geometry.origin += geometry.direction * (geometry.spacing * first);
    return geometry;
}

} // namespace isoslider::io
