#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/plain_text.h"
#include "core/volume_io/formats/data_files.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/formats/images/nrrd_geometry.h"
#include "core/volume_io/formats/images/nrrd_header.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/sources/magnitude_source.h"
#include "core/volume_io/sources/sample_source.h"
#include "core/volume_io/volume_choice.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

/// What to read, file by file, with all its axes.
struct Data {
    std::vector<FilePart> parts;
    std::uint64_t partBytes = 0;
    Encoded how;
    bool isLonger = false; ///< than its samples
};

Result<Encoding> readEncoding(const NrrdHeader& header, const fs::path& path) {
    const std::string name = lowerCase(header["encoding"]);
    if (name == "raw")
        return Encoding::Plain;
    if (name == "gzip" || name == "gz")
        return Encoding::Deflate;
    if (name == "bzip2" || name == "bz2")
        return Encoding::Bzip2;
    if (name == "hex")
        return Encoding::Hex;
    if (header.isText())
        return Encoding::Text;
    return refuseField("encoding", inQuotes(name) + " is not read; raw, gzip, bzip2, hex and ascii are", path);
}

/// Names of data files, and of how many dimensions each is (0: not said).
struct NamedFiles {
    std::vector<std::string> names;
    std::int64_t dimension = 0;
};

Result<NamedFiles> nameFiles(const NrrdHeader& header, const fs::path& path) {
    const std::string_view value = header["data file"];
    const auto parts = words(value);
    const bool isList = value.starts_with("LIST"), isPattern = !isList && value.find('%') != std::string_view::npos;
    NamedFiles files;
    if (!isList && !isPattern) {
        files.names = {std::string(value)};
        return files;
    }
    const bool hasDimension = parts.size() == (isList ? 2u : 5u);
    if (isList && (parts[0] != "LIST" || parts.size() > 2))
        return refuseField("data file", "LIST and at most a number expected, found " + inQuotes(value), path);
    if (hasDimension) {
        const auto dimension = parseInteger(parts.back());
        if (!dimension || *dimension < 1 || *dimension > static_cast<std::int64_t>(header.axes.size()))
            return refuseField("data file", inQuotes(parts.back()) + " is not the number of dimensions of a file",
                               path);
        files.dimension = *dimension;
    }
    if (isList) {
        files.names = header.dataFiles;
        return files;
    }
    const auto end = hasDimension ? static_cast<std::size_t>(parts.back().data() - value.data()) : value.size();
    auto names = expandPattern(value.substr(0, end), "data file", path);
    if (!names.isOk())
        return std::move(names).error();
    files.names = std::move(names).value();
    return files;
}

// As many files as there are slices of their dimension.
Status checkFileCount(const NrrdHeader& header, const NamedFiles& files, const fs::path& path) {
    std::int64_t expected = 1;
    for (std::size_t axis = static_cast<std::size_t>(files.dimension); axis < header.axes.size(); ++axis)
        expected *= header.axes[axis].size;
    const auto count = static_cast<std::int64_t>(files.names.size());
    const bool isSlab = files.dimension == static_cast<std::int64_t>(header.axes.size()); // any number of them
    if (files.dimension > 0 && !isSlab && count != expected)
        return refuseField("data file",
                           std::to_string(expected) + " files of " + std::to_string(files.dimension) +
                               " dimensions expected, found " + std::to_string(count),
                           path);
    return {};
}

Status skipLines(FilePart& part, std::int64_t lines, const fs::path& path) {
    if (lines == 0)
        return {};
    auto file = defaultFileSystem().openForReading(part.path);
    if (!file.isOk())
        return std::move(file).error();
    std::vector<std::byte> buffer(std::size_t{1} << 16);
    for (std::uint64_t at = part.offset;;) {
        auto got = file.value()->readAt(at, buffer);
        if (!got.isOk())
            return std::move(got).error();
        if (got.value() == 0)
            return refuseField("line skip", "the data file has fewer lines", path);
        for (std::size_t i = 0; i < got.value(); ++i)
            if (buffer[i] == std::byte{'\n'} && --lines == 0) {
                part.offset = at + i + 1;
                return {};
            }
        at += got.value();
    }
}

// Moves each part's offset behind what `line skip` and `byte skip` leave out; of compressed data, bytes are
// skipped once it is unpacked.
Status applySkips(const NrrdHeader& header, Data& data, const fs::path& path) {
    const auto number = [&](std::string_view key) {
        return header[key].empty() ? std::optional<std::int64_t>(0) : parseInteger(header[key]);
    };
    const auto lines = number("line skip"), bytes = number("byte skip");
    const bool isPacked = data.how.encoding == Encoding::Deflate || data.how.encoding == Encoding::Bzip2;
    if (!lines || *lines < 0)
        return refuseField("line skip", inQuotes(header["line skip"]) + " is not a number of lines", path);
    if (!bytes || *bytes < -1 || *bytes > kMaxPoints || (*bytes == -1 && data.how.encoding != Encoding::Plain))
        return refuseField("byte skip", inQuotes(header["byte skip"]) + " is not a number of bytes", path);
    for (FilePart& part : data.parts) {
        ISO_TRY(skipLines(part, *lines, path));
        auto file = defaultFileSystem().openForReading(part.path);
        if (!file.isOk())
            return std::move(file).error();
        const std::uint64_t size = file.value()->sizeBytes();
        if (*bytes == -1)
            part.offset = size >= data.partBytes ? size - data.partBytes : 0;
        else if (!isPacked)
            part.offset += static_cast<std::uint64_t>(*bytes);
        if (part.offset > size)
            return refuseField("byte skip", "leads beyond the end of the data", path);
        data.isLonger |= data.how.encoding == Encoding::Plain && size - part.offset > data.partBytes;
    }
    data.how.skipBytes = isPacked ? static_cast<std::uint64_t>(*bytes) : 0;
    return {};
}

VolumeField fieldOf(const NrrdHeader& header) {
    VolumeField field;
    field.title = oneLine(header["content"].substr(0, 200));
    field.dims = header.dims();
    field.typeName = fileTypeName(header.type);
    field.components = static_cast<int>(header.extent(NrrdRole::Component));
    field.componentNames = header.componentNames();
    field.frames = header.extent(NrrdRole::Frame);
    return field;
}

Result<Data> findData(const NrrdHeader& header, const ReadOptions& options, const fs::path& path) {
    const auto encoding = readEncoding(header, path);
    if (!encoding.isOk())
        return encoding.error();
    Data data;
    if (!header["data file"].empty()) {
        const auto files = nameFiles(header, path);
        if (!files.isOk())
            return files.error();
        ISO_TRY(checkFileCount(header, files.value(), path));
        auto parts = locateDataFiles(files.value().names, "data file", path, options.allowsExternalData);
        if (!parts.isOk())
            return std::move(parts).error();
        data.parts = std::move(parts).value();
    } else if (header.isDetached) {
        return refuseField("data file", "missing, and no samples follow the header", path);
    } else {
        data.parts = {{path, header.sizeBytes}};
    }
    std::uint64_t values = 1;
    for (const NrrdAxis& axis : header.axes)
        values *= static_cast<std::uint64_t>(axis.size);
    if (values % data.parts.size() != 0)
        return refuseField("data file", std::to_string(data.parts.size()) + " files do not divide the samples evenly",
                           path);
    data.partBytes = values / data.parts.size() * fileTypeSizeBytes(header.type);
    data.how = {encoding.value(), header.type, 0, options.allowsTrailing, planeBytes(fieldOf(header), header.type)};
    ISO_TRY(applySkips(header, data, path));
    return data;
}

// The fastest axis is none of space: its values lie beside each other, and the sample source picks one.
bool isInterleaved(const NrrdHeader& header) {
    return header.axes[0].role != NrrdRole::Space && header.axes[0].size > 1;
}
bool hasInterleavedComponents(const NrrdHeader& header) {
    return isInterleaved(header) && header.axes[0].role == NrrdRole::Component;
}

/// The samples of one component and frame, or all those of an interleaved axis. Axes are taken out from the
/// slowest on, so that those that are left stay where they are.
Result<std::unique_ptr<ByteStream>> openSamples(const NrrdHeader& header, const Data& data, std::int64_t component,
                                                std::int64_t frame) {
    auto bytes = openEncoded(data.parts, data.partBytes, data.how);
    if (!bytes.isOk())
        return bytes;
    std::unique_ptr<ByteStream> stream = std::move(bytes).value();
    for (std::size_t axis = header.axes.size(); axis-- > 0;) {
        const NrrdAxis& held = header.axes[axis];
        if (held.role == NrrdRole::Space || held.size == 1 || axis == 0)
            continue;
        Runs runs;
        runs.runBytes = fileTypeSizeBytes(header.type);
        for (std::size_t faster = 0; faster < axis; ++faster)
            runs.runBytes *= static_cast<std::uint64_t>(header.axes[faster].size);
        runs.firstByte =
            runs.runBytes * static_cast<std::uint64_t>(held.role == NrrdRole::Component ? component : frame);
        runs.strideBytes = runs.runBytes * static_cast<std::uint64_t>(held.size);
        stream = takeRuns(std::move(stream), runs);
    }
    return stream;
}

/// Header, files and first bytes, checked against each other.
struct Described {
    NrrdHeader header;
    Data data;
    VolumeField field;
};

Result<Described> describe(const fs::path& path, const ReadOptions& options) {
    auto header = readNrrdHeader(path);
    if (!header.isOk())
        return std::move(header).error();
    auto data = findData(header.value(), options, path);
    if (!data.isOk())
        return std::move(data).error();
    const auto bytes = openEncoded(data.value().parts, data.value().partBytes, data.value().how);
    if (!bytes.isOk())
        return bytes.error();
    VolumeField field = fieldOf(header.value());
    return Described{std::move(header).value(), std::move(data).value(), std::move(field)};
}

Result<std::unique_ptr<VolumeSource>> openComponent(const Described& volume, const VolumeInfo& info,
                                                    const Choice& choice, const fs::path& path) {
    auto bytes = openSamples(volume.header, volume.data, std::max(choice.component, 0), choice.frame);
    if (!bytes.isOk())
        return std::move(bytes).error();
    const bool isBig = volume.data.how.encoding == Encoding::Text ? std::endian::native == std::endian::big
                                                                  : volume.header.isBigEndian;
    SampleLayout layout{volume.header.type, isBig, std::nullopt};
    if (isInterleaved(volume.header)) {
        layout.components = static_cast<int>(volume.header.axes[0].size);
        layout.component = hasInterleavedComponents(volume.header) ? choice.component : static_cast<int>(choice.frame);
    }
    return makeSampleSource(info, layout, std::move(bytes).value(), path);
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openNrrd(const fs::path& path, const ReadOptions& options) {
    const auto described = describe(path, options);
    if (!described.isOk())
        return described.error();
    const Described& volume = described.value();
    const auto chosen = chooseInOnlyField(volume.field, options, path);
    if (!chosen.isOk())
        return chosen.error();
    VolumeInfo info;
    info.format = "NRRD";
    info.dataFiles = filesBeside(path, volume.data.parts);
    const auto place = readNrrdPlace(volume.header, info.notes, path);
    if (!place.isOk())
        return place.error();
    info.geometry = place.value().geometry;
    info.isPatientSpace = place.value().isPatientSpace;
    ISO_TRY(checkGeometry(info.geometry, "spacings or space directions", path));
    info.fieldTitle = volume.field.title;
    info.lengthUnit = lengthUnitOf(volume.header);
    if (volume.data.isLonger)
        info.notes.push_back("the data file is longer than the samples; the rest is ignored");
    Choice choice = chosen.value();
    if (choice.component != kMagnitude || hasInterleavedComponents(volume.header))
        return openComponent(volume, info, choice, path);
    if (volume.field.components > static_cast<int>(kMaxMagnitudeParts))
        return refuseField("--component magnitude", "is taken of at most 64 components", path);
    std::vector<std::unique_ptr<VolumeSource>> parts;
    for (choice.component = 0; choice.component < volume.field.components; ++choice.component) {
        auto part = openComponent(volume, info, choice, path);
        if (!part.isOk())
            return std::move(part).error();
        parts.push_back(std::move(part).value());
    }
    return makeMagnitudeSource(std::move(parts));
}

Result<VolumeContents> listNrrd(const fs::path& path, const ReadOptions& options) {
    auto volume = describe(path, options);
    if (!volume.isOk())
        return std::move(volume).error();
    VolumeContents contents;
    contents.format = "NRRD";
    contents.fields.push_back(std::move(volume.value().field));
    return contents;
}

} // namespace isoslider::io
