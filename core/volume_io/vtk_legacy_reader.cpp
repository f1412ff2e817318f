#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/volume_io/format_readers.h"
#include "core/volume_io/header_checks.h"
#include "core/volume_io/sample_source.h"

// Not VTK's own reader: it allocates whatever a header asks for, and reads every array of the file
// to get at one. Binary samples (big-endian, by the format) are streamed from where they lie.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

struct TypeName {
    std::string_view name;
    FileType type;
};
constexpr TypeName kTypes[] = {
    {"unsigned_char", FileType::U8}, {"char", FileType::I8},           {"unsigned_short", FileType::U16},
    {"short", FileType::I16},        {"unsigned_int", FileType::U32},  {"int", FileType::I32},
    {"unsigned_long", FileType::U64}, {"long", FileType::I64},         {"vtktypeint64", FileType::I64},
    {"vtktypeuint64", FileType::U64}, {"vtkidtype", FileType::I32},    {"float", FileType::F32},
    {"double", FileType::F64}};

constexpr std::size_t kWindowBytes = std::size_t{1} << 16;

/// Walks a file of text lines with runs of samples between them, holding a window of it.
class Scanner {
public:
    explicit Scanner(const RandomAccessFile& file) : file_(file) {}

    const fs::path& path() const { return file_.path(); }
    std::uint64_t position() const { return windowBegin_ + at_; }
    std::uint64_t remaining() const { return file_.sizeBytes() - std::min(position(), file_.sizeBytes()); }
    void moveTo(std::uint64_t position) {
        windowBegin_ = position;
        window_.clear();
        at_ = 0;
    }

    /// The next line, without its end; at most kMaxHeaderLine bytes of it. False at the end.
    bool line(std::string& out) {
        out.clear();
        while (true) {
            if (at_ == window_.size() && !fill())
                return !out.empty();
            const char c = window_[at_++];
            if (c == '\n')
                return true;
            if (out.size() < kMaxHeaderLine)
                out += c;
        }
    }

    /// The next line that is not blank.
    bool textLine(std::string& out) {
        while (line(out))
            if (!trimmed(out).empty())
                return true;
        return false;
    }

    bool word(std::string& out) {
        out.clear();
        while (at_ < window_.size() || fill()) {
            const char c = window_[at_];
            const bool isBlank = c == ' ' || c == '\n' || c == '\t' || c == '\r';
            if (isBlank && !out.empty())
                return true;
            ++at_;
            if (!isBlank && out.size() < 64)
                out += c;
        }
        return !out.empty();
    }

private:
    bool fill() {
        windowBegin_ += window_.size();
        at_ = 0;
        window_.resize(kWindowBytes);
        const auto got = file_.readAt(windowBegin_, std::as_writable_bytes(std::span(window_)));
        window_.resize(got.isOk() ? got.value() : 0);
        return !window_.empty();
    }

    const RandomAccessFile& file_;
    std::string window_;
    std::uint64_t windowBegin_ = 0;
    std::size_t at_ = 0;
};

struct Array {
    std::string name;
    FileType type = FileType::F32;
    std::uint64_t components = 1;
};

class LegacyReader {
public:
    LegacyReader(const RandomAccessFile& file, std::string field) : scan_(file), field_(std::move(field)) {
        info_.format = "VTK image";
    }

    Result<std::unique_ptr<VolumeSource>> open() {
        ISO_TRY(readPreamble());
        ISO_TRY(readStructure());
        return findScalars();
    }

private:
    Error refuse(std::string_view field, std::string_view problem) const {
        return refuseField(field, problem, scan_.path());
    }

    Status readPreamble() {
        std::string line;
        if (!scan_.line(line) || !line.starts_with("# vtk DataFile Version"))
            return makeError(ErrorCode::InvalidArgument, "is not a VTK file: '# vtk DataFile Version' expected",
                             scan_.path());
        scan_.line(line); // title
        scan_.textLine(line);
        const std::string encoding = lowerCase(trimmed(line));
        if (encoding != "ascii" && encoding != "binary")
            return refuse("encoding", "ASCII or BINARY expected in the third line, found " + inQuotes(trimmed(line)));
        isBinary_ = encoding == "binary";
        if (!scan_.textLine(line))
            return refuse("DATASET", "missing: the file ends early");
        const auto dataset = words(line);
        if (dataset.size() != 2 || lowerCase(dataset[0]) != "dataset" || lowerCase(dataset[1]) != "structured_points")
            return refuse("DATASET", "STRUCTURED_POINTS expected, found " + inQuotes(trimmed(line)));
        return {};
    }

    Status readStructure() {
        std::vector<std::int64_t> sizes;
        std::string line;
        while (scan_.textLine(line)) {
            const auto parts = words(line);
            const std::string key = lowerCase(parts[0]);
            if (key == "point_data")
                return finishStructure(sizes, parts);
            if (key == "cell_data")
                return refuse("CELL_DATA", "values belong to cells; convert them to point data first");
            const std::string_view tail = trimmed(std::string_view(line)).substr(parts[0].size());
            std::vector<double> numbers;
            const bool isKnown = key == "dimensions" ? parseIntegers(tail, sizes) && sizes.size() == 3
                                                     : parseReals(tail, numbers) && numbers.size() == 3;
            if (!isKnown)
                return refuse(inQuotes(parts[0]), "three numbers expected");
            if (key == "spacing" || key == "aspect_ratio")
                info_.geometry.spacing = {numbers[0], numbers[1], numbers[2]};
            else if (key == "origin")
                info_.geometry.origin = {numbers[0], numbers[1], numbers[2]};
            else if (key != "dimensions")
                return refuse(inQuotes(parts[0]), "is not known here");
        }
        return refuse("POINT_DATA", "missing: there are no samples");
    }

    Status finishStructure(std::span<const std::int64_t> sizes, std::span<const std::string_view> parts) {
        const auto dims = checkDims(sizes, "DIMENSIONS", scan_.path());
        if (!dims.isOk())
            return dims.error();
        info_.geometry.dims = dims.value();
        ISO_TRY(checkGeometry(info_.geometry, "SPACING, ORIGIN", scan_.path()));
        points_ = static_cast<std::uint64_t>(pointCount(dims.value()));
        const auto count = parts.size() == 2 ? parseInteger(parts[1]) : std::nullopt;
        if (!count || *count < 0 || static_cast<std::uint64_t>(*count) != points_)
            return refuse("POINT_DATA", "DIMENSIONS give " + std::to_string(points_) + " points");
        return {};
    }

    // Attributes follow each other; those before the wanted one are stepped over.
    Result<std::unique_ptr<VolumeSource>> findScalars() {
        std::string line;
        while (scan_.textLine(line)) {
            const auto parts = words(line);
            const std::string key = lowerCase(parts[0]);
            if (key == "field") {
                const auto arrays = parts.size() == 3 ? parseInteger(parts[2]) : std::nullopt;
                if (!arrays || *arrays < 0 || *arrays > 10000)
                    return refuse("FIELD", "a name and a number of arrays expected");
                fieldArrays_ = *arrays;
                continue;
            }
            if (key == "metadata") {
                while (scan_.line(line) && !trimmed(line).empty()) {}
                continue;
            }
            if (key == "cell_data")
                break;
            auto array = fieldArrays_ > 0 ? fieldArray(parts) : attribute(key, parts);
            if (!array.isOk())
                return std::move(array).error();
            fieldArrays_ -= fieldArrays_ > 0;
            const bool isWanted = field_.empty() ? array.value().components == 1 : array.value().name == field_;
            if (isWanted)
                return deliver(array.value());
            ISO_TRY(skip(array.value()));
        }
        return refuse("field", field_.empty() ? "the file has no array of scalars"
                                              : "the file has no array named " + inQuotes(field_));
    }

    Result<FileType> type(std::string_view name) const {
        for (const TypeName& known : kTypes)
            if (known.name == lowerCase(name))
                return known.type;
        return refuse("type", inQuotes(name) + " is not a known type of scalars");
    }

    Result<Array> makeArray(std::string_view name, std::string_view typeName, std::string_view components) const {
        const auto known = type(typeName);
        if (!known.isOk())
            return known.error();
        const auto count = parseInteger(components);
        if (!count || *count < 1 || *count > 1000)
            return refuse("components", inQuotes(components) + " is not a number of components");
        return Array{std::string(name), known.value(), static_cast<std::uint64_t>(*count)};
    }

    // "name components tuples type"
    Result<Array> fieldArray(std::span<const std::string_view> parts) const {
        if (parts.size() != 4 || parseInteger(parts[2]) != static_cast<std::int64_t>(points_))
            return refuse("FIELD", "an array with one value per point expected");
        return makeArray(parts[0], parts[3], parts[1]);
    }

    Result<Array> attribute(std::string_view key, std::span<const std::string_view> parts) {
        if (parts.size() < 2)
            return refuse("attribute", inQuotes(key) + " is not known here");
        if (key == "scalars" && parts.size() >= 3) {
            const std::uint64_t before = scan_.position();
            std::string line;
            if (!scan_.textLine(line) || !lowerCase(trimmed(line)).starts_with("lookup_table"))
                scan_.moveTo(before);
            return makeArray(parts[1], parts[2], parts.size() > 3 ? parts[3] : "1");
        }
        if ((key == "vectors" || key == "normals") && parts.size() == 3)
            return makeArray(parts[1], parts[2], "3");
        if (key == "tensors" && parts.size() == 3)
            return makeArray(parts[1], parts[2], "9");
        if (key == "texture_coordinates" && parts.size() == 4)
            return makeArray(parts[1], parts[3], parts[2]);
        if (key == "color_scalars" && parts.size() == 3)
            return makeArray(parts[1], "unsigned_char", parts[2]);
        return refuse("attribute", inQuotes(key) + " is not known here");
    }

    Status checkRoom(const Array& array) const {
        const std::uint64_t least = isBinary_ ? fileTypeSizeBytes(array.type) : 1;
        if (points_ * array.components > scan_.remaining() / least)
            return makeError(ErrorCode::Corruption,
                             "file ends early: " + inQuotes(array.name) + " needs " +
                                 std::to_string(points_ * array.components * least) + " bytes or more, " +
                                 std::to_string(scan_.remaining()) + " remain",
                             scan_.path(), scan_.position());
        return {};
    }

    Status skip(const Array& array) {
        ISO_TRY(checkRoom(array));
        if (isBinary_) {
            scan_.moveTo(scan_.position() + points_ * array.components * fileTypeSizeBytes(array.type));
            return {};
        }
        std::string ignored;
        for (std::uint64_t i = 0; i < points_ * array.components; ++i)
            if (!scan_.word(ignored))
                return refuse(array.name, "file ends early");
        return {};
    }

    Result<std::unique_ptr<VolumeSource>> deliver(const Array& array) {
        if (array.components != 1)
            return refuse("components", inQuotes(array.name) + " has " + std::to_string(array.components) +
                                            "; only scalar volumes are read");
        ISO_TRY(checkRoom(array));
        info_.fieldName = array.name;
        if (!isBinary_)
            return readText(array);
        auto bytes = openParts({{scan_.path(), scan_.position()}}, points_ * fileTypeSizeBytes(array.type));
        if (!bytes.isOk())
            return std::move(bytes).error();
        return makeSampleSource(std::move(info_), {array.type, true, std::nullopt}, std::move(bytes).value(), scan_.path());
    }

    Result<std::unique_ptr<VolumeSource>> readText(const Array& array) {
        const ScalarType memory = memoryType(array.type);
        ISO_TRY(checkFitsMemory(points_ * scalarTypeSizeBytes(memory), scan_.path()));
        std::vector<std::byte> samples(points_ * scalarTypeSizeBytes(memory));
        ISO_TRY(visitScalarType(memory, [&](auto sample) { return parseSamples<decltype(sample)>(samples); }));
        info_.type = memory;
        auto grid = std::make_shared<const ScalarGrid>(info_.geometry, memory, std::move(samples));
        return makeMemorySource(std::move(grid), std::move(info_));
    }

    template <class T>
    Status parseSamples(std::span<std::byte> samples) {
        std::string word;
        for (std::uint64_t i = 0; i < points_; ++i) {
            scan_.word(word);
            // By way of long long or double: from_chars reads no 8-bit numbers, only characters.
            using Wide = std::conditional_t<std::is_integral_v<T>, std::int64_t, double>;
            Wide value{};
            const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
            bool isGood = problem == std::errc{} && end == word.data() + word.size();
            if constexpr (std::is_integral_v<T>)
                isGood = isGood && value >= std::numeric_limits<T>::min() && value <= std::numeric_limits<T>::max();
            if (!isGood)
                return makeError(ErrorCode::InvalidArgument,
                                 "sample " + std::to_string(i) + ": " + inQuotes(word) + " is not a value of its type",
                                 scan_.path(), scan_.position());
            const T sample = static_cast<T>(value);
            std::memcpy(samples.data() + i * sizeof(T), &sample, sizeof(T));
        }
        return {};
    }

    VolumeInfo info_;
    Scanner scan_;
    std::string field_;
    bool isBinary_ = false;
    std::uint64_t points_ = 0;
    std::int64_t fieldArrays_ = 0;
};

} // namespace

Result<std::unique_ptr<VolumeSource>> openVtkLegacy(const fs::path& path, const ReadOptions& options) {
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    return LegacyReader(*file.value(), options.field).open();
}

} // namespace isoslider::io
