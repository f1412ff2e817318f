#include <cstdio>

#include "core/volume_io/sources/volume_source.h"

namespace isoslider::io {
namespace {

std::string threeDigits(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

} // namespace

std::string lossText(const ResampleReport& report, const GridDims& dims) {
    std::string text = "onto " + std::to_string(dims[0]) + " x " + std::to_string(dims[1]) + " x " +
                       std::to_string(dims[2]) + " points, off by up to " + threeDigits(100.0 * report.rangeFraction) +
                       " % of the range (" + threeDigits(report.maxDifference) + "), root mean square " +
                       threeDigits(report.rmsDifference) + ", compared at " + std::to_string(report.comparedPoints) +
                       " of " + std::to_string(report.sourcePoints) + " points of the file";
    if (report.outsidePoints > 0)
        text += "; " + std::to_string(report.outsidePoints) + " points outside, missing";
    return text;
}

} // namespace isoslider::io
