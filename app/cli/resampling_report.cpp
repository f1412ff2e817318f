#include "app/cli/resampling_report.h"

#include <nlohmann/json.hpp>

namespace isoslider::cli {

void addResampling(const io::VolumeInfo& info, Json& json) {
    if (!info.resampling)
        return;
    const io::ResampleReport& report = *info.resampling;
    Json& lost = json["resampled"];
    lost["source_points"] = report.sourcePoints;
    lost["compared_points"] = report.comparedPoints;
    lost["max_difference"] = report.maxDifference;
    lost["rms_difference"] = report.rmsDifference;
    lost["range_fraction"] = report.rangeFraction;
    lost["outside_points"] = report.outsidePoints;
    lost["text"] = resamplingText(info);
}

void addResampling(const std::string& line, Json& json) {
    if (!line.empty())
        json["resampled"]["text"] = line;
}

std::string resamplingText(const io::VolumeInfo& info) {
    return info.resampling ? io::lossText(*info.resampling, info.geometry.dims) : std::string();
}

} // namespace isoslider::cli
