#include "core/volume_io/vtk_bridge.h"

#include <vector>

#include <vtkDataArray.h>
#include <vtkLogger.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>

#include "core/volume_io/header_checks.h"

namespace isoslider::io {

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

namespace {

std::mutex& oneAtATime() {
    static std::mutex mutex;
    return mutex;
}

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

} // namespace

VtkSession::VtkSession()
    : lock_(oneAtATime()), before_(vtkOutputWindow::GetInstance()),
      window_(vtkSmartPointer<QuietWindow>::New()) {
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF); // prints beside the window
    vtkOutputWindow::SetInstance(window_);
}

VtkSession::~VtkSession() { vtkOutputWindow::SetInstance(before_); }

std::string VtkSession::complaint() const {
    std::string_view text = trimmed(window_->firstError());
    const auto colon = text.rfind("): ");
    if (colon != std::string_view::npos)
        text.remove_prefix(colon + 3);
    return std::string(trimmed(text.substr(0, text.find('\n'))));
}

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

} // namespace isoslider::io
