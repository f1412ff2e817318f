#include <new>

#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkDataSet.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLRectilinearGridReader.h>
#include <vtkXMLStructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/formats/vtk/vtk_dataset.h"
#include "core/volume_io/formats/vtk/vtk_xml_cells.h"
#include "core/volume_io/formats/vtk/vtk_xml_header.h"
#include "core/volume_io/parsing/file_type.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/volume_choice.h"

namespace isoslider::io {
namespace {

vtkSmartPointer<vtkXMLReader> xmlReaderOf(VtkKind kind) {
    switch (kind) {
        case VtkKind::Image: return vtkSmartPointer<vtkXMLImageDataReader>::New();
        case VtkKind::Rectilinear: return vtkSmartPointer<vtkXMLRectilinearGridReader>::New();
        case VtkKind::Structured: return vtkSmartPointer<vtkXMLStructuredGridReader>::New();
        case VtkKind::Unstructured: return vtkSmartPointer<vtkXMLUnstructuredGridReader>::New();
    }
    checkFailed("known VtkKind", __FILE__, __LINE__);
}

Status check(const RandomAccessFile& file, const VtkXmlHeader& header, std::size_t array) {
    ISO_TRY(checkVtkXmlRoom(file, header, array));
    return header.kind == VtkKind::Unstructured ? checkVtkXmlCells(file, header) : Status();
}

std::uint64_t bytesPerValue(const VolumeField& field) {
    for (const FileType type :
         {FileType::U8, FileType::I8, FileType::U16, FileType::I16, FileType::U32, FileType::I32, FileType::F32})
        if (field.typeName == fileTypeName(type))
            return fileTypeSizeBytes(type);
    return sizeof(double);
}

/// Has VTK read. What packed arrays of cells claim is not known before: where all that the header speaks of is small,
/// it is the file that is at fault when memory does not suffice, not the machine.
Status update(vtkXMLReader& reader, const VtkXmlHeader& header, const std::filesystem::path& path) {
    constexpr std::uint64_t kSmall = std::uint64_t{1} << 22; // points and cells: some 100 MB of arrays
    try {
        reader.Update();
        return {};
    } catch (const std::bad_alloc&) {
        const auto cells = header.outline.pieces.empty()
                               ? 0
                               : parseInteger(xmlValue(header.outline.pieces[0], "NumberOfCells", "0")).value_or(0);
        if (header.points > kSmall || cells > static_cast<std::int64_t>(kSmall))
            throw;
        return makeError(ErrorCode::Corruption,
                         "its arrays of cells ask for more memory than " + std::to_string(cells) +
                             " cells can need: the file is damaged",
                         path);
    }
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
    ISO_TRY(check(*file.value(), header.value(), contents.preferred));
    const VtkSession session;
    const auto reader = xmlReaderOf(header.value().kind);
    reader->SetFileName(path.c_str());
    reader->UpdateInformation();
    reader->GetPointDataArraySelection()->DisableAllArrays();
    reader->GetCellDataArraySelection()->DisableAllArrays();
    ISO_TRY(update(*reader, header.value(), path));
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
    ISO_TRY(check(*file.value(), header, chosen.value()));
    // VTK holds the array, and it is copied.
    const std::uint64_t values = header.points * static_cast<std::uint64_t>(field.components);
    ISO_TRY(checkFitsMemory(2 * values * bytesPerValue(field), options.memoryBytes, path));

    const VtkSession session;
    const auto reader = xmlReaderOf(header.kind);
    reader->SetFileName(path.c_str());
    reader->UpdateInformation();
    const bool isNamed = !field.name.empty(); // other arrays may be huge, or damaged
    if (isNamed) {
        reader->GetPointDataArraySelection()->DisableAllArrays();
        reader->GetPointDataArraySelection()->EnableArray(field.name.c_str());
    }
    reader->GetCellDataArraySelection()->DisableAllArrays();
    ISO_TRY(update(*reader, header, path));
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
