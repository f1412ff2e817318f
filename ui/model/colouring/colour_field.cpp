#include "ui/model/colouring/colour_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

#include "core/base/memory_limit.h"
#include "core/grid/gradient.h"
#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

constexpr std::uint64_t kShareOfMemory = 4; // for planes of values: a fourth
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Means of blocks, from planes in ascending order.
class BlockMeans {
public:
    BlockMeans(const GridDims& dims, std::int64_t side) : dims_(dims), side_(side) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            blocks_[axis] = (dims[axis] + side - 1) / side;
        sums_.resize(static_cast<std::size_t>(blocks_[0] * blocks_[1]));
        counts_.resize(sums_.size());
        means_.reserve(static_cast<std::size_t>(pointCount(blocks_)));
    }
    void add(std::int64_t z, std::span<const float> plane) {
        const float* value = plane.data();
        for (std::int64_t y = 0; y < dims_[1]; ++y) {
            const auto row = static_cast<std::size_t>(y / side_ * blocks_[0]);
            for (std::int64_t x = 0; x < dims_[0]; ++x, ++value)
                if (std::isfinite(*value)) {
                    const std::size_t block = row + static_cast<std::size_t>(x / side_);
                    sums_[block] += static_cast<double>(*value);
                    ++counts_[block];
                }
        }
        if ((z + 1) % side_ != 0 && z + 1 != dims_[2])
            return;
        for (std::size_t block = 0; block < sums_.size(); ++block)
            means_.push_back(counts_[block] > 0 ? static_cast<float>(sums_[block] / counts_[block]) : kNone);
        std::fill(sums_.begin(), sums_.end(), 0.0);
        std::fill(counts_.begin(), counts_.end(), 0);
    }
    const GridDims& blocks() const { return blocks_; }
    std::vector<float> take() { return std::move(means_); }

private:
    GridDims dims_, blocks_{};
    std::int64_t side_;
    std::vector<double> sums_;
    std::vector<std::int32_t> counts_;
    std::vector<float> means_;
};

/// Of the middle one of three planes.
void takeGradients(const std::vector<float>& planes, const GridGeometry& geometry, std::int64_t z,
                   std::span<float> lengths) {
    const GridDims& dims = geometry.dims;
    const auto rowStride = static_cast<std::ptrdiff_t>(dims[0]);
    const auto planeStride = static_cast<std::ptrdiff_t>(dims[0] * dims[1]);
    const glm::vec3 inverse(1.0 / geometry.spacing);
    const float* point = planes.data() + planeStride;
    float* length = lengths.data();
    for (std::int64_t y = 0; y < dims[1]; ++y)
        for (std::int64_t x = 0; x < dims[0]; ++x, ++point, ++length) {
            if (isMissing(*point)) {
                *length = kNone;
                continue;
            }
            const glm::vec3 gradient(derivativeAt(point, 1, x > 0, x + 1 < dims[0], inverse.x),
                                     derivativeAt(point, rowStride, y > 0, y + 1 < dims[1], inverse.y),
                                     derivativeAt(point, planeStride, z > 0, z + 1 < dims[2], inverse.z));
            *length = static_cast<float>(glm::length(glm::dvec3(gradient)));
        }
}

/// Without a few outliers at the ends; lengths begin at 0.
ColourRange usualRange(const std::vector<float>& values, bool isLength) {
    constexpr std::size_t kMostLooked = 1'000'000;
    constexpr double kLeftOut = 0.005; // of the values, at each end
    const std::size_t step = values.size() / kMostLooked + 1;
    std::vector<float> looked;
    for (std::size_t i = 0; i < values.size(); i += step)
        if (std::isfinite(values[i]))
            looked.push_back(values[i]);
    std::sort(looked.begin(), looked.end());
    const auto at = [&](double share) {
        return looked.empty() ? 0.0
                              : static_cast<double>(
                                    looked[static_cast<std::size_t>(share * static_cast<double>(looked.size() - 1))]);
    };
    return {isLength ? 0.0 : at(kLeftOut), at(1.0 - kLeftOut)};
}

Status normalize(ColourField& field, bool isLength) {
    auto& texels = field.texels;
    field.usual = usualRange(texels, isLength);
    float least = std::numeric_limits<float>::infinity(), greatest = -least;
    for (const float value : texels)
        if (std::isfinite(value)) {
            least = std::min(least, value);
            greatest = std::max(greatest, value);
        }
    if (!(least <= greatest))
        return makeError(ErrorCode::InvalidArgument, "has no finite value to colour by");
    field.min = static_cast<double>(least);
    field.max = static_cast<double>(greatest);
    if (!(field.usual.low < field.usual.high))
        field.usual = {field.min, field.max};
    const double span = field.max > field.min ? field.max - field.min : 1.0;
    for (float& value : texels) {
        field.hasMissing = field.hasMissing || !std::isfinite(value);
        value = std::isfinite(value) ? static_cast<float>((static_cast<double>(value) - field.min) / span)
                                     : ColourField::kMissing;
    }
    return {};
}

template <class Sample>
void copyAsFloats(std::span<const Sample> samples, std::span<float> plane) {
    std::transform(samples.begin(), samples.end(), plane.begin(),
                   [](Sample sample) { return static_cast<float>(sample); });
}

std::string sizesText(const GridDims& dims) {
    return std::to_string(dims[0]) + " × " + std::to_string(dims[1]) + " × " + std::to_string(dims[2]);
}

std::string placeText(const glm::dvec3& place) {
    return "(" + valueText(place.x) + ", " + valueText(place.y) + ", " + valueText(place.z) + ")";
}

} // namespace

std::int64_t colourBlockSide(const GridDims& dims, std::int64_t mostTexels) {
    for (std::int64_t side = 1;; ++side) {
        GridDims blocks{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            blocks[axis] = (dims[axis] + side - 1) / side;
        if (pointCount(blocks) <= mostTexels && *std::max_element(blocks.begin(), blocks.end()) <= kMostTexelsASide)
            return side;
    }
}

ReadPlane planesOf(std::shared_ptr<const ScalarGrid> grid) {
    return [grid = std::move(grid)](std::int64_t z, std::span<float> plane) -> Status {
        grid->visit([&](auto samples) {
            copyAsFloats(samples.subspan(static_cast<std::size_t>(z) * plane.size(), plane.size()), plane);
        });
        return {};
    };
}

ReadPlane planesOf(std::shared_ptr<io::VolumeSource> source) {
    return [source = std::move(source), bytes = std::vector<std::byte>()](std::int64_t z,
                                                                          std::span<float> plane) mutable -> Status {
        const ScalarType type = source->info().type;
        bytes.resize(plane.size() * scalarTypeSizeBytes(type));
        ISO_TRY(source->readSlab(z, z + 1, bytes));
        visitScalarType(type, [&](auto sample) {
            using Sample = decltype(sample);
            copyAsFloats(std::span(reinterpret_cast<const Sample*>(bytes.data()), plane.size()), plane);
        });
        return {};
    };
}

Result<ColourField> makeColourField(const GridGeometry& geometry, const ReadPlane& read, bool isGradient,
                                    const JobControl& job, std::int64_t mostTexels) {
    const GridDims& dims = geometry.dims;
    ColourField field;
    field.step = colourBlockSide(dims, mostTexels);
    BlockMeans means(dims, field.step);
    field.dims = means.blocks();
    const auto size = static_cast<std::size_t>(dims[0] * dims[1]);
    if (size > usableMemoryBytes() / (kShareOfMemory * 4 * sizeof(float)))
        return makeError(ErrorCode::OutOfSpace, "one plane of the volume does not fit in memory");
    std::vector<float> planes((isGradient ? 3 : 1) * size); // below, at and above the one that is looked at
    std::vector<float> lengths(isGradient ? size : 0);
    const auto last = std::span(planes).last(size);
    ISO_TRY(read(0, last));
    for (std::int64_t z = 0; z < dims[2]; ++z) {
        if (job.isStopRequested())
            return cancelledError();
        job.report(static_cast<double>(z) / static_cast<double>(dims[2]), "Reading values");
        if (isGradient) {
            std::copy(planes.begin() + static_cast<std::ptrdiff_t>(size), planes.end(), planes.begin());
            if (z + 1 < dims[2])
                ISO_TRY(read(z + 1, last));
            takeGradients(planes, geometry, z, lengths);
            means.add(z, lengths);
        } else {
            if (z > 0)
                ISO_TRY(read(z, last));
            means.add(z, last);
        }
    }
    field.texels = means.take();
    ISO_TRY(normalize(field, isGradient));
    return field;
}

std::string latticeDifference(const GridGeometry& field, const GridGeometry& volume, bool isPlaceKnown) {
    constexpr double kSpacingShare = 1e-3; // headers round
    constexpr double kPlaceCells = 0.05, kTurn = 1e-3;
    if (field.dims != volume.dims)
        return sizesText(field.dims) + " points instead of " + sizesText(volume.dims);
    if (!isPlaceKnown)
        return {};
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(field.spacing[axis] - volume.spacing[axis]) <= kSpacingShare * volume.spacing[axis]))
            return "its spacing is " + placeText(field.spacing) + " instead of " + placeText(volume.spacing);
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(field.origin[axis] - volume.origin[axis]) <=
              kPlaceCells * std::max({volume.spacing.x, volume.spacing.y, volume.spacing.z})))
            return "its origin is " + placeText(field.origin) + " instead of " + placeText(volume.origin);
    for (int axis = 0; axis < 3; ++axis)
        if (!(glm::distance(field.direction[axis], volume.direction[axis]) <= kTurn))
            return "its axes are turned against the volume's";
    return {};
}

} // namespace isoslider::model
