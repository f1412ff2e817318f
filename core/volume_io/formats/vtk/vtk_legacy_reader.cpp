#include <algorithm>

#include <vtkCharArray.h>
#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkRectilinearGridReader.h>
#include <vtkStructuredGridReader.h>
#include <vtkStructuredPointsReader.h>
#include <vtkUnstructuredGridReader.h>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/formats/vtk/vtk_dataset.h"
#include "core/volume_io/formats/vtk/vtk_legacy_header.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/parsing/text_scanner.h"
#include "core/volume_io/volume_choice.h"

// VTK reads the structure and the samples, but only what has passed the gate of vtk_legacy_header.h, handed over in
// memory: the checked lines and the one array that is wanted. By itself VTK allocates what any header line asks
// for, reads every array to get at one, and on text that is no number warns and leaves the values unset.
// DEVIATION: "nan" and "inf" in text files are refused, for VTK reads neither; binary samples may be NaN.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kSamples = "samples"; ///< the name under which VTK is given the array

vtkSmartPointer<vtkDataReader> readerOf(VtkKind kind) {
    switch (kind) {
        case VtkKind::Image: return vtkSmartPointer<vtkStructuredPointsReader>::New();
        case VtkKind::Rectilinear: return vtkSmartPointer<vtkRectilinearGridReader>::New();
        case VtkKind::Structured: return vtkSmartPointer<vtkStructuredGridReader>::New();
        case VtkKind::Unstructured: return vtkSmartPointer<vtkUnstructuredGridReader>::New();
    }
    checkFailed("known VtkKind", __FILE__, __LINE__);
}

VolumeContents contentsOf(const LegacyFile& file) {
    VolumeContents contents;
    contents.format = formatName(file.kind);
    contents.isPreferredChosen = true;
    for (const LegacyArray& array : file.arrays) {
        VolumeField field;
        field.name = array.name;
        field.dims = file.dims;
        field.typeName = fileTypeName(array.type);
        field.components = static_cast<int>(array.components);
        field.isResampled = file.kind == VtkKind::Structured || file.kind == VtkKind::Unstructured;
        contents.fields.push_back(std::move(field));
    }
    const auto isScalar = [](const VolumeField& field) { return field.components == 1; };
    const auto found = std::find_if(contents.fields.begin(), contents.fields.end(), isScalar);
    if (found != contents.fields.end())
        contents.preferred = static_cast<std::size_t>(found - contents.fields.begin());
    return contents;
}

/// VTK reads `text`, which has to outlive what is done with the reader.
vtkSmartPointer<vtkDataReader> readByVtk(VtkKind kind, std::string& text) {
    const vtkNew<vtkCharArray> input;
    input->SetArray(text.data(), static_cast<vtkIdType>(text.size()), 1);
    auto reader = readerOf(kind);
    reader->ReadFromInputStringOn();
    reader->SetInputArray(input);
    reader->Update();
    return reader;
}

/// The text of a file up to its arrays.
std::string startOf(const LegacyFile& header) {
    std::string text = header.hasOffsets ? "# vtk DataFile Version 5.1\n" : "# vtk DataFile Version 3.0\n";
    text += header.isBinary ? "volume\nBINARY\n" : "volume\nASCII\n";
    return text + header.structure;
}

/// The text of a file that has but one array.
class Excerpt {
public:
    Excerpt(const RandomAccessFile& file, LegacyFile header, const LegacyArray& array, std::uint64_t memoryBytes)
        : file_(file), header_(std::move(header)), array_(array), memoryBytes_(memoryBytes) {}

    Result<std::string> run() {
        const std::uint64_t values = header_.points * array_.components;
        const std::uint64_t width = fileTypeSizeBytes(array_.type), left = file_.sizeBytes() - array_.position;
        const std::uint64_t least = header_.isBinary ? width : 1;
        if (values > left / least)
            return makeError(ErrorCode::Corruption,
                             "file ends early: " + inQuotes(array_.name) + " needs " + std::to_string(values * least) +
                                 " bytes or more, " + std::to_string(left) + " remain",
                             file_.path(), array_.position);
        const std::uint64_t fileBytes = header_.isBinary ? values * width : left;
        ISO_TRY(checkFitsMemory(3 * header_.structure.size() + 2 * fileBytes + 2 * values * width, memoryBytes_,
                                file_.path()));
        text_ = startOf(header_);
        text_ += "POINT_DATA " + std::to_string(header_.points) + "\nFIELD FieldData 1\n" + kSamples + " " +
                 std::to_string(array_.components) + " " + std::to_string(header_.points) + " " +
                 std::string(legacyTypeName(array_.type)) + "\n";
        ISO_TRY(header_.isBinary ? appendSamples(fileBytes) : appendWords(values));
        return std::move(text_);
    }

private:
    Status appendSamples(std::uint64_t sizeBytes) {
        const std::size_t begin = text_.size();
        text_.resize(begin + sizeBytes);
        ISO_TRY(file_.readExactlyAt(array_.position, std::as_writable_bytes(std::span(text_).subspan(begin))));
        text_ += '\n';
        return {};
    }

    Status appendWords(std::uint64_t values) {
        TextScanner scan(file_);
        scan.moveTo(array_.position);
        std::string word;
        for (std::uint64_t i = 0; i < values; ++i) {
            scan.word(word);
            if (!isLegacySample(word, array_.type))
                return makeError(ErrorCode::InvalidArgument,
                                 "sample " + std::to_string(i) + ": " + inQuotes(word) + " is not a value of its type",
                                 file_.path(), scan.position());
            text_ += word;
            text_ += '\n';
        }
        return {};
    }

    const RandomAccessFile& file_;
    LegacyFile header_;
    const LegacyArray& array_;
    std::uint64_t memoryBytes_;
    std::string text_;
};

} // namespace

Result<VolumeContents> listVtkLegacy(const fs::path& path, const ReadOptions& options) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    LegacyRequest request;
    request.keepsStructure = true;
    request.memoryBytes = options.memoryBytes;
    const auto header = readLegacyHeader(*file.value(), request);
    if (!header.isOk())
        return header.error();
    VolumeContents contents = contentsOf(header.value());
    ISO_TRY(checkAnyField(contents, path));
    if (header.value().kind == VtkKind::Image)
        return contents;
    const VtkSession session;
    std::string text = startOf(header.value());
    const auto reader = readByVtk(header.value().kind, text);
    auto* data = vtkDataSet::SafeDownCast(reader->GetOutputDataObject(0));
    if (!session.complaint().empty() || !session.warning().empty() || data == nullptr)
        return session.error(session.warning(), path);
    const auto outlook = outlookOf(*data, options, path);
    if (!outlook.isOk())
        return outlook.error();
    for (VolumeField& field : contents.fields) {
        field.dims = outlook.value().dims;
        field.isResampled = outlook.value().isResampled;
    }
    return contents;
}

Result<std::unique_ptr<VolumeSource>> openVtkLegacy(const fs::path& path, const ReadOptions& options) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    LegacyRequest request;
    request.keepsStructure = true;
    request.memoryBytes = options.memoryBytes;
    request.isLast = [&](const LegacyArray& array) {
        return options.field.empty() ? array.components == 1 : array.name == options.field;
    };
    auto read = readLegacyHeader(*file.value(), request);
    if (!read.isOk())
        return std::move(read).error();
    const VolumeContents contents = contentsOf(read.value());
    const auto chosen = chooseField(contents, options, path);
    if (!chosen.isOk())
        return chosen.error();
    const VolumeField& field = contents.fields[chosen.value()];
    const auto choice = chooseIn(field, options, path);
    if (!choice.isOk())
        return choice.error();

    const VtkKind kind = read.value().kind;
    const LegacyArray array = read.value().arrays[chosen.value()];
    const std::uint64_t points = read.value().points;
    auto text = Excerpt(*file.value(), std::move(read).value(), array, options.memoryBytes).run();
    if (!text.isOk())
        return std::move(text).error();

    const VtkSession session;
    const auto reader = readByVtk(kind, text.value());
    auto* data = vtkDataSet::SafeDownCast(reader->GetOutputDataObject(0));
    if (!session.complaint().empty() || !session.warning().empty() || data == nullptr)
        return session.error(session.warning(), path);
    vtkDataArray* samples = data->GetPointData()->GetArray(kSamples);
    if (samples == nullptr || samples->GetNumberOfComponents() != field.components ||
        static_cast<std::uint64_t>(data->GetNumberOfPoints()) != points ||
        static_cast<std::uint64_t>(samples->GetNumberOfTuples()) != points)
        return session.error("the array has not one value per point", path);
    VolumeInfo info;
    info.format = contents.format;
    info.fieldName = array.name;
    return sourceOf(*data, *samples, choice.value().component, std::move(info), options, path);
}

} // namespace isoslider::io
