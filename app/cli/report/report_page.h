#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "app/cli/output.h"
#include "app/cli/report/volume_measures.h"

namespace isoslider::cli {

/// A plot of a report and the file name that the page gives it.
struct ReportPlot {
    std::string fileName;
    std::string svg;
};

/// Of plotsOf().
std::vector<std::string> plotNames(const std::string& stem);
/// Active edges, steps and triangles of all volumes. File names begin with `stem`.
std::vector<ReportPlot> plotsOf(const std::vector<VolumeMeasures>& volumes, const std::string& stem);

/// The paper's Tables 1 to 3 and Fig. 10 for these volumes, and its own beside them, in Markdown. `plots` are shown,
/// in the order of plotsOf(), or left out if there are none.
std::string pageOf(const std::vector<VolumeMeasures>& volumes, const std::vector<ReportPlot>& plots);

Json reportJson(const std::vector<VolumeMeasures>& volumes);

} // namespace isoslider::cli
