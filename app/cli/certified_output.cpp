#include "app/cli/certified_output.h"

#include <filesystem>

#include <fmt/format.h>

namespace isoslider::cli {

std::string sourceName(const std::string& path) {
    const auto normal = std::filesystem::path(path).lexically_normal();
    return (normal.has_filename() ? normal : normal.parent_path()).filename().string();
}

mesh::SurfaceSource sourceOf(const index::IndexInfo& info, const std::string& indexPath) {
    mesh::SurfaceSource source{info.sourceName.empty() ? sourceName(indexPath) : info.sourceName, info.nanCount,
                               info.lengthUnit, info.resampling};
    source.isPatientSpace = info.isPatientSpace;
    return source;
}

Outcome faultOutcome(const mesh::Certificate& certificate, const std::string& path) {
    const auto faults = mesh::faultsOf(certificate);
    if (faults.empty())
        return {};
    const auto line = fmt::format("the surface is not sound: {}", fmt::join(faults, ", "));
    return Outcome::foundFault(makeError(ErrorCode::InvalidArgument, line, path).line());
}

} // namespace isoslider::cli
