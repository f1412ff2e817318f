#include <cstring>
#include <mutex>

#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkImageData.h>
#include <vtkLogger.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLImageDataReader.h>

#include "core/volume_io/format_readers.h"
#include "core/volume_io/header_checks.h"
#include "core/volume_io/vti_header.h"

namespace isoslider::io {
namespace {

/// Keeps the first thing VTK says instead of printing it.
class QuietWindow final : public vtkOutputWindow {
public:
    static QuietWindow* New();
    vtkTypeMacro(QuietWindow, vtkOutputWindow);
    void DisplayText(const char* text) override { keep(text); }
    void DisplayErrorText(const char* text) override { keep(text); }
    void DisplayWarningText(const char*) override {}
    void DisplayGenericWarningText(const char*) override {}
    void DisplayDebugText(const char*) override {}

    const std::string& firstError() const { return firstError_; }

private:
    void keep(const char* text) {
        if (firstError_.empty() && text != nullptr)
            firstError_ = text;
    }
    std::string firstError_;
};
vtkStandardNewMacro(QuietWindow);

/// VTK reports through one window for the whole process: one reading at a time.
class VtkSession {
public:
    VtkSession() : lock_(mutex()), before_(vtkOutputWindow::GetInstance()) {
        vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF); // prints beside the window
        vtkOutputWindow::SetInstance(window_);
    }
    ~VtkSession() { vtkOutputWindow::SetInstance(before_); }
    VtkSession(const VtkSession&) = delete;
    VtkSession& operator=(const VtkSession&) = delete;

    /// What VTK complained about, on one line without class names and addresses; empty if nothing.
    std::string complaint() const {
        std::string_view text = trimmed(window_->firstError());
        const auto colon = text.rfind("): ");
        if (colon != std::string_view::npos)
            text.remove_prefix(colon + 3);
        return std::string(trimmed(text.substr(0, text.find('\n'))));
    }

private:
    static std::mutex& mutex() {
        static std::mutex oneAtATime;
        return oneAtATime;
    }
    std::scoped_lock<std::mutex> lock_;
    vtkSmartPointer<vtkOutputWindow> before_;
    vtkNew<QuietWindow> window_;
};

template <class From>
Result<ScalarGrid> widened(const GridGeometry& geometry, const From* values, const std::filesystem::path& path) {
    std::vector<double> out(static_cast<std::size_t>(pointCount(geometry.dims)));
    constexpr double kExact = 9007199254740992.0; // 2^53
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i] = static_cast<double>(values[i]);
        if (out[i] > kExact || out[i] < -kExact)
            return makeError(ErrorCode::InvalidArgument,
                             "the 64-bit sample " + std::to_string(values[i]) + " has no exact value in f64", path);
    }
    return ScalarGrid::fromValues<double>(geometry, ScalarType::F64, out);
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

Error readError(const VtkSession& session, std::string_view otherwise, const std::filesystem::path& path) {
    const std::string said = session.complaint();
    return makeError(ErrorCode::Corruption, "cannot be read by VTK: " + (said.empty() ? std::string(otherwise) : said),
                     path);
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openVtkXml(const std::filesystem::path& path, const ReadOptions& options) {
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    const auto header = checkVtiHeader(*file.value(), options.field);
    if (!header.isOk())
        return header.error();
    ISO_TRY(checkFitsMemory(2 * static_cast<std::uint64_t>(pointCount(header.value().dims)), path));

    VtkSession session;
    vtkNew<vtkXMLImageDataReader> reader;
    reader->SetFileName(path.c_str());
    reader->UpdateInformation();
    if (!header.value().isFirstUnnamed) { // other arrays may be huge, or damaged
        reader->GetPointDataArraySelection()->DisableAllArrays();
        reader->GetPointDataArraySelection()->EnableArray(header.value().array.c_str());
    }
    reader->GetCellDataArraySelection()->DisableAllArrays();
    reader->Update();
    vtkImageData* image = reader->GetOutput();
    if (!session.complaint().empty() || image == nullptr)
        return readError(session, "no image", path);
    vtkDataArray* array = header.value().isFirstUnnamed
                              ? image->GetPointData()->GetArray(0)
                              : image->GetPointData()->GetArray(header.value().array.c_str());
    if (array == nullptr || array->GetNumberOfComponents() != 1 ||
        array->GetNumberOfTuples() != pointCount(header.value().dims))
        return readError(session, "the array has not one value per point", path);
    VolumeInfo info;
    info.format = "VTK image";
    info.fieldName = header.value().array;
    info.geometry = geometryOf(*image, header.value().dims);
    ISO_TRY(checkGeometry(info.geometry, "Spacing, Origin, Direction", path));
    auto grid = toGrid(info.geometry, *array, path);
    if (!grid.isOk())
        return std::move(grid).error();
    return makeMemorySource(std::make_shared<const ScalarGrid>(std::move(grid).value()), std::move(info));
}

} // namespace isoslider::io
