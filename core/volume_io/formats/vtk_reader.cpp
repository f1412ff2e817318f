#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataReader.h>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/header_checks.h"
#include "core/volume_io/formats/vti_header.h"
#include "core/volume_io/formats/vtk_bridge.h"

namespace isoslider::io {
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
        return session.error("no image", path);
    vtkDataArray* array = header.value().isFirstUnnamed
                              ? image->GetPointData()->GetArray(0)
                              : image->GetPointData()->GetArray(header.value().array.c_str());
    if (array == nullptr || array->GetNumberOfComponents() != 1 ||
        array->GetNumberOfTuples() != pointCount(header.value().dims))
        return session.error("the array has not one value per point", path);
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
