#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "core/base/result.h"

namespace isoslider::bench {

struct FlatStep {
    double updateMs = 0.0; ///< collecting the changes and applying them
    double interpolateMs = 0.0;
    std::uint64_t activeEdges = 0;
    std::uint64_t triangles = 0;
    std::uint64_t memoryBytes = 0;
};

/// The paper's flat layout over an index: fed by the same change source as the product, always patched,
/// everything on the calling thread.
class FlatRunner {
public:
    /// Errors: those of opening an index.
    static Result<std::unique_ptr<FlatRunner>> open(const std::filesystem::path& indexPath);
    virtual ~FlatRunner() = default;

    /// Errors: IoError, Corruption; the runner is unusable then.
    virtual Result<FlatStep> slideTo(double isovalue) = 0;
};

} // namespace isoslider::bench
