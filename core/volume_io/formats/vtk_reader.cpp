#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkDataSet.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLRectilinearGridReader.h>
#include <vtkXMLStructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/formats/vtk_dataset.h"
#include "core/volume_io/formats/vtk_xml_header.h"
#include "core/volume_io/header_checks.h"
#include "core/volume_io/volume_choice.h"

namespace isoslider::io {
namespace {

vtkSmartPointer<vtkXMLReader> readerOf(VtkKind kind) {
    switch (kind) {
        case VtkKind::Image: return vtkSmartPointer<vtkXMLImageDataReader>::New();
        case VtkKind::Rectilinear: return vtkSmartPointer<vtkXMLRectilinearGridReader>::New();
        case VtkKind::Structured: return vtkSmartPointer<vtkXMLStructuredGridReader>::New();
        case VtkKind::Unstructured: return vtkSmartPointer<vtkXMLUnstructuredGridReader>::New();
    }
    checkFailed("known VtkKind", __FILE__, __LINE__);
}

} // namespace

Result<VolumeContents> listVtkXml(const std::filesystem::path& path, const ReadOptions& options) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    const auto header = readVtkXmlHeader(*file.value());
    if (!header.isOk())
        return header.error();
    VolumeContents contents = contentsOf(header.value());
    if (header.value().kind == VtkKind::Image)
        return contents;
    ISO_TRY(checkVtkXmlRoom(*file.value(), header.value(), contents.preferred));
    const VtkSession session;
    const auto reader = readerOf(header.value().kind);
    reader->SetFileName(path.c_str());
    reader->UpdateInformation();
    reader->GetPointDataArraySelection()->DisableAllArrays();
    reader->GetCellDataArraySelection()->DisableAllArrays();
    reader->Update();
    vtkDataSet* data = reader->GetOutputAsDataSet();
    if (!session.complaint().empty() || data == nullptr)
        return session.error("no grid", path);
    const auto outlook = outlookOf(*data, options, path);
    if (!outlook.isOk())
        return outlook.error();
    for (VolumeField& field : contents.fields) {
        field.dims = outlook.value().dims;
        field.isResampled = outlook.value().isResampled;
    }
    return contents;
}

Result<std::unique_ptr<VolumeSource>> openVtkXml(const std::filesystem::path& path, const ReadOptions& options) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    const auto read = readVtkXmlHeader(*file.value());
    if (!read.isOk())
        return read.error();
    const VtkXmlHeader& header = read.value();
    const VolumeContents contents = contentsOf(header);
    const auto chosen = chooseField(contents, options, path);
    if (!chosen.isOk())
        return chosen.error();
    const VolumeField& field = contents.fields[chosen.value()];
    const auto choice = chooseIn(field, options, path);
    if (!choice.isOk())
        return choice.error();
    ISO_TRY(checkVtkXmlRoom(*file.value(), header, chosen.value()));
    ISO_TRY(checkFitsMemory(2 * header.points * static_cast<std::uint64_t>(field.components), path));

    const VtkSession session;
    const auto reader = readerOf(header.kind);
    reader->SetFileName(path.c_str());
    reader->UpdateInformation();
    const bool isNamed = !field.name.empty(); // other arrays may be huge, or damaged
    if (isNamed) {
        reader->GetPointDataArraySelection()->DisableAllArrays();
        reader->GetPointDataArraySelection()->EnableArray(field.name.c_str());
    }
    reader->GetCellDataArraySelection()->DisableAllArrays();
    reader->Update();
    vtkDataSet* data = reader->GetOutputAsDataSet();
    if (!session.complaint().empty() || data == nullptr)
        return session.error("no grid", path);
    vtkDataArray* array = isNamed ? data->GetPointData()->GetArray(field.name.c_str())
                                  : data->GetPointData()->GetArray(static_cast<int>(chosen.value()));
    if (array == nullptr || array->GetNumberOfComponents() != field.components ||
        static_cast<std::uint64_t>(data->GetNumberOfPoints()) != header.points ||
        static_cast<std::uint64_t>(array->GetNumberOfTuples()) != header.points)
        return session.error("the array has not one value per point", path);
    VolumeInfo info;
    info.format = contents.format;
    info.fieldName = field.name;
    return sourceOf(*data, *array, choice.value().component, std::move(info), options, path);
}

} // namespace isoslider::io
