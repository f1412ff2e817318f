#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/grid/grid_geometry.h"
#include "core/grid/scalar_type.h"

namespace isoslider {

/// A volume in memory: geometry, sample type, and the samples x fastest (`nx*ny*nz` of them).
/// Non-finite floating samples are missing values: they never make geometry.
class ScalarGrid {
public:
    ScalarGrid() = default;
    /// REQUIRES: samples.size() == pointCount(geometry.dims) * scalarTypeSizeBytes(type).
    ScalarGrid(GridGeometry geometry, ScalarType type, std::vector<std::byte> samples);

    /// From typed samples, for tests and generators.
    template <class T>
    static ScalarGrid fromValues(const GridGeometry& geometry, ScalarType type, std::span<const T> values) {
        const auto bytes = std::as_bytes(values);
        return ScalarGrid(geometry, type, std::vector<std::byte>(bytes.begin(), bytes.end()));
    }

    const GridGeometry& geometry() const { return geometry_; }
    const GridDims& dims() const { return geometry_.dims; }
    ScalarType type() const { return type_; }
    std::span<const std::byte> bytes() const { return samples_; }

    /// REQUIRES: T is the C++ type of type().
    template <class T>
    std::span<const T> values() const {
        return {reinterpret_cast<const T*>(samples_.data()), samples_.size() / sizeof(T)};
    }

    /// Calls `function(std::span<const T>)` with the samples in their own type.
    template <class Function>
    decltype(auto) visit(Function&& function) const {
        return visitScalarType(type_,
                               [&](auto sample) -> decltype(auto) { return function(values<decltype(sample)>()); });
    }

    double valueAt(std::int64_t x, std::int64_t y, std::int64_t z) const;

private:
    GridGeometry geometry_;
    ScalarType type_ = ScalarType::U8;
    std::vector<std::byte> samples_;
};

} // namespace isoslider
