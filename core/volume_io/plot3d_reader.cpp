#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/base/file_system.h"
#include "core/volume_io/curvilinear_resampler.h"
#include "core/volume_io/format_readers.h"
#include "core/volume_io/header_checks.h"

// PLOT3D files say nothing of byte order, precision or record marks. Each combination implies a
// file size; the one that fits is taken. VTK's reader guesses with less to go by.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kDefaultSize = 256;

struct Files {
    fs::path grid, solution;
};

/// How one file of a single block is laid out.
struct Layout {
    GridDims dims{0, 0, 0};
    bool isBigEndian = false;
    bool hasMarks = false;  ///< Fortran's byte counts around each record
    bool hasCount = false;  ///< the number of blocks, 1, comes first
    bool isDouble = false;
    bool hasBlanking = false; ///< an integer per point behind the coordinates
    std::uint64_t valuesBegin = 0;
};

/// Size of the parts before the values, and of all, for a candidate layout.
struct Sizes {
    std::uint64_t dims, values, all;
};

Sizes sizesOf(const Layout& layout, bool isGrid) {
    const std::uint64_t mark = layout.hasMarks ? 4 : 0, real = layout.isDouble ? 8 : 4;
    const auto points = static_cast<std::uint64_t>(pointCount(layout.dims));
    Sizes sizes{};
    sizes.dims = (layout.hasCount ? 4 + 2 * mark : 0) + mark;
    sizes.values = sizes.dims + 12 + mark + mark;
    if (!isGrid) // Mach number, angle, Reynolds number, time
        sizes.values += 4 * real + mark + mark;
    sizes.all = sizes.values + points * real * (isGrid ? 3 : 5) + (layout.hasBlanking ? 4 * points : 0) + mark;
    return sizes;
}

std::uint32_t integerAt(std::span<const std::byte> bytes, std::size_t at, bool isBigEndian) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
        value |= std::to_integer<std::uint32_t>(bytes[at + i]) << 8 * (isBigEndian ? 3 - i : i);
    return value;
}

Result<Layout> detectLayout(const RandomAccessFile& file, bool isGrid) {
    std::vector<std::byte> start(64);
    auto got = file.readAt(0, start);
    if (!got.isOk())
        return std::move(got).error();
    for (unsigned combination = 0; combination < 64; ++combination) {
        // Some old files are padded to whole disk sectors; an exact fit is preferred.
        const std::uint64_t padding = combination < 32 ? 0 : 511;
        Layout layout;
        layout.isBigEndian = (combination & 1) == 0; // the usual one for binary files comes first
        layout.hasMarks = (combination & 2) != 0;
        layout.hasCount = (combination & 4) != 0;
        layout.isDouble = (combination & 8) != 0;
        layout.hasBlanking = (combination & 16) != 0;
        if (layout.hasBlanking && !isGrid)
            continue;
        const std::uint64_t at = sizesOf(layout, isGrid).dims;
        bool isPossible = !layout.hasCount || integerAt(start, layout.hasMarks ? 4 : 0, layout.isBigEndian) == 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            layout.dims[axis] = integerAt(start, at + 4 * axis, layout.isBigEndian);
            isPossible = isPossible && layout.dims[axis] >= 2 && layout.dims[axis] <= 100'000;
        }
        const std::uint64_t size = isPossible ? sizesOf(layout, isGrid).all : 0;
        if (!isPossible || file.sizeBytes() < size || file.sizeBytes() > size + padding)
            continue;
        layout.valuesBegin = sizesOf(layout, isGrid).values;
        return layout;
    }
    return makeError(ErrorCode::InvalidArgument,
                     std::string("is not a PLOT3D ") + (isGrid ? "grid" : "solution") +
                         " file: no dims of a single block at its start agree with its size of " +
                         std::to_string(file.sizeBytes()) + " bytes",
                     file.path());
}

/// `count` reals that start at the layout's values, after `skip` of them.
Result<std::vector<double>> readReals(const RandomAccessFile& file, const Layout& layout, std::uint64_t skip,
                                      std::size_t count) {
    const std::size_t size = layout.isDouble ? 8 : 4;
    std::vector<std::byte> raw(count * size);
    ISO_TRY(file.readExactlyAt(layout.valuesBegin + skip * size, raw));
    std::vector<double> out(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::byte* sample = raw.data() + i * size;
        if (layout.isBigEndian != (std::endian::native == std::endian::big))
            std::reverse(sample, sample + size);
        float single = 0;
        if (layout.isDouble)
            std::memcpy(&out[i], sample, 8);
        else {
            std::memcpy(&single, sample, 4);
            out[i] = static_cast<double>(single);
        }
    }
    return out;
}

std::optional<std::uint64_t> fieldNumber(std::string_view name) {
    const std::string lower = lowerCase(name);
    constexpr std::string_view kNames[][2] = {{"density", ""}, {"x momentum", "momentum x"},
                                              {"y momentum", "momentum y"}, {"z momentum", "momentum z"},
                                              {"energy", "stagnation energy"}};
    for (std::uint64_t i = 0; i < std::size(kNames); ++i)
        if (lower == kNames[i][0] || (lower == kNames[i][1] && !lower.empty()))
            return i;
    return lower.empty() ? std::optional<std::uint64_t>(0) : std::nullopt;
}

Result<Files> findPair(const fs::path& path) {
    constexpr std::string_view kEndings[][2] = {{"xyz.bin", "q.bin"}, {".xyz", ".q"}};
    const std::string name = path.filename().string();
    Files files;
    for (const auto& [gridEnd, solutionEnd] : kEndings) {
        if (name.ends_with(gridEnd))
            files = {path, path.parent_path() / (name.substr(0, name.size() - gridEnd.size()) + std::string(solutionEnd))};
        else if (name.ends_with(solutionEnd))
            files = {path.parent_path() / (name.substr(0, name.size() - solutionEnd.size()) + std::string(gridEnd)), path};
    }
    if (files.grid.empty())
        return makeError(ErrorCode::InvalidArgument, "is not named as one of a PLOT3D pair (xyz.bin and q.bin)", path);
    const fs::path& partner = files.grid == path ? files.solution : files.grid;
    std::error_code ignored;
    if (!fs::exists(partner, ignored))
        return makeError(ErrorCode::NotFound, "the other file of the PLOT3D pair is missing", partner);
    return files;
}

class Plot3dSource final : public WholeGridSource {
public:
    Plot3dSource(VolumeInfo info, CurvilinearGrid curvilinear)
        : info_(std::move(info)), curvilinear_(std::move(curvilinear)) {}

    const VolumeInfo& info() const override { return info_; }

    Result<std::shared_ptr<const ScalarGrid>> grid(const JobControl& job) override {
        if (grid_)
            return grid_;
        auto made = resampleCurvilinear(curvilinear_, info_.geometry, job);
        if (!made.isOk())
            return std::move(made).error();
        grid_ = std::make_shared<const ScalarGrid>(std::move(made).value());
        return grid_;
    }

private:
    VolumeInfo info_;
    CurvilinearGrid curvilinear_;
    std::shared_ptr<const ScalarGrid> grid_;
};

Result<CurvilinearGrid> readPair(const Files& files, std::uint64_t field) {
    auto grid = defaultFileSystem().openForReading(files.grid);
    auto solution = defaultFileSystem().openForReading(files.solution);
    if (!grid.isOk() || !solution.isOk())
        return grid.isOk() ? std::move(solution).error() : std::move(grid).error();
    const auto gridLayout = detectLayout(*grid.value(), true);
    const auto solutionLayout = detectLayout(*solution.value(), false);
    if (!gridLayout.isOk() || !solutionLayout.isOk())
        return gridLayout.isOk() ? solutionLayout.error() : gridLayout.error();
    if (gridLayout.value().dims != solutionLayout.value().dims)
        return makeError(ErrorCode::InvalidArgument, "dims: the two files of the PLOT3D pair disagree", files.solution);
    CurvilinearGrid out;
    out.dims = gridLayout.value().dims;
    const auto points = static_cast<std::size_t>(pointCount(out.dims));
    const auto positions = readReals(*grid.value(), gridLayout.value(), 0, 3 * points);
    const auto values = readReals(*solution.value(), solutionLayout.value(), field * points, points);
    if (!positions.isOk() || !values.isOk())
        return positions.isOk() ? values.error() : positions.error();
    out.points.reserve(points);
    for (std::size_t i = 0; i < points; ++i) {
        const auto& p = positions.value();
        out.points.emplace_back(p[i], p[i + points], p[i + 2 * points]);
        if (!std::isfinite(out.points[i].x) || !std::isfinite(out.points[i].y) || !std::isfinite(out.points[i].z))
            return makeError(ErrorCode::InvalidArgument, "point " + std::to_string(i) + " is not finite", files.grid);
    }
    out.values.assign(values.value().begin(), values.value().end());
    return out;
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openPlot3d(const fs::path& path, const ReadOptions& options) {
    const auto field = fieldNumber(options.field);
    if (!field)
        return refuseField("field", "density, x momentum, y momentum, z momentum or energy expected, found " +
                                        inQuotes(options.field), path);
    const auto files = findPair(path);
    if (!files.isOk())
        return files.error();
    auto curvilinear = readPair(files.value(), *field);
    if (!curvilinear.isOk())
        return std::move(curvilinear).error();
    GridDims wanted = options.resampleDims;
    if (wanted == GridDims{0, 0, 0})
        wanted = {kDefaultSize, kDefaultSize, kDefaultSize};
    const auto dims = checkDims(wanted, "size", path);
    if (!dims.isOk())
        return dims.error();
    ISO_TRY(checkFitsMemory(2 * sizeof(float) * static_cast<std::uint64_t>(pointCount(dims.value())), path));
    VolumeInfo info;
    info.format = "PLOT3D";
    info.type = ScalarType::F32;
    info.fieldName = options.field.empty() ? "density" : options.field;
    info.geometry = boundingGeometry(curvilinear.value().points, dims.value());
    ISO_TRY(checkGeometry(info.geometry, "grid points", path));
    return std::unique_ptr<VolumeSource>(
        std::make_unique<Plot3dSource>(std::move(info), std::move(curvilinear).value()));
}

} // namespace isoslider::io
