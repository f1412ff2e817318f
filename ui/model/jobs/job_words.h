#pragma once

#include <optional>
#include <string>

#include "ui/model/jobs/job_model.h"

namespace isoslider::model {

/// How long work is likely to go on that has come so far in that time; none while that would be a guess.
std::optional<double> millisecondsLeft(double fraction, double elapsedMs);

/// "about 40 s left", "about 3 min left"; empty where that is not known.
std::string timeLeftText(double fraction, double elapsedMs);

/// Of a job that runs: "Reading · 45 % · about 12 s left". Stages come in lower case, as parts of a log line.
std::string runningText(const JobEntry& job);

} // namespace isoslider::model
