#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>

#include "core/base/plain_text.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/parsing/byte_decoder.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/parsing/reading_memory.h"
#include "core/volume_io/parsing/text_scanner.h"
#include "core/volume_io/volume_choice.h"

// Gaussian cube files: text, the third axis fastest, so that the first plane is known when the last number
// has been read: from a file that is larger than memory, planes come in several passes. Numbers are kept as they are
// written, in f64; lengths stay in the unit of the file.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kMaxAtoms = 1'000'000;
constexpr std::int64_t kMaxValues = 10'000; ///< per grid point

struct Header {
    std::string title;
    GridGeometry geometry;
    bool isInBohr = true;
    std::vector<std::string> orbitals; ///< their numbers, where the values are those of orbitals
    std::int64_t values = 1; ///< per grid point
};

/// A cube file, unpacked as it is read.
struct Text {
    std::unique_ptr<ByteDecoder> bytes;
    TextReader reader{*bytes};

    explicit Text(std::unique_ptr<ByteDecoder> decoder) : bytes(std::move(decoder)) {}
};

bool isPacked(const fs::path& path) { return lowerCase(path.filename().string()).ends_with(".gz"); }

Result<std::unique_ptr<Text>> openText(const fs::path& path) {
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    return std::make_unique<Text>(
        makeDecoder(std::move(file).value(), 0, isPacked(path) ? Encoding::Deflate : Encoding::Plain));
}

Error endsIn(std::string_view what, const TextReader& reader, const fs::path& path) {
    if (!reader.status().isOk())
        return reader.status().error();
    return makeError(ErrorCode::Corruption, "ends within " + std::string(what), path);
}

/// "COUNT X Y Z [MORE]".
struct CountedVector {
    std::int64_t count = 0;
    glm::dvec3 vector{0.0};
    std::int64_t more = 1;
};

Result<CountedVector> readCountedVector(TextReader& reader, std::string_view field, bool takesMore,
                                        const fs::path& path) {
    std::string line;
    if (!reader.line(line))
        return endsIn("its header", reader, path);
    const auto parts = words(line);
    const bool hasMore = takesMore && parts.size() == 5;
    CountedVector out;
    const auto count = parts.empty() ? std::nullopt : parseInteger(parts[0]);
    bool isGood = count && (parts.size() == 4 || hasMore);
    for (int axis = 0; isGood && axis < 3; ++axis) {
        const auto number = parseFortranReal(parts[static_cast<std::size_t>(axis) + 1]);
        isGood = number && std::isfinite(*number);
        out.vector[axis] = number.value_or(0.0);
    }
    const auto more = hasMore ? parseInteger(parts[4]) : std::optional<std::int64_t>(1);
    if (!isGood || !more)
        return refuseField(field,
                           "a whole number and three lengths expected, found " + inQuotes(trimmed(line)) +
                               ": is not a Gaussian cube",
                           path);
    out.count = *count;
    out.more = *more;
    return out;
}

// A negative number of atoms announces which orbitals the values are of.
Status readOrbitals(TextReader& reader, Header& header, const fs::path& path) {
    std::string word;
    if (!reader.word(word))
        return endsIn("its list of orbitals", reader, path);
    const auto count = parseInteger(word);
    if (!count || *count < 1 || *count > kMaxValues)
        return refuseField("orbitals", inQuotes(word) + " is not a number from 1 to 10000", path);
    for (std::int64_t i = 0; i < *count; ++i) {
        if (!reader.word(word))
            return endsIn("its list of orbitals", reader, path);
        if (!parseInteger(word))
            return refuseField("orbitals", inQuotes(word) + " is not the number of one", path);
        header.orbitals.push_back("orbital " + word);
    }
    if (header.values != 1 && header.values != *count)
        return refuseField(
            "values per point",
            std::to_string(header.values) + " for each of " + std::to_string(*count) + " orbitals are not read", path);
    header.values = *count;
    return {};
}

Result<Header> readHeader(TextReader& reader, const fs::path& path) {
    Header header;
    std::string line, second;
    if (!reader.line(line) || !reader.line(second))
        return endsIn("its two lines of title", reader, path);
    header.title = std::string(trimmed(line)) + " " + std::string(trimmed(second));
    header.title = trimmed(oneLine(header.title.substr(0, 200)));
    const auto atoms = readCountedVector(reader, "atoms and origin", true, path);
    if (!atoms.isOk())
        return atoms.error();
    const std::int64_t atomCount = atoms.value().count;
    if (atomCount < -kMaxAtoms || atomCount > kMaxAtoms)
        return refuseField("atoms", "more than 1000000", path);
    header.values = atoms.value().more;
    if (header.values < 1 || header.values > kMaxValues)
        return refuseField("values per point", std::to_string(header.values) + " is not a number from 1 to 10000",
                           path);
    header.geometry.origin = atoms.value().vector;
    std::vector<std::int64_t> sizes;
    for (int axis = 0; axis < 3; ++axis) {
        const auto step = readCountedVector(reader, "axis " + std::to_string(axis + 1), false, path);
        if (!step.isOk())
            return step.error();
        if (axis == 0) // a negative number of points states angstrom
            header.isInBohr = step.value().count > 0;
        sizes.push_back(std::max(step.value().count, -step.value().count));
        header.geometry.spacing[axis] = glm::length(step.value().vector);
        header.geometry.direction[axis] = step.value().vector / header.geometry.spacing[axis];
    }
    const auto dims = checkDims(sizes, "points along the axes", path);
    if (!dims.isOk())
        return dims.error();
    header.geometry.dims = dims.value();
    ISO_TRY(checkGeometry(header.geometry, "steps along the axes", path));
    for (std::int64_t i = 0; i < std::abs(atomCount); ++i)
        if (!reader.line(line))
            return endsIn("its list of atoms", reader, path);
    if (atomCount < 0)
        ISO_TRY(readOrbitals(reader, header, path));
    if (pointCount(header.geometry.dims) > kMaxPoints / header.values)
        return refuseField("points along the axes", "more than 2^40 values in all", path);
    return header;
}

// A number and the blank behind it take two bytes at least.
Status checkSize(const Header& header, const fs::path& path) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    const auto values = static_cast<std::uint64_t>(pointCount(header.geometry.dims) * header.values);
    const std::uint64_t least =
        leastEncodedBytes(isPacked(path) ? Encoding::Deflate : Encoding::Plain, 2 * values - 1, FileType::U8);
    if (least > file.value()->sizeBytes())
        return makeError(ErrorCode::Corruption,
                         "its header asks for " + std::to_string(values) + " numbers, which a file of " +
                             std::to_string(file.value()->sizeBytes()) + " bytes cannot hold",
                         path);
    return {};
}

Result<Header> describe(const fs::path& path) {
    auto text = openText(path);
    if (!text.isOk())
        return std::move(text).error();
    auto header = readHeader(text.value()->reader, path);
    if (header.isOk())
        ISO_TRY(checkSize(header.value(), path));
    return header;
}

VolumeField fieldOf(const Header& header) {
    VolumeField field;
    field.title = header.title;
    field.dims = header.geometry.dims;
    field.typeName = "text";
    field.components = static_cast<int>(header.values);
    field.componentNames = header.orbitals;
    return field;
}

/// All planes at once where they fit into what reading may hold; otherwise as many as do, in as many passes over the
/// file.
class CubeSource final : public VolumeSource {
public:
    CubeSource(fs::path path, VolumeInfo info, int component, const ReadOptions& options)
        : path_(std::move(path)),
          info_(std::move(info)),
          component_(component),
          allowsTrailing_(options.allowsTrailing) {
        info_.type = ScalarType::F64;
        const GridDims& dims = info_.geometry.dims;
        const std::uint64_t planeBytes = sizeof(double) * static_cast<std::uint64_t>(dims[0] * dims[1]);
        const std::uint64_t most = readingMemoryOf(options.memoryBytes) / 2; // the other half is slabs
        passPlanes_ = static_cast<std::int64_t>(
            std::clamp<std::uint64_t>(most / planeBytes, 1, static_cast<std::uint64_t>(dims[2])));
    }

    const VolumeInfo& info() const override { return info_; }

    Status prepare(const JobControl& job) override { return planeEnd_ > 0 ? Status() : load(0, job); }

    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) override {
        const auto [nx, ny, nz] = info_.geometry.dims;
        ISO_CHECK(zBegin >= 0 && zBegin <= zEnd && zEnd <= nz);
        std::byte* to = out.data();
        for (std::int64_t z = zBegin; z < zEnd; ++z) {
            if (z < planeBegin_ || z >= planeEnd_)
                ISO_TRY(load(z, {}));
            const std::int64_t planes = planeEnd_ - planeBegin_;
            for (std::int64_t y = 0; y < ny; ++y)
                for (std::int64_t x = 0; x < nx; ++x, to += sizeof(double))
                    std::memcpy(to, &samples_[static_cast<std::size_t>((x * ny + y) * planes + z - planeBegin_)],
                                sizeof(double));
        }
        return {};
    }

private:
    // As many planes as may be held, from `begin` on.
    Status load(std::int64_t begin, const JobControl& job) {
        planeBegin_ = planeEnd_ = 0;
        samples_.clear();
        auto text = openText(path_);
        if (!text.isOk())
            return std::move(text).error();
        const auto header = readHeader(text.value()->reader, path_);
        if (!header.isOk())
            return header.error();
        if (header.value().geometry != info_.geometry)
            return makeError(ErrorCode::Corruption, "has changed since it was opened", path_);
        const std::int64_t end = std::min(begin + passPlanes_, info_.geometry.dims[2]);
        ISO_TRY(readSamples(text.value()->reader, header.value().values, begin, end, job));
        isChecked_ = true;
        planeBegin_ = begin;
        planeEnd_ = end;
        return {};
    }

    Status readSamples(TextReader& reader, std::int64_t values, std::int64_t zBegin, std::int64_t zEnd,
                       const JobControl& job) {
        const GridDims& dims = info_.geometry.dims;
        const std::int64_t count = pointCount(dims);
        const auto kept = static_cast<std::size_t>(dims[0] * dims[1] * (zEnd - zBegin));
        // Room for all is made when these have come: there may be fewer than the header states.
        constexpr std::size_t kFirstSamples = std::size_t{1} << 20;
        samples_.reserve(std::min(kept, kFirstSamples));
        std::string word;
        for (std::int64_t i = 0; i < count; ++i) {
            if (samples_.size() == kFirstSamples)
                samples_.reserve(kept);
            if (i % (dims[1] * dims[2]) == 0) {
                if (job.isStopRequested())
                    return cancelledError();
                job.report(static_cast<double>(i) / static_cast<double>(count), "reading");
            }
            const std::int64_t z = i % dims[2];
            const bool isKept = z >= zBegin && z < zEnd;
            double sample = 0.0;
            for (std::int64_t value = 0; value < values; ++value) {
                if (!reader.word(word))
                    return endsIn("its numbers: " + std::to_string(count * values) + " expected, found " +
                                      std::to_string(i * values + value),
                                  reader, path_);
                if (!isKept && isChecked_)
                    continue;
                const auto number = word.size() <= kMaxScannedWord ? parseFortranReal(word) : std::nullopt;
                if (!number)
                    return makeError(
                        ErrorCode::InvalidArgument,
                        "number " + std::to_string(i * values + value) + ": " + inQuotes(word) + " is not one", path_);
                if (component_ == kMagnitude)
                    sample += *number * *number;
                else if (value == component_)
                    sample = *number;
            }
            if (isKept)
                samples_.push_back(component_ == kMagnitude ? std::sqrt(sample) : sample);
        }
        if (!allowsTrailing_ && reader.word(word))
            return makeError(ErrorCode::InvalidArgument,
                             "has more than the " + std::to_string(count * values) +
                                 " numbers expected (trailing ones have to be allowed)",
                             path_);
        return reader.status();
    }

    fs::path path_;
    VolumeInfo info_;
    int component_;
    bool allowsTrailing_;
    bool isChecked_ = false; ///< all numbers have been looked at
    std::int64_t passPlanes_ = 1;
    std::int64_t planeBegin_ = 0, planeEnd_ = 0;
    std::vector<double> samples_; ///< those planes, in the file's order
};

} // namespace

Result<std::unique_ptr<VolumeSource>> openCube(const fs::path& path, const ReadOptions& options) {
    const auto header = describe(path);
    if (!header.isOk())
        return header.error();
    const auto choice = chooseInOnlyField(fieldOf(header.value()), options, path);
    if (!choice.isOk())
        return choice.error();
    VolumeInfo info;
    info.format = "Gaussian cube";
    info.geometry = header.value().geometry;
    info.fieldTitle = header.value().title;
    info.lengthUnit = header.value().isInBohr ? "bohr" : "Å";
    return std::unique_ptr<VolumeSource>(
        std::make_unique<CubeSource>(path, std::move(info), choice.value().component, options));
}

Result<VolumeContents> listCube(const fs::path& path, const ReadOptions&) {
    const auto header = describe(path);
    if (!header.isOk())
        return header.error();
    VolumeContents contents;
    contents.format = "Gaussian cube";
    contents.fields.push_back(fieldOf(header.value()));
    return contents;
}

} // namespace isoslider::io
