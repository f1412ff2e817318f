#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"
#include "core/grid/value_spread.h"

namespace isoslider::cli {

/// A finite number, or one of standard deviations: "5", "2.5 sigma", "-1sd". Throws a CLI::ValidationError of the
/// option if it is neither.
AskedIsovalue isovalueOrThrow(const std::string& option, std::string_view text);
CLI::Option* addIsovalue(CLI::App& command, const std::string& name, std::optional<AskedIsovalue>& target,
                         const std::string& help);

/// The values of isovalues, exactly. Only for those in standard deviations are all samples read, once.
/// Errors: InvalidArgument where no two samples differ, IoError, Corruption, Cancelled.
Result<std::vector<double>> valuesOf(std::span<const AskedIsovalue> asked, const std::string& indexPath,
                                     const JobControl& job);
Result<std::vector<double>> valuesOf(std::span<const AskedIsovalue> asked, const ScalarGrid& grid,
                                     const std::string& path, const JobControl& job);

} // namespace isoslider::cli
